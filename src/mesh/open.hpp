// SPDX-License-Identifier: BSD-2-Clause
// Opens the file of a body as a meshed gmsh model.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "src/scene/data/body.hpp"

namespace ricochet::mesh {

struct Opened {
  std::string sewn;            ///< how loose faces were joined, for the user; empty if there were none
  bool meshed_before = false;  ///< whether the file already contained a mesh
};

/// Opens the mesh of a body. A geometry is meshed with elements of the body's order; an existing mesh keeps
/// the order of its elements. Rank 0 only; needs a GmshSession.
/// Throws InputError if the file does not exist, a .msh file is not a mesh or is truncated, or `geometry`
/// contains a name that the file does not define, or the faces of a drawing enclose no volume.
Opened open_model(const scene::Body& body);

/// The same for the surface alone: a geometry gets no elements in its volumes, and a full circle at least
/// `triangles_around` edges of triangles, unless a .geo gives another number (Mesh.MeshSizeFromCurvature).
Opened open_surface(const scene::Body& body);
inline constexpr double triangles_around = 48;

/// Throws InputError if the file of a body cannot be opened: it does not exist or is of a kind that gmsh does
/// not read, or `geometry` contains a name that it does not define.
void check_file(const scene::Body& body);

/// The .msh files of version 4.1 of a body, one or several parts; none if its mesh is another one. Throws
/// InputError for the reasons of check_file, and if a part is missing or of another version.
std::vector<std::filesystem::path> msh_files(const scene::Body& body);

/// Extent of a body, determined without meshing it.
struct Extent {
  double length = 0;  ///< longest side of its bounding box [m]
  int dimension = 3;  ///< 1: a rod
};
/// Returns the extent of a body. Has the requirements and errors of open_model.
Extent extent_of(const scene::Body& body);

/// Returns the names that `geometry` can set in a .geo file: the names in its DefineConstant lists and the
/// names that it tests with Exists. Included files are searched too.
std::set<std::string> parameters_of(const std::filesystem::path& geo);

}  // namespace ricochet::mesh
