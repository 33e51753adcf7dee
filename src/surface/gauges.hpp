// SPDX-License-Identifier: BSD-2-Clause
// Stress and strain at gauges and at other points, as linear functions of the displacement of the nodes.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "src/reduction/rows.hpp"
#include "src/scene/request.hpp"
#include "src/surface/locate.hpp"

namespace ricochet::surface {

/// The rows of all gauges, each over its unit: 6 of stress (xx, yy, zz, yz, xz, xy in the axes of the mesh),
/// then 1 of strain if the gauge has a direction.
struct GaugeColumns {
  Eigen::SparseMatrix<double> free;    ///< (local rows, rows of all gauges) without fixed rows of the mesh
  Eigen::SparseMatrix<double> filled;  ///< with them; its transpose gives the rows from the displacement
  Eigen::VectorXd unit;                ///< (rows of all gauges) [Pa] or [1]
};

/// Recovers the stress by the gradient of recovery.hpp and the material of the element at each gauge. Rods
/// have E ε along their axis. The strain over a length is its mean over three Gauss points, of order 6.
/// @param places  of request.gauges
/// Needs a GmshSession. Collective. Throws InputError if the body has no elements, or if a place of a length
/// is off the body.
GaugeColumns gauge_columns(const mesh::Mesh& mesh, const scene::KernelRequest& request,
                           const std::vector<Located>& places);

/// The stress at the nodes of the visualisation surface, recovered as for gauges: 6 rows a node [Pa]. The
/// body must have elements. Needs a GmshSession. Collective.
reduction::GradientRows surface_stress(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials);

}  // namespace ricochet::surface
