// SPDX-License-Identifier: BSD-2-Clause
// Validation of matrices from another program.
#pragma once

#include "src/modes/operators.hpp"

namespace ricochet::modes {

/// Checks with three factorisations that the matrices are those of an elastic body: rigid motion has no
/// strain energy, M is positive definite, and there are as many zero eigenvalues as rigid motions that the
/// supports leave free, and no negative ones. The eigenvalues are counted by Sylvester's law of inertia.
/// `origin` names the matrices in messages. Collective on the ranks of the factorisation. Throws InputError
/// on every rank.
void validate_matrices(const mesh::Mesh& mesh, const elasticity::Body& body, Factorisation& factor,
                       const std::string& origin);

}  // namespace ricochet::modes
