// SPDX-License-Identifier: BSD-2-Clause
// Validation of a .msh file before gmsh reads it.
#pragma once

#include <filesystem>

namespace ricochet::mesh {

/// Validates a .msh file. gmsh trusts the counts, types, tags and sections of a file, so a wrong one can end
/// the program or exhaust memory. This function reads the file once and refuses contents that gmsh cannot
/// handle safely: versions other than 2 to 2.2 and 4.1, sections that are not part of a mesh (results, ghost
/// cells, parametrisations), counts that disagree, elements of unknown type or with unknown nodes, and
/// numbers that are not finite.
/// Needs a GmshSession for the element types. Throws InputError "FILE: line N: what".
void check_msh(const std::filesystem::path& msh);

}  // namespace ricochet::mesh
