// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <filesystem>

#include "ricochet/scene.hpp"

namespace ricochet::scene {

/// What files need beside the settings of the library, whose `mesh` it does not hold.
struct Obstacle : ricochet::Obstacle {
  /// Of a mesh: an STL or OBJ file, or a drawing or mesh that gmsh reads; resolved against the scene's
  /// folder.
  std::filesystem::path surface{};
  double scale = 1;        ///< of its coordinates
  double size_factor = 1;  ///< on the sizes of the triangles of a drawing (gmsh's Mesh.MeshSizeFactor)
  // Set by store::find_surfaces, of a drawing
  std::filesystem::path triangles{};  ///< the STL file that gmsh made of it
  double deviation = 0;               ///< largest distance of the surface in contact from it [m]

  bool is_half_space() const { return shape == Shape::half_space; }
  /// Whether gmsh makes the triangles of the surface, which is no STL or OBJ file.
  bool is_drawn() const;
  bool operator==(const Obstacle&) const = default;
};

}  // namespace ricochet::scene
