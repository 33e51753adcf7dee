// SPDX-License-Identifier: BSD-2-Clause
// The elastic law of a material at the points of a body.
//
//   σ = C ε,   C = M C' Mᵀ,   M_(ij)(kl) = Q_ik Q_jl + Q_il Q_jk for k ≠ l, and Q_ik Q_jk for k = l
//
// C' is the stiffness in the axes of the material, the columns of Q are these axes, and M turns a stress into
// the axes of the mesh. Stresses are ordered xx, yy, zz, yz, xz, xy; strains likewise, with the engineering
// shear strains γ = 2 ε.
// Source: Bond 1943 (M).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <utility>

#include "src/scene/data/material.hpp"

namespace ricochet::elasticity {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Components of a stress, in its order.
inline constexpr std::array<std::pair<int, int>, 6> stress_order{
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

/// Place of component (i, j) in this order.
constexpr int place_of(int i, int j) { return i == j ? i : 6 - i - j; }

/// The law of a solid.
class Law {
 public:
  explicit Law(const scene::Material& material);

  /// Whether C is the same everywhere.
  bool uniform() const { return !about_; }

  /// C at a point, in the axes of the mesh [Pa]. On the line about which the axes turn, no direction is
  /// radial; C there is its mean over all directions around the line.
  Matrix6 at(const Eigen::Vector3d& point) const;

 private:
  Matrix6 own_, fixed_;  ///< in the axes of the material; in the axes of the mesh if uniform, or on the line
  std::optional<scene::CentreLine> about_;
};

/// C_ijkl at (3i + k, 3j + l), which turns the products ∂_j v ∂_l u of gradients into those of components.
Eigen::Matrix<double, 9, 9> by_components(const Matrix6& C);

/// The strain of a displacement with this gradient g along each axis, (6, 3): column i is that of u_i.
Eigen::Matrix<double, 6, 3> strain_of(const Eigen::Vector3d& g);

}  // namespace ricochet::elasticity
