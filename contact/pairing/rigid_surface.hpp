// SPDX-License-Identifier: BSD-2-Clause
// The surfaces of rigid obstacles in axes of their own: triangles to find contact points by, which are curved
// where the surface is smooth, and the closed form of a shape, on which those points then are.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// A closed surface of triangles, anticlockwise seen from outside.
struct RigidMesh {
  std::vector<Eigen::Vector3d> node{};  ///< [m]
  std::vector<std::array<int, 3>> triangle{};
  bool inside = false;  ///< whether what is inside is free
};

/// Triangles that meet at less than 29° continue smoothly in each other, as faces of bodies do.
WorldSurface rigid_surface(const RigidMesh& mesh);

/// A capsule, a torus, or, with flat ends, a cylinder or a cone.
WorldSurface rigid_surface(const RoundSurface& round);

/// A box with the edges `size` [m] around the origin.
WorldSurface rigid_box(const Eigen::Vector3d& size, bool inside);

/// What keeps a mesh from being a closed surface, in words; empty if it is one. A mesh whose triangles all
/// face inwards is turned.
std::string flaw_of(RigidMesh& mesh);

}  // namespace ricochet::contact
