// SPDX-License-Identifier: BSD-2-Clause
// Rigid modes of a body.
#pragma once

#include <Eigen/Dense>

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// Returns the motions without strain that the supports leave free, M-orthonormal, one in each column. For
/// each connected part, a free body has six and a free rod has one; translations come first. A part whose
/// pieces hinge on shared edges or points moves as a whole first, then about its hinges.
/// @return (local rows, r). Collective. Throws InputError on all ranks if a part has too many pieces.
Eigen::MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body);

/// Returns the number of rigid modes in which pieces of a connected part move against each other, because
/// they are joined at edges or points only. Collective. Throws like rigid_modes.
std::int64_t mechanisms(const mesh::Mesh& mesh);

}  // namespace ricochet::elasticity
