// SPDX-License-Identifier: BSD-2-Clause
// Stiffness and mass that another program assembled.
#pragma once

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// Reads the matrices of a body file (docs/interchange.md), for a mesh from read_body_file on any number of
/// ranks. Displacements without a row become held in `mesh`, whose connected parts become those of the
/// stiffness. Mass, centre and inertia follow from the mass matrix, the wave speed from uniform stretch.
///
/// @param moved  as for Imposing
/// Collective. Throws InputError on every rank: no matrices, sizes that differ, not symmetric, a diagonal
/// that is not positive, a mass that depends on the direction. Definiteness is not tested here
/// (modes::validate_matrices).
Body read_matrices(mesh::Mesh& mesh, const std::filesystem::path& path,
                   const std::vector<std::string>& moved = {});

}  // namespace ricochet::elasticity
