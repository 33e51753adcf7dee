// SPDX-License-Identifier: BSD-2-Clause
// The error of the flexibility under a pressed patch, from problems of higher orders on the elements around
// it.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <vector>

#include "src/mesh/mesh.hpp"
#include "src/mesh/node_key.hpp"

namespace ricochet::elasticity {

/// A force on a patch of the surface, the same on every rank.
struct PatchLoad {
  Vector3 force;                                 ///< resultant [N]
  std::vector<std::vector<std::int64_t>> facet;  ///< the pressed facets, by ascending corners
  /// Share of the force on the functions of order p + 1 and p + 2
  std::array<std::map<mesh::NodeKey, double>, 2> share;
};

/// Returns an estimate of how much the displacement of a patch grows from elements of order p to exact ones.
///
/// The gains a and b of orders p + 1 and p + 2 on the elements around the patch, with the rest of the body as
/// it is, are extrapolated: a + (b − a)/(1 − (b − a)/a), with the ratio (b − a)/a at most 0.8. A surplus of
/// the next order alone misses most of the error if the patch is narrower than half an element.
///
/// Of solids. Collective on the ranks of the mesh. Needs a GmshSession.
/// @param solution  (local rows) displacement under the force on this mesh [m]
/// @param inertia   (local rows) acceleration by the force of the body as a rigid one [m/s²]
/// @return work of the force on the growth [J], the same on every rank
double work_of_growth(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials,
                      const PatchLoad& load, const Eigen::Ref<const Eigen::VectorXd>& solution,
                      const Eigen::Ref<const Eigen::VectorXd>& inertia);

}  // namespace ricochet::elasticity
