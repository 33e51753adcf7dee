// SPDX-License-Identifier: BSD-2-Clause
// Loads, moving supports and receivers of a body.
#pragma once

#include "ricochet/kernel.hpp"
#include "src/reduction/lift.hpp"
#include "src/scene/request.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// Loads, moving supports and receivers of a body; the same on every rank except for rows of the mesh, which
/// are distributed.
struct Sources {
  std::vector<kernels::Load> loads;          ///< name, unit, total and moment
  std::vector<kernels::Motion> motions;      ///< names, in the order of mesh::RequestedGroups::moved
  std::vector<kernels::Receiver> receivers;  ///< names and points
  std::vector<Weight> at_receivers;
  Eigen::MatrixXd load;      ///< (local rows, 3 per load) unit traction or force; fixed rows 0
  Eigen::MatrixXd receiver;  ///< (local rows, 3 per receiver) unit force at the receiver
  reduction::Lift lift;      ///< of the moving supports; set once the matrices are factored
};

/// Returns the groups of the mesh that a request needs.
mesh::RequestedGroups requested_groups(const scene::KernelRequest& request);

/// Makes the sources, except for the lift. `mesh` must have been read with requested_groups(request). Needs a
/// GmshSession. Collective.
/// Throws InputError if a point is farther from the body than 1e-6 of its size.
Sources make_sources(const mesh::Mesh& mesh, const scene::KernelRequest& request);

}  // namespace ricochet::surface
