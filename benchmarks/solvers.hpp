// SPDX-License-Identifier: BSD-2-Clause
// The solvers that are timed, from assembled matrices to shapes in hand.
#pragma once

#include <optional>
#include <vector>

#include "src/elasticity/assemble.hpp"
#include "src/mesh/mesh.hpp"
#include "src/parallel/teams.hpp"
#include "src/scene/request.hpp"

namespace ricochet::bench {

/// What one run found. Residuals are taken outside the time measured.
struct Found {
  double seconds = 0;
  std::vector<double> frequency_hz{};  ///< elastic, ascending
  double worst_residual = 0;           ///< of the elastic modes, ‖Kφ − ω²Mφ‖₂ / ‖Kφ‖₂
  double upto_hz = 0;                  ///< end of the search
  double flexibility_error = 0;        ///< contact: its estimate
};

/// A body on every team of ranks.
struct Problem {
  const parallel::Teams& teams;
  const scene::KernelRequest& request;
  const mesh::Mesh& mesh;
  const elasticity::Body& body;
};

/// The search for modes that request.modes asks for. Collective, as are all below.
Found by_ricochet(const Problem& problem);

/// The basis fitted to contact that request.modes asks for, with the residual flexibility. Needs a
/// GmshSession.
Found by_contact_basis(const Problem& problem);

/// SLEPc's Krylov–Schur with shift-and-invert by MUMPS for the `count` lowest modes, rigid ones included.
Found by_krylov_schur(const Problem& problem, std::int64_t count);

/// SLEPc's spectrum slicing: all modes from 1 Hz to `upto`.
Found by_slicing(const Problem& problem, Hertz upto);

}  // namespace ricochet::bench
