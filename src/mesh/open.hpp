// SPDX-License-Identifier: BSD-2-Clause
// From a body's file to a meshed gmsh model.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "src/scene/scene.hpp"

namespace ricochet::mesh {

/// Opens a body's mesh, or its geometry, which is then meshed with elements of the body's order.
/// @return whether the file held the mesh already; its elements then keep their order
/// Rank 0 only; needs a GmshSession made with the body's geometry values. Throws InputError: no such file, a
/// .msh that is no mesh or cut off, a `geometry` name that the file does not define.
bool open_model(const scene::Body& body);

/// A body's geometry or mesh, without meshing it. Needs and throws what open_model does.
struct Extent {
  double length = 0;  ///< longest side of the box around it [m]
  int dimension = 3;  ///< 1: a rod
};
Extent extent_of(const scene::Body& body);

/// What `geometry` can set in a .geo: the names in its DefineConstant lists and those it asks for by Exists,
/// its Includes read too.
std::set<std::string> parameters_of(const std::filesystem::path& geo);

}  // namespace ricochet::mesh
