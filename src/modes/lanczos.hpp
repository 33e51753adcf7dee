// SPDX-License-Identifier: BSD-2-Clause
// Block Lanczos about one shift.
#pragma once

#include "src/modes/operators.hpp"

namespace ricochet::modes {

/// An interval of eigenvalues λ = ω² [rad²/s²].
struct Interval {
  double from = 0, to = 0;
};

struct LanczosOptions {
  double tolerance = 1e-8;    ///< on ‖Kφ − λMφ‖₂ / ‖Kφ‖₂
  Eigen::Index block = 16;    ///< columns of a block: the most copies of a multiple mode found at once
  Eigen::Index basis = 1200;  ///< most vectors of the basis
  std::uint64_t seed = 1;
};

/// Modes about a shift.
struct Converged {
  Interval covered;        ///< holds the shift; every Ritz value in it has converged
  Eigen::VectorXd lambda;  ///< (n) ascending, all in `covered`
  Eigen::MatrixXd shape;   ///< (local rows, n), M-orthonormal to about the square of the tolerance
};

/// The elastic modes in `wanted`, as far as the basis reaches. Collective on the team.
///
/// Block Lanczos for (K − σM)⁻¹M, σ being that of the factors, in the inner product of M (Grimes, Lewis &
/// Simon 1994), rigid modes deflated, one full orthogonalisation a step. With the projected pair (θ, s) and
/// the next block Q⁺ behind it, the vector x = Q s + Q⁺ B s / θ costs nothing more (Ericsson & Ruhe 1980) and
/// has K x − λ M x = −M Q⁺ B s / θ²: that is what the iteration stops by, so that modes near the shift need
/// less of it.
Converged lanczos(const Operators& operators, Factorisation& factor, const Interval& wanted,
                  const LanczosOptions& options, const parallel::Progress& progress = {});

}  // namespace ricochet::modes
