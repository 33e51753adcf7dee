// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: what is particular to rods.
#pragma once

#include <string>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Sets `mesh.axis`. Throws InputError for a rod that is bent or not one chain.
void find_axis(GlobalMesh& mesh, const std::string& file);

/// Sets `facets.end_normal` at its points. Throws InputError naming the scene's `key` for one that is not an
/// end.
void orient_ends(const GlobalMesh& mesh, FacetMesh& facets, const scene::Body& body, const std::string& key);

/// The skin of a rod: a line for each element.
Block lines_of(const std::vector<Block>& blocks);

}  // namespace ricochet::mesh
