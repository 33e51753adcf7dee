// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/pieces.hpp"

#include <limits>
#include <tuple>

#include "src/mesh/connected.hpp"
#include "src/mesh/directory.hpp"

namespace ricochet::mesh {

namespace {

using Numbers = std::vector<std::int64_t>;

/// Calls visit(number of the element on this rank, block, its first node) for each element of this rank.
template <class Visit>
void for_each_element(const Mesh& mesh, const Visit& visit) {
  std::size_t element = 0;
  for (const Block& block : mesh.blocks)
    for (std::size_t e = 0; e < block.size(); ++e, ++element)
      visit(element, block, e, &block.node[e * static_cast<std::size_t>(block.nodes_per_element)]);
}

/// Returns, for each element of this rank, the lowest one to which faces connect it on this rank.
Numbers connected_by_faces(const Mesh& mesh) {
  struct Face {
    std::array<std::int32_t, 4> corner;
    std::int32_t element;
    bool operator<(const Face& other) const {
      return std::tie(corner, element) < std::tie(other.corner, other.element);
    }
  };
  std::vector<Face> faces;
  std::size_t elements = 0;
  for (const Block& block : mesh.blocks) {
    const auto pattern = outward_faces(reference_element(block.gmsh_type).family);
    for (std::size_t e = 0; e < block.size(); ++e, ++elements)
      for (const std::vector<int>& corners : pattern) {
        Face face{{-1, -1, -1, -1}, static_cast<std::int32_t>(elements)};
        for (std::size_t c = 0; c < corners.size(); ++c)
          face.corner[c] =
              static_cast<std::int32_t>(block.node[e * static_cast<std::size_t>(block.nodes_per_element) +
                                                   static_cast<std::size_t>(corners[c])]);
        std::ranges::sort(face.corner);
        faces.push_back(face);
      }
  }
  std::sort(faces.begin(), faces.end());
  Connections connections(elements);
  for (std::size_t k = 1; k < faces.size(); ++k)
    if (faces[k].corner == faces[k - 1].corner) connections.join(faces[k - 1].element, faces[k].element);
  Numbers first(elements);
  for (std::size_t e = 0; e < elements; ++e) first[e] = connections.first(static_cast<std::int64_t>(e));
  return first;
}

/// Whether some node that this rank owns belongs to elements of several `groups`. This rank holds all
/// elements of such a node, and they form one group if faces connect them around it.
bool has_joint(const Mesh& mesh, const Numbers& groups) {
  Numbers seen(mesh.node.size(), -1);
  bool found = false;
  for_each_element(mesh, [&](std::size_t element, const Block& block, std::size_t, const std::int64_t* node) {
    for (int k = 0; k < block.nodes_per_element; ++k) {
      const auto i = static_cast<std::size_t>(node[k]);
      if (mesh.owned(mesh.node[i]) < 0) continue;
      found = found || (seen[i] >= 0 && seen[i] != groups[element]);
      seen[i] = groups[element];
    }
  });
  return found;
}

/// Returns the lowest tag of an element to which faces connect each element of this rank, on any rank.
/// Collective.
Numbers lowest_tags(const Mesh& mesh, const Numbers& first) {
  Numbers tags;
  for (const Block& block : mesh.blocks) tags.insert(tags.end(), block.tag.begin(), block.tag.end());
  return lowest_connected(mesh.comm, Directory(mesh.comm, tags), tags, first);
}

/// Replaces the tags by which elements are known by the numbers of their pieces, and sets the part of each
/// piece. Collective.
void number_pieces(Mesh& mesh, Numbers& tag_of) {
  // Part and tag of each piece on this rank, as pairs in a row.
  std::vector<std::array<std::int64_t, 2>> own;
  for_each_element(mesh, [&](std::size_t element, const Block&, std::size_t, const std::int64_t* node) {
    own.push_back({mesh.part[static_cast<std::size_t>(node[0])], tag_of[element]});
  });
  const auto mine = own;
  sort_once(own);
  Numbers flat;
  for (const auto& pair : own) flat.insert(flat.end(), pair.begin(), pair.end());
  flat = parallel::gather(mesh.comm, flat);
  parallel::broadcast(mesh.comm, flat);
  own.clear();
  for (std::size_t k = 0; k < flat.size(); k += 2) own.push_back({flat[k], flat[k + 1]});
  sort_once(own);
  for (const auto& pair : own) mesh.pieces.push_back({.part = pair[0]});
  for (std::size_t e = 0; e < mine.size(); ++e)
    tag_of[e] = std::ranges::lower_bound(own, mine[e]) - own.begin();
}

/// Sets the pieces of the nodes that this rank owns.
void set_nodes(Mesh& mesh, const Numbers& piece_of) {
  mesh.piece.assign(mesh.node.size(), -1);
  std::vector<std::pair<std::size_t, std::int64_t>> all;
  for_each_element(mesh, [&](std::size_t element, const Block& block, std::size_t, const std::int64_t* node) {
    for (int k = 0; k < block.nodes_per_element; ++k)
      if (mesh.owned(mesh.node[static_cast<std::size_t>(node[k])]) >= 0)
        all.emplace_back(static_cast<std::size_t>(node[k]), piece_of[element]);
  });
  sort_once(all);
  for (const auto& [node, piece] : all) {
    if (mesh.piece[node] < 0)
      mesh.piece[node] = piece;
    else
      mesh.joint.emplace_back(node, piece);
  }
}

/// Sets the box and the number of elements of each piece. Collective.
void measure(Mesh& mesh, const Numbers& piece_of) {
  const std::size_t n = mesh.pieces.size();
  // The lowest of the negative coordinates are the highest ones.
  std::vector<double> lowest(6 * n, std::numeric_limits<double>::max());
  std::vector<double> elements(n, 0);
  for_each_element(mesh,
                   [&](std::size_t element, const Block& block, std::size_t e, const std::int64_t* node) {
                     const auto p = static_cast<std::size_t>(piece_of[element]);
                     const std::size_t b = static_cast<std::size_t>(&block - mesh.blocks.data());
                     elements[p] += static_cast<double>(mesh.own[b][e]);
                     for (int k = 0; k < block.nodes_per_element; ++k)
                       for (std::size_t c = 0; c < 3; ++c) {
                         const double x = mesh.position[3 * static_cast<std::size_t>(node[k]) + c];
                         lowest[6 * p + c] = std::min(lowest[6 * p + c], x);
                         lowest[6 * p + 3 + c] = std::min(lowest[6 * p + 3 + c], -x);
                       }
                   });
  parallel::sum(mesh.comm, elements);
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_DOUBLE, MPI_MIN, mesh.comm);
  for (std::size_t p = 0; p < n; ++p) {
    mesh.pieces[p].elements = static_cast<std::int64_t>(elements[p]);
    for (std::size_t c = 0; c < 6; ++c) mesh.pieces[p].box[c] = (c < 3 ? 1 : -1) * lowest[6 * p + c];
  }
}

}  // namespace

void find_pieces(Mesh& mesh) {
  if (mesh.dim != 3 || mesh.total_elements == 0) return;
  Numbers piece_of = connected_by_faces(mesh);
  const bool jointed = parallel::sum(mesh.comm, std::int64_t{has_joint(mesh, piece_of) ? 1 : 0}) > 0;
  if (!jointed && mesh.parts == 1) return;
  piece_of = lowest_tags(mesh, piece_of);
  number_pieces(mesh, piece_of);
  if (std::ssize(mesh.pieces) > mesh.parts) set_nodes(mesh, piece_of);
  measure(mesh, piece_of);
  if (mesh.pieces.size() == 1) mesh.pieces.clear();
}

}  // namespace ricochet::mesh
