// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/locate.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <unordered_map>

namespace ricochet::surface {

namespace {

using Eigen::Vector3d;
using mesh::Family;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Moves `xi` to the nearest point of the triangle or tetrahedron ξ ≥ 0, Σ ξ ≤ 1.
void to_simplex(double* xi, int dim) {
  const auto cut = [&](double level) {
    double sum = 0;
    for (int d = 0; d < dim; ++d) sum += std::max(xi[d] - level, 0.0);
    return sum;
  };
  double level = 0;
  if (cut(0) > 1) {
    std::vector<double> sorted(xi, xi + dim);
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    double sum = 0;
    for (int d = 0; d < dim; ++d) {
      sum += sorted[static_cast<std::size_t>(d)];
      if (const double next = (sum - 1) / (d + 1); sorted[static_cast<std::size_t>(d)] > next) level = next;
    }
  }
  for (int d = 0; d < dim; ++d) xi[d] = std::max(xi[d] - level, 0.0);
}

void to_element(const mesh::ReferenceElement& element, Vector3d& xi) {
  int first = 0;
  if (element.family == Family::tetrahedron) first = 3;
  if (element.family == Family::prism) first = 2;
  to_simplex(xi.data(), first);
  for (int d = first; d < element.dim; ++d) xi[d] = std::clamp(xi[d], -1.0, 1.0);
}

/// Maps local coordinates of one element to positions.
struct Map {
  const mesh::ReferenceElement& element;
  Eigen::Matrix<double, 3, Eigen::Dynamic> position;  ///< (3, nodes)
  Eigen::VectorXd shape{};                            ///< at the last evaluated position
  Eigen::MatrixXd jacobian{};                         ///< (3, dim)

  Vector3d operator()(const Vector3d& xi) {
    const mesh::Basis basis = mesh::basis_at(element, {xi[0], xi[1], xi[2]});
    shape = Eigen::Map<const Eigen::VectorXd>(basis.value.data(), basis.nodes);
    jacobian = position * Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                              basis.gradient.data(), basis.nodes, 3)
                              .leftCols(element.dim);
    return position * shape;
  }
};

Vector3d centre_of(const mesh::ReferenceElement& element) {
  Vector3d centre = Vector3d::Zero();
  for (int a = 0; a < element.corners; ++a)
    for (int d = 0; d < element.dim; ++d)
      centre[d] += element.node[static_cast<std::size_t>(a * element.dim + d)] / element.corners;
  return centre;
}

/// Returns the local coordinates of `point` in an element, by Newton's method. If they lie outside the
/// element, returns the nearest local coordinates inside.
Vector3d by_newton(Map& map, const Vector3d& point) {
  const int dim = map.element.dim;
  const Vector3d centre = centre_of(map.element);
  Vector3d xi = centre;
  // Newton's method may diverge if the point is outside a curved element.
  for (int step = 0; step < 30 && (xi - centre).norm() < 4; ++step) {
    const Vector3d off = point - map(xi);
    const Eigen::VectorXd move =
        (map.jacobian.transpose() * map.jacobian).ldlt().solve(map.jacobian.transpose() * off);
    xi.head(dim) += move;
    if (!(move.norm() > 1e-14)) break;
  }
  if (!xi.allFinite()) xi = centre;
  to_element(map.element, xi);
  return xi;
}

/// Returns the local coordinates of the position in an element nearest to `point`, by projected gradients.
Vector3d by_gradients(Map& map, const Vector3d& point) {
  Vector3d xi = by_newton(map, point);
  for (int step = 0; step < 200; ++step) {
    const Vector3d off = point - map(xi);
    Vector3d next = xi;
    next.head(map.element.dim) += map.jacobian.transpose() * off / map.jacobian.squaredNorm();
    to_element(map.element, next);
    const double move = (next - xi).norm();
    xi = next;
    if (move < 1e-12) break;
  }
  return xi;
}

/// An element, and a lower bound on its distance from the point, computed from its bounding box.
struct Near {
  double distance;
  std::size_t block, element;
};

std::vector<Near> by_distance(const mesh::Mesh& mesh, const Vector3d& point) {
  std::vector<Near> all;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const mesh::Block& block = mesh.blocks[b];
    const auto n = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t e = 0; e < block.size(); ++e) {
      if (mesh.own[b][e] == 0) continue;
      Vector3d low = Vector3d::Constant(infinity), high = -low;
      for (std::size_t a = 0; a < n; ++a) {
        const Vector3d x(&mesh.position[3 * static_cast<std::size_t>(block.node[e * n + a])]);
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
      }
      // Curved elements extend beyond the bounding box of their nodes.
      const double bulge = mesh.order > 1 ? 0.25 * (high - low).norm() : 0;
      const double distance = (low - point).cwiseMax(point - high).cwiseMax(0.0).norm();
      all.push_back({std::max(distance - bulge, 0.0), b, e});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Near& a, const Near& b) { return a.distance < b.distance; });
  return all;
}

