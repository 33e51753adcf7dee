// SPDX-License-Identifier: BSD-2-Clause
// Loads, moving supports and receivers of a body.
#pragma once

#include "ricochet/kernel.hpp"
#include "src/modes/lift.hpp"
#include "src/scene/request.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// What else than contact acts on the body or is seen of it, the same on every rank but for rows of the mesh.
struct Sources {
  std::vector<kernels::Load> loads;          ///< name, unit, total and moment
  std::vector<kernels::Motion> motions;      ///< names, in the order of mesh::Asked::moved
  std::vector<kernels::Receiver> receivers;  ///< names and points
  std::vector<Weight> at_receivers;
  Eigen::MatrixXd load;      ///< (local rows, 3 each): unit traction or force in each component; held 0
  Eigen::MatrixXd receiver;  ///< likewise, of a unit force at each receiver
  modes::Lift lift;          ///< of the supports that move; filled in when there are factors
};

/// What the body's mesh is asked for by a request.
mesh::Asked asked_of(const scene::KernelRequest& request);

/// All but the lift. `mesh` was read with asked_of(request). Needs a GmshSession. Collective.
/// Throws InputError when a point is farther from the body than 1e-6 of its size.
Sources make_sources(const mesh::Mesh& mesh, const scene::KernelRequest& request);

}  // namespace ricochet::surface
