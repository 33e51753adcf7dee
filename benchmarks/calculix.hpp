// SPDX-License-Identifier: BSD-2-Clause
// The free vibrations of a body as a task for CalculiX, a peer to compare with.
#pragma once

#include <filesystem>

#include "src/mesh/mesh.hpp"

namespace ricochet::bench {

/// Writes the input of `ccx` for the `count` lowest modes of a body, rigid ones included: same nodes,
/// elements, materials and supports. Frequencies appear in its .dat file. Rank 0 only. Throws InputError for
/// a mesh of other elements than tetrahedra of order 1 and 2, and for a place that can't be written.
void write_calculix(const mesh::GlobalMesh& mesh, const scene::Body& body, std::int64_t count,
                    const std::filesystem::path& path);

}  // namespace ricochet::bench
