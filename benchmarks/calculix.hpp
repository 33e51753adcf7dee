// SPDX-License-Identifier: BSD-2-Clause
// Input files for CalculiX, which computes the same modes of a body for comparison.
#pragma once

#include <filesystem>

#include "src/mesh/mesh.hpp"

namespace ricochet::bench {

/// Writes input from which `ccx` computes the `count` lowest modes of a body, including rigid modes, with the
/// same nodes, elements, materials and supports. `ccx` writes the frequencies to its .dat file. Call on rank
/// 0 only. Throws InputError if the mesh has elements other than tetrahedra of order 1 and 2, or if the file
/// cannot be written.
void write_calculix(const mesh::GlobalMesh& mesh, const scene::Body& body, std::int64_t count,
                    const std::filesystem::path& path);

}  // namespace ricochet::bench
