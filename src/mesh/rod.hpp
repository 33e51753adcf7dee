// Internal to src/mesh: what is particular to rods.
#pragma once

#include <string>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Sets `mesh.axis`. Throws InputError for a rod that is bent or not one chain.
void find_axis(GlobalMesh& mesh, const std::string& file);

/// Sets `mesh.contact.end_normal` at the contact points. Throws InputError for one that is not an end.
void orient_ends(GlobalMesh& mesh, const Block& points, const scene::Body& body);

/// The skin of a rod: a line for each element.
Block lines_of(const std::vector<Block>& blocks);

}  // namespace ricochet::mesh
