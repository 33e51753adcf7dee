// SPDX-License-Identifier: BSD-2-Clause
// Rigid modes of a body.
#pragma once

#include <Eigen/Dense>

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// Rigid motions that the supports leave free, M-orthonormal, one column each: six for a free body, one for a
/// free rod, and as many for each connected part of the body. Translations come first in each part.
/// @return (local rows, r). Collective.
Eigen::MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body);

}  // namespace ricochet::elasticity