/// Stores the position at `xi` in `best` if it is nearer to `point` than the present one.
void take_nearer(Map& map, const Vector3d& xi, const Vector3d& point, const mesh::Mesh& mesh,
                 const std::int64_t* nodes, std::int64_t label, Located& best) {
  const Vector3d place = map(xi);
  const double distance = (place - point).norm();
  if (distance >= best.distance) return;
  best.distance = distance;
  best.place = {place[0], place[1], place[2]};
  best.node.clear();
  for (Eigen::Index a = 0; a < map.position.cols(); ++a)
    best.node.push_back(mesh.node[static_cast<std::size_t>(nodes[a])]);
  best.weight.assign(map.shape.data(), map.shape.data() + map.shape.size());
  best.corner_weight =
      mesh::basis_at(mesh::reference_element(mesh::type_of(map.element.family, 1)), {xi[0], xi[1], xi[2]})
          .value;
  best.label = label;
}

/// Returns the nearest node of a body without elements.
Located nearest_node(const mesh::Mesh& mesh, const Vector3d& point) {
  Located best;
  best.distance = infinity;
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const Vector3d x(&mesh.position[3 * i]);
    const double distance = (x - point).norm();
    if (distance >= best.distance) continue;
    best = {.node = {mesh.node[i]}, .weight = {1.0}, .place = {x[0], x[1], x[2]}, .distance = distance};
  }
  return best;
}

/// Searches the own elements of this rank, first for an element that contains the point. If no rank finds
/// one, searches for the nearest position. Collective.
Located locate_here(const mesh::Mesh& mesh, const Vector3d& point) {
  std::vector<mesh::ReferenceElement> references;
  for (const mesh::Block& block : mesh.blocks) references.push_back(mesh::reference_element(block.gmsh_type));
  const std::vector<Near> near = by_distance(mesh, point);
  const double round_off = 1e-13 * size_of(mesh);
  Located best;
  best.distance = infinity;
  const auto search = [&](auto&& place_in, double most) {
    for (const Near& one : near) {
      if (one.distance > most || one.distance >= best.distance || best.distance <= round_off) break;
      const mesh::Block& block = mesh.blocks[one.block];
      const std::int64_t* nodes =
          &block.node[one.element * static_cast<std::size_t>(block.nodes_per_element)];
      Map map{references[one.block], {}};
      map.position.resize(3, block.nodes_per_element);
      for (int a = 0; a < block.nodes_per_element; ++a)
        map.position.col(a) = Vector3d(&mesh.position[3 * static_cast<std::size_t>(nodes[a])]);
      take_nearer(map, place_in(map, point), point, mesh, nodes, block.label[one.element], best);
    }
  };
  search(by_newton, 0);
  const double somewhere = -parallel::largest(mesh.comm, -best.distance);
  if (somewhere > round_off) search(by_gradients, infinity);
  return best;
}

}  // namespace

