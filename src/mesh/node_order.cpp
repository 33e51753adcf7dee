// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/node_order.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "src/mesh/element_shape.hpp"

namespace ricochet::mesh {

namespace {

/// For each node of gmsh's element, its position in the list of another program.
using Order = std::vector<int>;

/// The corners as they are, and of the mirrored element.
std::vector<Order> orders_of_corners(const ReferenceElement& element) {
  Order same(static_cast<std::size_t>(element.corners));
  std::iota(same.begin(), same.end(), 0);
  Order mirrored = same;
  if (element.family == Family::tetrahedron)
    std::swap(mirrored[1], mirrored[2]);
  else  // the bottom becomes the top
    std::rotate(mirrored.begin(), mirrored.begin() + element.corners / 2, mirrored.end());
  return {std::move(same), std::move(mirrored)};
}

Positions ordered(const Positions& at, const Order& order) {
  Positions out(at.rows(), 3);
  for (int a = 0; a < at.rows(); ++a) out.row(a) = at.row(order[static_cast<std::size_t>(a)]);
  return out;
}

/// Continues an order of the corners by the nodes that lie nearest to where straight edges have them. No
/// value if a node would be used twice.
std::optional<Order> completed(Order order, const Positions& at, const ElementShape& shape) {
  const int corners = shape.corners();
  Positions placed = at;
  for (int a = 0; a < corners; ++a) placed.row(a) = at.row(order[static_cast<std::size_t>(a)]);
  const Positions straight = shape.straight(placed);
  std::vector<char> used(static_cast<std::size_t>(at.rows()), 0);
  for (int a = corners; a < at.rows(); ++a) {
    int nearest = corners;
    for (int b = corners; b < at.rows(); ++b)
      if ((at.row(b) - straight.row(a)).squaredNorm() < (at.row(nearest) - straight.row(a)).squaredNorm())
        nearest = b;
    if (std::exchange(used[static_cast<std::size_t>(nearest)], 1) != 0) return std::nullopt;
    order.push_back(nearest);
  }
  return order;
}

std::size_t count_in(const GlobalMesh& mesh, const Block& block, const ElementShape& shape,
                     const Order& order) {
  std::size_t inverted = 0;
  for (std::size_t e = 0; e < block.size(); ++e)
    inverted += shape.is_inverted(ordered(positions_of(mesh, block, e), order)) ? 1 : 0;
  return inverted;
}

void reorder(Block& block, std::size_t element, const Order& order) {
  const auto first = block.node.begin() + static_cast<std::ptrdiff_t>(element * order.size());
  const std::vector<std::int64_t> nodes(first, first + std::ssize(order));
  for (std::size_t a = 0; a < order.size(); ++a)
    first[static_cast<std::ptrdiff_t>(a)] = nodes[static_cast<std::size_t>(order[a])];
}

/// @return number of corrected elements
std::size_t correct(const GlobalMesh& mesh, Block& block) {
  const ElementShape shape(block.gmsh_type);
  const std::vector<Order> corners = orders_of_corners(shape.reference());
  Order same(static_cast<std::size_t>(block.nodes_per_element));
  std::iota(same.begin(), same.end(), 0);
  if (block.size() == 0 || shape.reference().dim != 3 || count_in(mesh, block, shape, same) == 0) return 0;
  for (const Order& of_corners : corners) {
    const auto order = completed(of_corners, positions_of(mesh, block, 0), shape);
    if (!order || *order == same || count_in(mesh, block, shape, *order) > 0) continue;
    for (std::size_t e = 0; e < block.size(); ++e) reorder(block, e, *order);
    return block.size();
  }
  if (shape.reference().order > 1) return 0;
  // Some elements may be mirrored and others not.
  std::vector<std::size_t> mirrored;
  for (std::size_t e = 0; e < block.size(); ++e) {
    const Positions at = positions_of(mesh, block, e);
    if (!shape.is_inverted(at)) continue;
    if (shape.is_inverted(ordered(at, corners[1]))) return 0;
    mirrored.push_back(e);
  }
  for (const std::size_t e : mirrored) reorder(block, e, corners[1]);
  return mirrored.size();
}

}  // namespace

std::int64_t correct_node_order(GlobalMesh& mesh) {
  std::size_t corrected = 0;
  for (Block& block : mesh.blocks) corrected += correct(mesh, block);
  return static_cast<std::int64_t>(corrected);
}

}  // namespace ricochet::mesh
