// SPDX-License-Identifier: BSD-2-Clause
// What is constant of blocks of steps, in the order in which their loops read it.
#pragma once

#include <memory>
#include <vector>

#include "contact/stepping/simd.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

/// Bands of frequency whose energies bound what points can do. More tell more and cost more.
constexpr int bands = 16;

template <class T>
struct BlockSystem {
  /// @param steps  L ≥ 1 @param step  Δ [s]
  BlockSystem(std::shared_ptr<const StepSystem> system, int steps, double step);

  std::shared_ptr<const StepSystem> plain;
  const simd::Loops<T>* loops;
  int length, points;
  std::size_t modes, width;  ///< padded: of modes, of points
  // (modes), 0 for rigid modes, which are stepped apart
  std::vector<double> stiffness, load, origin, b, c, e, h, damp_ss, damp_sr, damp_rr;
  std::vector<T> B;                    ///< (points, modes), likewise
  std::vector<T> lag;                  ///< (points, L, width) S_d
  std::vector<T> influence;            ///< (points, width) no |S_d,ij| of any lag is larger
  std::vector<T> flexibility;          ///< (points, width) R + Σ B Bᵀ/ω² of elastic modes
  std::vector<T> residual;             ///< (points, width) R; empty where it is 0
  std::vector<T> reach;                ///< (bands, width) (Σ B²/ω²)^½ of a band
  std::vector<double> softness;        ///< (modes) 1/ω² of elastic modes
  Vector rest, largest;                ///< (points) s + Σ B f/ω² of elastic modes; largest |flexibility|
  std::vector<std::vector<int>> band;  ///< elastic modes of a band
  std::vector<int> rigid;              ///< modes with ω = 0
  Matrix rigid_B;                      ///< (points, rigid)
  bool yields;                         ///< R is not 0
};

extern template struct BlockSystem<double>;
extern template struct BlockSystem<float>;

}  // namespace ricochet::contact
