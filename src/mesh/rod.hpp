// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: operations on rods.
#pragma once

#include <string>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Sets `mesh.axis`. Throws InputError if the rod is bent or is not one chain.
void find_axis(GlobalMesh& mesh, const std::string& file);

/// Sets `facets.end_normal` at the points of `facets`. Throws an InputError that names `key` of the scene if
/// a point is not an end.
void orient_ends(const GlobalMesh& mesh, FacetMesh& facets, const scene::Body& body, const std::string& key);

/// Returns the visualisation surface of a rod: one line for each element.
Block lines_of(const std::vector<Block>& blocks);

}  // namespace ricochet::mesh
