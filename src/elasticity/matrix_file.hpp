// SPDX-License-Identifier: BSD-2-Clause
// Stiffness and mass that another program assembled.
#pragma once

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// The matrices of a body file (docs/interchange.md), for a mesh from read_body_file on any number of ranks.
/// Displacements that they have no row for become held in `mesh`, whose connected parts are those of the
/// stiffness. Mass, centre and inertia are those of the mass matrix, the wave speed that of uniform stretch.
///
/// @param moved  as of Imposing
/// Collective. Throws InputError on every rank: no matrices, sizes that differ, not symmetric, a diagonal
/// that is not positive, a mass that differs by direction. Definiteness is not looked at (modes::examine).
Body read_matrices(mesh::Mesh& mesh, const std::filesystem::path& path,
                   const std::vector<std::string>& moved = {});

}  // namespace ricochet::elasticity
