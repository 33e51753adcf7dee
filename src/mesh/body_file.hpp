// SPDX-License-Identifier: BSD-2-Clause
// Bodies that another program discretised: their nodes and surfaces, in the layout of docs/interchange.md.
#pragma once

#include "base/hdf5_reader.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// What is wrong with a body file ends with this advice.
inline constexpr const char* body_file_advice = "Its layout is that of docs/interchange.md.";

/// Opens a body file. Throws InputError when it is not one, or of a version that is not known here.
base::hdf5::Reader open_body_file(const std::filesystem::path& path);

/// Nodes, facets and supports of the body file `body.mesh`; there are no elements. Rank 0 only; needs a
/// GmshSession. Throws InputError: not such a file, no surface of a name asked for, a node out of range.
GlobalMesh read_body_file(const scene::Body& body, const Asked& asked);

}  // namespace ricochet::mesh
