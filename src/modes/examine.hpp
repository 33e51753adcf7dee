// SPDX-License-Identifier: BSD-2-Clause
// Whether matrices from elsewhere are those of an elastic body.
#pragma once

#include "src/modes/operators.hpp"

namespace ricochet::modes {

/// Three factorisations: rigid motion costs no strain energy; M is positive definite; and there are as many
/// modes at zero frequency as rigid motions that the supports leave, none below (Sylvester's law). `origin`
/// names the matrices in messages. Collective on the factorisation's ranks. Throws InputError on every rank.
void examine(const mesh::Mesh& mesh, const elasticity::Body& body, Factorisation& factor,
             const std::string& origin);

}  // namespace ricochet::modes
