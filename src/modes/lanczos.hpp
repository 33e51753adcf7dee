// SPDX-License-Identifier: BSD-2-Clause
// Block Lanczos about one shift.
#pragma once

#include <optional>

#include "src/modes/operators.hpp"

namespace ricochet::modes {

/// An interval of eigenvalues λ = ω² [rad²/s²].
struct Interval {
  double from = 0, to = 0;
};

struct LanczosOptions {
  double tolerance = 1e-8;    ///< on ‖Kφ − λMφ‖₂ / ‖Kφ‖₂
  Eigen::Index block = 16;    ///< columns of a block; bounds the multiplicity of modes found at once
  Eigen::Index basis = 1200;  ///< largest number of basis vectors
  std::uint64_t seed = 1;     ///< of the first start vector; the others take the numbers after it
  /// Number of eigenvalues sought above the shift, and at least one more; without it, those up to the end of
  /// the interval.
  std::optional<std::int64_t> above{};
};

/// Options of a search for modes that one with `options` has missed: start vectors none of which that search
/// has used, in case they had no component of the missing modes, and wider blocks, because a block finds no
/// more copies of a multiple mode than it has columns.
LanczosOptions other_start(const LanczosOptions& options);

/// The converged modes about a shift.
struct Converged {
  Interval covered;        ///< contains the shift; every Ritz value in it has converged
  Eigen::VectorXd lambda;  ///< (n) ascending, all in `covered`
  Eigen::MatrixXd shape;   ///< (local rows, n), M-orthonormal to about the square of the tolerance
};

/// Computes the elastic modes in `wanted`, as far as the basis allows. Collective on the team. The end of an
/// interval among nearly equal eigenvalues is moved into a gap beyond them, so that one shift finds them all.
///
/// Block Lanczos iteration for (K − σM)⁻¹M, with the σ of the factors, in the inner product of M (Grimes,
/// Lewis & Simon 1994). Rigid modes are deflated, and each step includes one full orthogonalisation. Take a
/// projected pair (θ, s), the next block Q⁺ and its coupling B. The vector x = Q s + Q⁺ B s / θ needs no
/// further solve (Ericsson & Ruhe 1980), and its residual is K x − λ M x = −M Q⁺ B s / θ². The iteration
/// stops when this residual is small enough, so that modes near the shift need fewer steps.
Converged lanczos(const Operators& operators, Factorisation& factor, const Interval& wanted,
                  const LanczosOptions& options, const parallel::Progress& progress = {});

}  // namespace ricochet::modes
