// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "kernels/damping.hpp"
#include "ricochet/scene.hpp"
#include "src/scene/data/material.hpp"

namespace ricochet::scene {

using Damping = kernels::Damping;

/// Small elements in a ball, which grow around it.
struct FineBall {
  static constexpr double growth = 0.4;  ///< of their size per distance from the ball
  Vector3 at{};                          ///< [m], in the frame of the body
  double radius = 0;                     ///< [m]
  double size = 0;                       ///< longest edge of elements within the radius [m]
  /// Longest edge of elements at a distance from the centre [m].
  double size_at(double distance) const { return size + growth * std::max(0.0, distance - radius); }
  bool operator==(const FineBall&) const = default;
};

/// What meshes and kernels need beside the settings of the library, whose `kernel` it does not hold.
struct Body : ricochet::Body {
  std::filesystem::path mesh;              ///< resolved against the scene's folder
  std::filesystem::path converted{};       ///< the .msh of a foreign mesh; set by kernel::import_meshes
  std::map<std::string, double> geometry;  ///< DefineConstant overrides of a .geo
  int order = 3;
  double size_factor = 1;        ///< factor on the element sizes of a geometry (gmsh's Mesh.MeshSizeFactor)
  std::vector<FineBall> refine;  ///< of a geometry
  /// Whether ricochet-kernel chooses order, size_factor and refine for the accuracy.
  bool order_open = false, size_open = false, refine_open = false;
  double scale = 1;
  std::vector<Material> materials;  ///< empty for an imported body
  Damping damping;
  std::string copy_of{};             ///< the mallet of which it is a copy, for a further strike
  std::vector<std::string> contact;  ///< physical groups that may touch
  /// Fixed components by physical group: a subset of "xyz", in that order.
  std::map<std::string, std::string> support;

  /// Whether `mesh` is a body file: matrices or modes from another program, without elements or materials.
  bool imported() const { return mesh.extension() == ".h5"; }
  /// Whether `mesh` is the mesh of another program, which `ricochet import mesh` converts for gmsh.
  bool foreign() const;
  /// Whether gmsh meshes the body, so that it may have elements of any order.
  bool meshable() const { return !imported() && !foreign() && mesh.extension() != ".msh"; }
  bool operator==(const Body&) const = default;
};

/// Rotation matrix of `rotate_deg`, row-major (3,3): world = rotation · body + translate.
std::array<double, 9> rotation_of(const Body& body);

/// Components of a world vector along the axes of the body.
Vector3 in_body(const Body& body, const Vector3& world);

/// The point of the world at which the body has its point `own`, and the converse [m].
Vector3 point_in_world(const Body& body, const Vector3& own);
Vector3 point_in_body(const Body& body, Vector3 world);

}  // namespace ricochet::scene
