// SPDX-License-Identifier: BSD-2-Clause
// The size of matrices before they are assembled.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::elasticity {

/// Number of pairs of nodes that share an element, each once and with the pairs of a node with itself. Each
/// pair is a block of K and M. Counted for at most `sample` nodes, from which the others are extrapolated.
double expected_blocks(const mesh::GlobalMesh& mesh, std::int64_t sample = 4000);

/// Memory of K and M of a whole mesh [MiB], with their copies for products and as input of a factorisation.
/// Factors are not included.
double expected_mib(const mesh::GlobalMesh& mesh);

}  // namespace ricochet::elasticity
