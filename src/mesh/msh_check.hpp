// SPDX-License-Identifier: BSD-2-Clause
// A .msh file as a whole, before gmsh sees it.
#pragma once

#include <filesystem>

namespace ricochet::mesh {

/// gmsh believes counts, types, tags and sections of a file, and a wrong one can end the program or take all
/// memory. This reads the file once and refuses what gmsh can't be trusted with: versions other than 2 to 2.2
/// and 4.1, sections that are no mesh (results, ghost cells, parametrisations), counts that do not agree,
/// elements of unknown type or of nodes that are not there, numbers that are not finite.
/// Needs a GmshSession, for what its element types are. Throws InputError "FILE: line N: what".
void check_msh(const std::filesystem::path& msh);

}  // namespace ricochet::mesh
