// SPDX-License-Identifier: BSD-2-Clause
// The solvers to be timed, from assembled matrices to mode shapes in memory.
#pragma once

#include <optional>
#include <vector>

#include <string>
#include <utility>
#include <vector>
#include "src/elasticity/assemble.hpp"
#include "src/mesh/mesh.hpp"

#include "src/parallel/teams.hpp"
#include "src/scene/request.hpp"

namespace ricochet::bench {

/// Results of one run. Residuals are computed after the time is measured.
struct Found {
  double seconds = 0;
  std::vector<double> frequency_hz{};  ///< elastic modes, ascending
  double worst_residual = 0;           ///< of the elastic modes, ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂
  double upto_hz = 0;                  ///< end of the search
  double flexibility_error = 0;        ///< contact-adapted basis: its error estimate
  /// Our own search: its phases, with the time at which each begins [s]
  std::vector<std::pair<std::string, double>> phases{};
  double factor_seconds = 0, factor_mib = 0;  ///< our own search: one further factorisation
};

/// A body on every team of ranks, and the request for its kernel.
struct Problem {
  const parallel::Teams& teams;
  const scene::KernelRequest& request;
  const mesh::Mesh& mesh;
  const elasticity::Body& body;
};

/// Our own search for the modes that request.modes requests. Collective, like all functions below.
Found by_ricochet(const Problem& problem);

/// The contact-adapted basis that request.modes requests, with the residual flexibility. Needs a GmshSession.
Found by_contact_basis(const Problem& problem);

/// Krylov–Schur of SLEPc with shift-and-invert by MUMPS, for the `count` lowest modes including rigid modes.
Found by_krylov_schur(const Problem& problem, std::int64_t count);

/// Spectrum slicing of SLEPc: all modes from 1 Hz to `upto`.
Found by_slicing(const Problem& problem, Hertz upto);

}  // namespace ricochet::bench
