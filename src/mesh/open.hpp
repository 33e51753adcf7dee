// SPDX-License-Identifier: BSD-2-Clause
// From a body's file to a meshed gmsh model.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "src/scene/scene.hpp"

namespace ricochet::mesh {

/// Opens the mesh of a body, or its geometry, which is then meshed with elements of the body's order.
/// @return whether the file already held the mesh; its elements then keep their order
/// Rank 0 only; needs a GmshSession made with the geometry values of the body. Throws InputError: no such
/// file, a .msh that is not a mesh or is truncated, a `geometry` name that the file does not define.
bool open_model(const scene::Body& body);

/// The extent of a body, without meshing it.
struct Extent {
  double length = 0;  ///< longest side of its bounding box [m]
  int dimension = 3;  ///< 1: a rod
};
/// Has the requirements and errors of open_model.
Extent extent_of(const scene::Body& body);

/// The names that `geometry` can set in a .geo file: those in its DefineConstant lists and those that it
/// tests by Exists. Includes are read too.
std::set<std::string> parameters_of(const std::filesystem::path& geo);

}  // namespace ricochet::mesh
