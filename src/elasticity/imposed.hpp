// SPDX-License-Identifier: BSD-2-Clause
// Forcing by moving supports: the coupling between free and fixed rows, which supports remove from K and M.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "src/elasticity/element.hpp"

namespace ricochet::elasticity {

/// Forcing by S supports. Each has three columns, for unit displacements along x, y and z of the body. A
/// column is 0 if the support does not hold that component. Indices: f for free rows, s for fixed rows.
struct Imposed {
  Eigen::MatrixXd shape;     ///< (local rows, 3S) E: displacement of fixed rows; free rows 0
  Eigen::MatrixXd force;     ///< (local rows, 3S) −K_fs E [N/m]; fixed rows 0
  Eigen::MatrixXd inertia;   ///< (local rows, 3S) M_fs E [kg]; fixed rows 0
  Eigen::MatrixXd momentum;  ///< (3,3S) e_iᵀ M E over fixed rows, the same on every rank [kg]
};

/// Accumulates the contributions of the elements of one rank.
class Imposing {
 public:
  /// @param moved  for each support of mesh::RequestedGroups::moved, the components that it holds, a subset
  /// of "xyz"
  Imposing(const mesh::Mesh& mesh, const std::vector<std::string>& moved);

  /// Adds one element.
  /// @param nodes        local nodes of the element
  /// @param K, M         (cn, cn), before supports
  /// @param translation  (cn, ≥ 3) M times e_x, e_y, e_z
  void add(const std::int64_t* nodes, int count, const ElementMatrix& K, const ElementMatrix& M,
           const Eigen::MatrixXd& translation);

  /// Returns the result. Collective.
  Imposed take();

 private:
  Eigen::RowVectorXd row(std::size_t local_node, int component) const;

  const mesh::Mesh& mesh_;
  const std::vector<std::string>& moved_;
  Imposed sum_;
};

}  // namespace ricochet::elasticity
