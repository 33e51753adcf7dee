// SPDX-License-Identifier: BSD-2-Clause
// The constants of look-ahead blocks, in the order in which the loops read them.
#pragma once

#include <memory>
#include <vector>

#include "contact/stepping/simd.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

template <class T>
struct BlockSystem {
  /// @param steps  L ≥ 1 @param step  Δ [s]
  BlockSystem(std::shared_ptr<const StepSystem> system, int steps, double step);

  std::shared_ptr<const StepSystem> plain;
  const simd::Loops<T>* loops;
  int length;
  int points;                   ///< n: a row of a tangent counts as a point that never closes
  int contacts;                 ///< m: the first rows
  std::size_t modes, width;     ///< padded numbers of modes and of points
  Vector gap;                   ///< (points) g; infinite in tangential rows
  std::vector<int> tangential;  ///< (contacts) first tangential row, or −1
  std::vector<int> law;         ///< (contacts) entry in the friction of StepSystem, or −1
  ModeConstants elastic;        ///< (modes) each; 0 for rigid modes, which are stepped separately
  std::vector<T> B;             ///< (points, modes); 0 for rigid modes
  std::vector<T> lag;           ///< (points, L, width) M_d
  std::vector<T> influence;     ///< (points, width) largest |M_d,ij| over all lags, |R_ij| added to lag 0
  std::vector<T> flexibility;   ///< (points, width) R + Σ B Bᵀ/ω² of elastic modes
  std::vector<T> residual;      ///< (points, width) R; empty if R is 0
  std::vector<T> reach;         ///< (bands, width) (Σ B²/ω²)^½ over the modes of a band
  Vector softness;              ///< (modes) 1/ω² of elastic modes; 0 for others
  Vector largest;               ///< (points) largest |flexibility|
  std::vector<std::vector<int>> band;  ///< elastic modes of a band
  std::vector<int> rigid;              ///< modes with ω = 0
  Matrix rigid_B;                      ///< (points, rigid)
  bool yields;                         ///< whether R differs from 0
};

}  // namespace ricochet::contact
