// SPDX-License-Identifier: BSD-2-Clause
// The surface of a drawing or mesh as triangles, for rigid obstacles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "src/scene/data/body.hpp"

namespace ricochet::mesh {

/// Triangles, anticlockwise seen from outside, in the units of the file.
struct Triangulation {
  std::vector<double> position;        ///< (n,3) of nodes
  std::vector<std::int64_t> triangle;  ///< (t,3) nodes
  /// (e,3) points of the surface of the drawing, those closest to the middles of triangles; none of a mesh.
  std::vector<double> exact;
  std::string sewn;  ///< Opened::sewn
};

/// Triangulates the outer faces of the body of a drawing, or takes those of a mesh of volumes or of faces.
/// @param body  its mesh, size_factor and name; of order 1
/// Needs a GmshSession. Throws InputError as open_surface and read_mesh do, and if there are no faces.
Triangulation triangulate(const scene::Body& body);

}  // namespace ricochet::mesh
