// SPDX-License-Identifier: BSD-2-Clause
// Connected parts of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// For each of `nodes` nodes, the lowest node that elements connect it to.
std::vector<std::int64_t> first_connected(std::size_t nodes, const std::vector<Block>& blocks);

}  // namespace ricochet::mesh
