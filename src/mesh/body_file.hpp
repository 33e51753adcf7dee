// SPDX-License-Identifier: BSD-2-Clause
// Bodies discretised by another program: their nodes and surfaces, in the layout of docs/interchange.md.
#pragma once

#include "base/hdf5_reader.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Advice that ends every error of a body file.
inline constexpr const char* body_file_advice = "Its layout is that of docs/interchange.md.";

/// Opens a body file. Throws InputError if it is not one, or if its version is unknown.
base::hdf5::Reader open_body_file(const std::filesystem::path& path);

/// Reads nodes, facets and supports of the body file `body.mesh`; it has no elements. Rank 0 only; needs a
/// GmshSession. Throws InputError: not a body file, no surface of a requested name, a node out of range.
GlobalMesh read_body_file(const scene::Body& body, const RequestedGroups& asked);

}  // namespace ricochet::mesh
