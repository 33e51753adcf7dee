// SPDX-License-Identifier: BSD-2-Clause
// The mesh of one body: complete on rank 0, or distributed over the ranks.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "src/mesh/reference.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/data/body.hpp"

namespace ricochet::mesh {

/// Sorts numbers in ascending order and removes duplicates.
template <class Number>
void sort_once(std::vector<Number>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Elements of one gmsh type.
struct Block {
  int gmsh_type = 0;
  int nodes_per_element = 0;
  std::vector<std::int64_t> node;   ///< (elements, nodes_per_element) indices into the node list of the mesh
  std::vector<std::int64_t> tag;    ///< (elements) tags in gmsh, for messages
  std::vector<std::int64_t> label;  ///< (elements) index of the material (volume) or contact group (facet)
  std::size_t size() const { return tag.size(); }
};

/// Facets with the coordinates of their nodes. Contact and loaded surfaces are the same on every rank; the
/// visualisation surface exists on rank 0 only.
struct FacetMesh {
  std::vector<std::int64_t> node;  ///< (n) global node numbers
  std::vector<double> position;    ///< (n,3) [m]
  /// Oriented outward; Block::node: indices into `node`. The visualisation surface has triangles between all
  /// nodes of its faces and, if the elements are of order 2 or more, as a second block those between corners
  /// alone.
  std::vector<Block> blocks;
  /// (n,3) for rods: outward normal times cross-section at each end [m²]; otherwise empty
  std::vector<double> end_normal;
};

/// Groups that are read from a mesh in addition to the contact surface.
struct RequestedGroups {
  std::vector<std::string> loaded;  ///< distinct surfaces (rods: points) under tractions
  std::vector<std::string> moved;   ///< distinct moving supports
};

/// The complete mesh of a body, as read on rank 0.
struct GlobalMesh {
  int dim = 3;  ///< 3, or 1 for a rod
  int order = 1;
  std::vector<double> position;  ///< (n,3) [m], scaled
  std::vector<Block> blocks;
  /// (n) bit field. Bit c: a support holds component c; bit 3 + s: the node belongs to the moving support
  /// RequestedGroups::moved[s].
  std::vector<std::int64_t> fixed;
  Vector3 axis{1, 0, 0};  ///< rods: unit vector along the body
  /// Surfaces. Block::node: indices into `position`; Block::label of `loaded`: index into
  /// RequestedGroups::loaded.
  FacetMesh contact, loaded, visualisation;
  std::vector<std::string> warnings{};  ///< of the reader, for the user
};

/// Elements of one connected part that hang together through faces. Pieces of a part share nodes at edges or
/// points, about which they may turn.
struct Piece {
  std::int64_t part = 0, elements = 0;
  std::array<double, 6> box{};  ///< lowest, then highest coordinates of its nodes [m]
};

/// One rank's part of a mesh. Each rank holds every element that touches a node it owns, so that assembly
/// needs no communication. An element is `own` on exactly one rank, where integrals over the body count it.
struct Mesh {
  MPI_Comm comm = MPI_COMM_SELF;
  int dim = 3, order = 1;
  Vector3 axis{1, 0, 0};
  std::int64_t total_nodes = 0, total_elements = 0;
  std::int64_t first_node = 0, owned_nodes = 0;  ///< this rank owns global nodes [first, first + owned)
  std::vector<std::int64_t> node;                ///< (n_local) global numbers, ascending
  std::vector<std::int64_t> canonical;  ///< (n_local) 0 … total_nodes − 1, independent of the number of ranks
  std::vector<double> position;         ///< (n_local,3) [m]
  std::vector<std::int64_t> fixed;      ///< (n_local) as in GlobalMesh
  std::vector<std::int64_t> part;       ///< (n_local) index of the connected part
  std::int64_t parts = 1;               ///< number of connected parts, which share no node
  /// The same on every rank; ordered by part, then by the lowest tags of their elements. Empty if the parts
  /// are one or unknown, and each of them is one piece.
  std::vector<Piece> pieces;
  /// (n_local) piece of each node that this rank owns, the first if it has several; empty if each part is
  /// one.
  std::vector<std::int64_t> piece;
  /// The other pieces of nodes that this rank owns: local node number, piece.
  std::vector<std::pair<std::size_t, std::int64_t>> joint;
  std::vector<Block> blocks;                   ///< node indices are local
  std::vector<std::vector<std::int64_t>> own;  ///< per block and element: 1 if the element is own
  FacetMesh contact, loaded;                   ///< global node numbers, the same on every rank
  FacetMesh visualisation;                     ///< global node numbers, on rank 0 only

  int components() const { return dim == 3 ? 3 : 1; }
  /// Index of a global node among the nodes that this rank owns; negative if another rank owns it.
  std::int64_t owned(std::int64_t global) const {
    return global < first_node + owned_nodes ? global - first_node : -1;
  }
  /// Calls visit(local number, number among the owned nodes) for each node that this rank owns.
  template <class Visit>
  void for_each_owned(Visit&& visit) const {
    for (std::size_t i = 0; i < node.size(); ++i)
      if (const std::int64_t row = owned(node[i]); row >= 0) visit(i, row);
  }
  /// Whether this moving support holds the node.
  bool is_moved(std::size_t local_node, std::size_t support) const {
    return (fixed[local_node] >> (3 + support)) & 1;
  }
  /// Whether a support holds this displacement component. A rod has one component, along its axis.
  bool is_fixed(std::size_t local_node, int component) const { return (fixed[local_node] >> component) & 1; }
};

}  // namespace ricochet::mesh
