// SPDX-License-Identifier: BSD-2-Clause
// The size of matrices before they are assembled.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::elasticity {

/// This rank's number of pairs of nodes that share an element, each once and with the pairs of a node with
/// itself. Each pair is a block of K and M; those of nodes on two ranks count half on each. Counted for at
/// most `sample` nodes, from which the others are extrapolated.
double expected_blocks(const mesh::Mesh& mesh, std::int64_t sample = 4000);

/// This rank's memory of K and M [MiB], with their copies for products and as input of a factorisation.
/// Factors are not included. 0 for a body without elements.
double expected_mib(const mesh::Mesh& mesh);

/// A lower bound of that memory [MiB] for a whole solid with these nodes, before its mesh is read.
double least_mib(std::int64_t nodes);

}  // namespace ricochet::elasticity
