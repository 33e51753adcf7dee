// SPDX-License-Identifier: BSD-2-Clause
// The constants of look-ahead blocks, in the order in which the loops read them.
#pragma once

#include <memory>
#include <vector>

#include "base/aligned.hpp"
#include "contact/simd/simd.hpp"
#include "contact/stepping/block_matrices.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

/// Up to this size, a stepper computes the matrices of all rows at once, so that it is ready for real time
/// [bytes].
inline constexpr double matrices_at_once = 32 << 20;

template <class T>
struct BlockSystem {
  /// @param steps  L ≥ 1 @param step  Δ [s]
  /// @param at_once  as in BlockMatrices [bytes]
  BlockSystem(std::shared_ptr<const StepSystem> system, int steps, double step,
              double at_once = matrices_at_once);

  std::shared_ptr<const StepSystem> plain;
  const simd::Loops<T>* loops;
  int length;
  int points;                   ///< n: a row of a tangent counts as a point that never closes
  int contacts;                 ///< m: the first rows
  std::size_t modes, width;     ///< padded numbers of modes and of points
  Vector gap;                   ///< (points) g; infinite in tangential rows
  std::vector<int> tangential;  ///< (contacts) first tangential row, or −1
  std::vector<int> law;         ///< (contacts) entry in the friction of StepSystem, or −1
  /// Constants of elastic modes, (modes) each; 0 for rigid modes, which are stepped separately. `load` and
  /// `held` are those of a block.
  simd::Modes elastic{};
  base::AlignedVector<double> constants;  ///< to which `elastic` points
  base::AlignedVector<T> B;               ///< (points, modes); 0 for rigid modes
  /// Of the rows that may touch. It computes what is missing, as a cache does.
  std::unique_ptr<BlockMatrices<T>> matrices;
  base::AlignedVector<float> reach;    ///< (bands, width) (Σ B²/ω²)^½ over the modes of a band
  Vector softness;                     ///< (modes) 1/ω² of elastic modes; 0 for others
  Vector largest;                      ///< (points) upper bound on the entries of a row of the flexibility
  std::vector<std::vector<int>> band;  ///< elastic modes of a band
  std::vector<int> rigid;              ///< modes with ω = 0
  Matrix rigid_B;                      ///< (points, rigid)
  bool yields;                         ///< whether R differs from 0
};

}  // namespace ricochet::contact
