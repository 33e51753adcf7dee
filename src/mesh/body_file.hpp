// SPDX-License-Identifier: BSD-2-Clause
// Bodies discretised by another program: their nodes and surfaces, in the layout of docs/interchange.md.
#pragma once

#include "base/hdf5_reader.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Advice at the end of every error message about a body file.
inline constexpr const char* body_file_advice = "Its layout is that of docs/interchange.md.";

/// Opens a body file. Throws InputError if it is not one, or if its version is unknown.
base::hdf5::Reader open_body_file(const std::filesystem::path& path);

/// Reads nodes, facets and supports from the body file `body.mesh`, which contains no elements. Rank 0 only;
/// needs a GmshSession. Throws InputError if it is not a body file, lacks a requested surface, or refers to a
/// node that does not exist.
GlobalMesh read_body_file(const scene::Body& body, const RequestedGroups& asked);

}  // namespace ricochet::mesh
