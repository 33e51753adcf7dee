// SPDX-License-Identifier: BSD-2-Clause
// Stiffness and mass that another program assembled.
#pragma once

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// Reads the matrices of a body file (docs/interchange.md). `mesh` comes from read_body_file and may be
/// distributed over any number of ranks. Displacements without a row are marked as fixed in `mesh`, and its
/// connected parts are set to those of the stiffness. Mass, centre and inertia are computed from the mass
/// matrix, and the wave speed from uniform stretch.
///
/// @param moved  as for Imposing
/// Collective. Throws InputError on every rank if there are no matrices, their sizes are wrong, they are not
/// symmetric, a diagonal entry is not positive, or the mass depends on the direction. Definiteness is checked
/// separately, by modes::validate_matrices.
Body read_matrices(mesh::Mesh& mesh, const std::filesystem::path& path,
                   const std::vector<std::string>& moved = {});

}  // namespace ricochet::elasticity