std::vector<Located> at_nodes(const mesh::Mesh& mesh, const std::vector<std::int64_t>& nodes) {
  std::unordered_map<std::int64_t, std::size_t> asked;
  for (std::size_t v = 0; v < nodes.size(); ++v) asked.emplace(nodes[v], v);
  std::vector<Located> own(nodes.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const mesh::Block& block = mesh.blocks[b];
    const mesh::ReferenceElement element = mesh::reference_element(block.gmsh_type);
    const auto n = static_cast<std::size_t>(block.nodes_per_element),
               corners = static_cast<std::size_t>(element.corners);
    const std::vector<double> linear =
        mesh::basis_at(mesh::reference_element(mesh::type_of(element.family, 1)), mesh::local_nodes(element))
            .value;
    for (std::size_t e = 0; e < block.size(); ++e) {
      if (mesh.own[b][e] == 0) continue;
      for (std::size_t a = 0; a < n; ++a) {
        const auto local = static_cast<std::size_t>(block.node[e * n + a]);
        const auto found = asked.find(mesh.node[local]);
        if (found == asked.end()) continue;
        Located& known = own[found->second];
        if (known.label >= 0 && known.label <= block.label[e]) continue;
        known = {.node = {}, .weight = std::vector<double>(n, 0), .label = block.label[e]};
        for (std::size_t c = 0; c < n; ++c)
          known.node.push_back(mesh.node[static_cast<std::size_t>(block.node[e * n + c])]);
        known.weight[a] = 1;
        const auto from = linear.begin() + static_cast<std::ptrdiff_t>(a * corners);
        known.corner_weight.assign(from, from + static_cast<std::ptrdiff_t>(corners));
        std::copy_n(&mesh.position[3 * local], 3, known.place.begin());
      }
    }
  }
  std::vector<std::int64_t> whole;  // node asked for, label, lengths, nodes
  std::vector<double> parts;        // their weights and places
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    const Located& found = own[v];
    if (found.label < 0) continue;
    whole.insert(whole.end(), {static_cast<std::int64_t>(v), found.label, std::ssize(found.node),
                               std::ssize(found.corner_weight)});
    whole.insert(whole.end(), found.node.begin(), found.node.end());
    for (const auto& values : {found.weight, found.corner_weight})
      parts.insert(parts.end(), values.begin(), values.end());
    parts.insert(parts.end(), found.place.begin(), found.place.end());
  }
  whole = parallel::gather(mesh.comm, whole);
  parts = parallel::gather(mesh.comm, parts);
  parallel::broadcast(mesh.comm, whole);
  parallel::broadcast(mesh.comm, parts);
  std::vector<Located> out(nodes.size());
  auto number = whole.cbegin();
  auto part = parts.cbegin();
  while (number != whole.cend()) {
    Located& known = out[static_cast<std::size_t>(*number++)];
    const std::int64_t label = *number++, n = *number++, corners = *number++;
    Located found{.node = {number, number + n}, .weight = {part, part + n}, .label = label};
    found.corner_weight.assign(part + n, part + n + corners);
    std::copy_n(part + n + corners, 3, found.place.begin());
    number += n;
    part += n + corners + 3;
    if (known.label < 0 || label < known.label) known = std::move(found);
  }
  return out;
}

double size_of(const mesh::Mesh& mesh) {
  Vector3d low = Vector3d::Constant(infinity), high = -low;
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const Vector3d x(&mesh.position[3 * i]);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    const double extent = parallel::largest(mesh.comm, high[c]) + parallel::largest(mesh.comm, -low[c]);
    square += extent * extent;
  }
  return std::sqrt(square);
}

Located locate(const mesh::Mesh& mesh, const Vector3& point) {
  const Vector3d at(point.data());
  Located found = mesh.total_elements == 0 ? nearest_node(mesh, at) : locate_here(mesh, at);
  struct {
    double distance;
    int rank;
  } nearest{found.distance, parallel::rank_of(mesh.comm)};
  MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE_INT, MPI_MINLOC, mesh.comm);
  found.distance = nearest.distance;
  found.place = parallel::of_rank(mesh.comm, nearest.rank, found.place);
  parallel::broadcast(mesh.comm, found.node, nearest.rank);
  parallel::broadcast(mesh.comm, found.weight, nearest.rank);
  parallel::broadcast(mesh.comm, found.corner_weight, nearest.rank);
  found.label = parallel::of_rank(mesh.comm, nearest.rank, found.label);
  return found;
}

}  // namespace ricochet::surface
