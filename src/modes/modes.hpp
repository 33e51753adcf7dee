// SPDX-License-Identifier: BSD-2-Clause
// Certified modes of K φ = ω² M φ; rigid modes are exact.
#pragma once

#include <filesystem>
#include <optional>

#include "ricochet/kernel.hpp"
#include "src/modes/operators.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// How modes are found: by LAPACK or slicing, whichever is faster, or by one of them.
enum class Solver { fastest, slicing, dense };

/// Either `up_to` or `count` must be set.
struct Request {
  std::optional<Hertz> up_to{};  ///< all modes up to this frequency
  /// Number of lowest modes, rigid modes included. A multiple mode at the end is kept whole.
  std::optional<std::int64_t> count{};
  ExpectedCount expected{};  ///< from which shifts are planned; if empty, that of the operators
  double relative_residual = 1e-8;
  /// Number of modes sought from one factorisation. With more, the Lanczos basis costs more than another
  /// factorisation; with fewer, it needs less memory.
  std::int64_t modes_per_shift = 260;
  std::filesystem::path checkpoint{};  ///< folder for finished slices; if empty, none are stored
  Solver solver = Solver::fastest;
  std::string eps_type = "ricochet";  ///< type of SLEPc's EPS that finds the modes
};

/// All modes of a body, or a contact-adapted basis. Each team of ranks holds some of the shapes.
struct ModeSet {
  std::vector<double> angular_frequency;  ///< (N) [rad/s], ascending; rigid modes first, exactly 0
  std::vector<double> residual;  ///< (N) ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂; rigid: ‖Kφ‖₂ / (max |diag K| ‖φ‖₂)
  std::vector<double> overlap;      ///< (N) largest |φᵀMψ − δ| of each mode φ with any mode ψ
  std::vector<Eigen::Index> index;  ///< (n) indices of this team's modes among all modes, ascending
  /// (local rows, n) shapes of this team's modes, M-orthonormal. The largest entry of each is positive.
  Eigen::MatrixXd shape;
  kernels::Certificate certificate;
  bool exact = true;  ///< true for modes; false for Ritz vectors, whose residuals have no bound
  /// λ between the last mode and the next, up to which completeness is proved [rad²/s²]. For a
  /// contact-adapted basis, the end of the band.
  double cut = 0;
  double static_shift = 0;  ///< σ < 0 about which the static correction is solved [rad²/s²]

  /// Stores this team's modes: on the first team, the rigid modes, and on every team `vectors`, the elastic
  /// modes from number `first` on. Fixes their signs. Collective on the team.
  void store(const parallel::Teams& teams, const Operators& operators, Eigen::Index first,
             const Eigen::MatrixXd& vectors);

  /// Gathers one column for each mode from all teams, in the order of all modes.
  /// @param mine  (a, n), the same on the team's ranks
  /// @return (a, N), the same on every rank. Collective.
  Eigen::MatrixXd gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const;
};

/// Progress of the search for modes.
struct Progress {
  /// Called when a phase begins, on every rank.
  std::function<void(const std::string& phase)> begin = [](const std::string&) {};
  /// Called once the number of modes up to the end of the search is known, on every rank, before memory for
  /// them is allocated, with the number of slices planned and the time that is left [s], planned from
  /// measured work; 0: unknown. May throw InputError on every rank.
  std::function<void(std::int64_t modes, std::int64_t slices, double seconds)> counted =
      [](std::int64_t, std::int64_t, double) {};
  /// Called within a phase, on any rank.
  parallel::Progress at = [](std::int64_t, std::int64_t) {};
};

/// Number of modes up to a frequency, estimated by the laws of kernels::expected_count, and at most the
/// number that the mesh resolves.
std::int64_t expected_modes(const elasticity::Body& body, Hertz up_to);

/// The request with the number of modes that is expected of a body, from which shifts are planned.
Request request_of(const elasticity::Body& body, Request request);

/// Throws InputError if a body has fewer modes than `count`, or none.
void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body);

/// Computes all requested modes. `mesh`, `body` and `factor`, the factorisation of its matrices, are those of
/// the team. Collective on all ranks of `teams`.
///
/// The modes are found by SLEPc's EPS, of the type `eps_type`, or that of -eps_type in PETSC_OPTIONS. The
/// engine of Ricochet is one of its types, and the only one for several teams.
///
/// Throws InputError if the body has fewer modes than requested; SolverError if a mode is missing, a residual
/// exceeds its bound, or the error of M-orthonormality exceeds 1e-6, and neither further slices, nor subspace
/// iteration about shifts near these modes, nor a dense solver changes that. No uncertified mode is returned.
/// Source: shifts, inertia counts and block Lanczos iteration as in Grimes, Lewis & Simon 1994. The shifts
/// are distributed among the teams.
ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress = {});

}  // namespace ricochet::modes
