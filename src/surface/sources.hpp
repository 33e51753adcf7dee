// SPDX-License-Identifier: BSD-2-Clause
// Loads, moving supports, receivers and gauges of a body.
#pragma once

#include "ricochet/kernel.hpp"
#include "src/reduction/lift.hpp"
#include "src/scene/request.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// Loads, moving supports, receivers and gauges of a body; the same on every rank except for rows of the
/// mesh, which are distributed.
struct Sources {
  std::vector<kernels::Load> loads;          ///< name, unit, total and moment
  std::vector<kernels::Motion> motions;      ///< names, in the order of mesh::RequestedGroups::moved
  std::vector<kernels::Receiver> receivers;  ///< names and points
  std::vector<kernels::Gauge> gauges;        ///< names and points; `strain` is set if it is recorded
  Eigen::MatrixXd load;  ///< (local rows, 3 per load) unit traction or force; fixed rows 0
  /// (local rows, columns) Unit forces at receivers, 3 each, then the rows of all gauges: 6 of stress and 1
  /// of strain if it is recorded, each over its `gauge_unit`. Its transpose gives what they record of a
  /// displacement. Fixed rows 0.
  Eigen::MatrixXd receiver;
  Eigen::SparseMatrix<double> receiver_filled;  ///< the same with fixed rows
  Eigen::VectorXd gauge_unit;  ///< (rows of all gauges) [Pa] or [1]; so that columns have length 1
  reduction::Lift lift;        ///< of the moving supports; set once the matrices are factored
};

/// Returns the groups of the mesh that a request needs.
mesh::RequestedGroups requested_groups(const scene::KernelRequest& request);

/// Makes the sources, except for the lift. `mesh` must have been read with requested_groups(request). Needs a
/// GmshSession. Collective.
/// Throws InputError if a point is farther from the body than 1e-6 of its size, or if a body without elements
/// has a gauge.
Sources make_sources(const mesh::Mesh& mesh, const scene::KernelRequest& request);

}  // namespace ricochet::surface
