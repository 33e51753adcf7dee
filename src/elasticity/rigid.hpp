// SPDX-License-Identifier: BSD-2-Clause
// Rigid modes of a body.
#pragma once

#include <Eigen/Dense>

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

/// Returns the rigid motions that the supports leave free, M-orthonormal, one in each column. For each
/// connected part, a free body has six and a free rod has one; translations come first.
/// @return (local rows, r). Collective.
Eigen::MatrixXd rigid_modes(const mesh::Mesh& mesh, const Body& body);

}  // namespace ricochet::elasticity
