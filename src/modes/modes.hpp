// SPDX-License-Identifier: BSD-2-Clause
// Certified modes of K φ = ω² M φ; rigid modes are exact.
#pragma once

#include <filesystem>
#include <optional>

#include "ricochet/kernel.hpp"
#include "src/modes/operators.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

struct Request {
  std::optional<Hertz> up_to{};  ///< all modes up to here, or
  /// the lowest ones, rigid modes included; extended to the end of a multiple mode
  std::optional<std::int64_t> count{};
  double relative_residual = 1e-8;
  /// Number of modes sought from one factorisation. With more, the Lanczos basis costs more than another
  /// factorisation; with fewer, it needs less memory.
  std::int64_t modes_per_shift = 260;
  std::filesystem::path checkpoint{};  ///< folder of finished slices, read and extended; empty: none
};

/// All modes of a body, or a contact-adapted basis. Each team of ranks holds some of the shapes.
struct ModeSet {
  std::vector<double> angular_frequency;  ///< (N) [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂; rigid: ‖Kφ‖₂ / (max |diag K| ‖φ‖₂)
  std::vector<Eigen::Index> index;  ///< (n) indices of this team's modes in the lists above, ascending
  Eigen::MatrixXd shape;  ///< (local rows, n) of these, M-orthonormal; the largest entry of each is positive
  kernels::Certificate certificate;
  bool exact = true;  ///< modes; otherwise Ritz vectors, whose residuals have no bound
  double cut = 0;  ///< λ between the last mode and the next: the proved end; Ritz vectors: end of the band
  double static_shift = 0;  ///< σ < 0 about which the static correction is solved [rad²/s²]

  /// Stores the rigid modes, on the first team, and this team's part of the elastic ones: `vectors`, from
  /// number `first` among them. Fixes their signs. Collective on the team.
  void store(const parallel::Teams& teams, const Operators& operators, Eigen::Index first,
             const Eigen::MatrixXd& vectors);

  /// Gathers columns of each team's modes in the order of all modes.
  /// @param mine  (a, n), the same on the team's ranks
  /// @return (a, N), the same on every rank. Collective.
  Eigen::MatrixXd gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const;
};

/// Progress of the search for modes.
struct Progress {
  /// Called when a phase begins, on every rank.
  std::function<void(const std::string& phase)> begin = [](const std::string&) {};
  /// Called within it, on any rank.
  parallel::Progress at = [](std::int64_t, std::int64_t) {};
};

/// Throws InputError if a body has fewer modes than `count`.
void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body);

/// Computes all requested modes. Collective on all ranks of `teams`; `mesh`, `body` and `factor`, of the
/// body's matrices, are those of the team.
///
/// Throws InputError if the body has fewer modes than requested; SolverError if a mode is missing, a residual
/// exceeds its bound, or M-orthonormality is worse than 1e-8: no uncertified mode is returned.
/// Source: shifts, inertia counts and block Lanczos as in Grimes, Lewis & Simon 1994; the shifts are
/// distributed among the teams.
ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress = {});

}  // namespace ricochet::modes
