// SPDX-License-Identifier: BSD-2-Clause
// Certified modes of K φ = ω² M φ, rigid ones exact.
#pragma once

#include <filesystem>
#include <optional>

#include "ricochet/kernel.hpp"
#include "src/modes/operators.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

struct Request {
  std::optional<Hertz> up_to{};  ///< all modes up to here, or
  /// the lowest ones, rigid included; extended to the end of a multiple mode
  std::optional<std::int64_t> count{};
  double relative_residual = 1e-8;
  /// Modes to find from one factorisation: with more its basis costs more than another one; with fewer it
  /// needs less memory.
  std::int64_t modes_per_shift = 260;
  std::filesystem::path checkpoint{};  ///< folder of finished slices, used and filled; empty: none
};

/// All modes of a body, or vectors fitted to its contact; each team of ranks holds the shapes of some.
struct ModeSet {
  std::vector<double> angular_frequency;  ///< (N) [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂; rigid: ‖Kφ‖₂ / (max |diag K| ‖φ‖₂)
  std::vector<Eigen::Index> index;  ///< (n) numbers of this team's modes in the lists above, ascending
  Eigen::MatrixXd shape;  ///< (local rows, n) of them, M-orthonormal; the largest entry of each is positive
  kernels::Certificate certificate;
  bool exact = true;  ///< modes; otherwise Ritz vectors, whose residuals are what they are
  double cut = 0;  ///< λ between the last mode kept and the next: the proved end; Ritz vectors: of the band
  double static_shift = 0;  ///< σ < 0 about which what is left out is solved for [rad²/s²]

  /// Columns of this team's modes put in their places among all. @param mine (a, n), the same on the team's
  /// ranks;
  /// @return (a, N), the same on every rank. Collective.
  Eigen::MatrixXd gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const;
};

/// What the search for modes tells of its way.
struct Progress {
  std::function<void(const std::string& phase)> begin;            ///< a phase begins; on every rank
  std::function<void(std::int64_t done, std::int64_t total)> at;  ///< within it; on any rank
};

/// Throws InputError when a body has fewer modes than `count`.
void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body);

/// Collective on all ranks of `teams`; `mesh`, `body` and `factor`, of the body's matrices, are on the team's
/// ranks.
///
/// Throws InputError when the body has fewer modes than asked for; SolverError when a mode is missing, a
/// residual exceeds its bound, or M-orthonormality is worse than 1e-8: nothing uncertified is returned.
/// Source: shifts, counts by inertia and block Lanczos as in Grimes, Lewis & Simon 1994; shifts are shared
/// out among the teams.
ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress = {});

}  // namespace ricochet::modes
