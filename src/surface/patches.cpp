// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/patches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <set>

#include "kernels/algebra.hpp"
#include "src/mesh/lattice.hpp"
#include "src/surface/grid.hpp"

namespace ricochet::surface {

namespace {

using mesh::Block;
using mesh::FacetMesh;

/// Hats on every vertex of the subdivided surface, before merging.
struct Fine {
  std::vector<Eigen::Vector3d> position, normal;  ///< normal: ∫ w n ds
  std::vector<double> area;
  std::vector<std::int64_t> group;
  std::vector<std::map<std::int64_t, double>> load;  ///< per vertex: node index → ∫ w N ds
  std::vector<std::int64_t> simplex;                 ///< flat list of vertices
  int corners = 3;
};

/// Linear or bilinear hats of a cell at the reference point (u, v): triangle on [0,1], quadrangle on [−1,1].
std::array<double, 4> hats(int corners, double u, double v) {
  if (corners == 3) return {1 - u - v, u, v, 0};
  return {(1 - u) * (1 - v) / 4, (1 + u) * (1 - v) / 4, (1 + u) * (1 + v) / 4, (1 - u) * (1 + v) / 4};
}

/// Adds the hats of one block of surface facets. The lattice divides the reference facet into p² equal cells,
/// each with its own quadrature points.
void add_facets(const Block& block, Fine& fine) {
  const auto reference = mesh::reference_element(block.gmsh_type);
  const auto lattice = mesh::lattice_of(reference);
  const int p = reference.order, n = reference.nodes;
  // The integrand is hat × shape function × surface measure, of degree 1 + p + 2(p − 1).
  const auto rule = mesh::quadrature_of(reference.family, 3 * p + 1);
  struct CellTable {
    std::vector<std::array<double, 4>> hat;
    mesh::Basis basis;
  };
  std::vector<CellTable> tables;
  for (const auto& cell : lattice.cells) {
    CellTable table;
    std::vector<double> local;
    for (std::size_t q = 0; q < rule.size(); ++q) {
      table.hat.push_back(hats(lattice.corners, rule.local[3 * q], rule.local[3 * q + 1]));
      std::array<double, 2> at{};
      for (int k = 0; k < lattice.corners; ++k)
        for (int d = 0; d < 2; ++d)
          at[d] += table.hat.back()[k] * reference.node[2 * static_cast<std::size_t>(cell[k]) + d];
      local.insert(local.end(), {at[0], at[1], 0});
    }
    table.basis = mesh::basis_at(reference, local);
    tables.push_back(std::move(table));
  }
  const double share = 1.0 / (static_cast<double>(p) * p);
  const std::vector<int> triangles = lattice.triangles();
  for (std::size_t e = 0; e < block.size(); ++e) {
    const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(n)];
    for (std::size_t t = 0; t < lattice.cells.size(); ++t)
      for (std::size_t q = 0; q < rule.size(); ++q) {
        Eigen::Vector3d along_u = Eigen::Vector3d::Zero(), along_v = along_u;
        const double* gradient = &tables[t].basis.gradient[q * static_cast<std::size_t>(n) * 3];
        for (int a = 0; a < n; ++a) {
          const Eigen::Vector3d& x = fine.position[static_cast<std::size_t>(nodes[a])];
          along_u += gradient[3 * a] * x;
          along_v += gradient[3 * a + 1] * x;
        }
        const Eigen::Vector3d normal = along_u.cross(along_v) * rule.weight[q] * share;
        const double measure = normal.norm();
        for (int k = 0; k < lattice.corners; ++k) {
          const auto vertex = static_cast<std::size_t>(nodes[lattice.cells[t][static_cast<std::size_t>(k)]]);
          const double w = tables[t].hat[q][static_cast<std::size_t>(k)];
          fine.area[vertex] += w * measure;
          fine.normal[vertex] += w * normal;
          fine.group[vertex] = block.label[e];
          for (int a = 0; a < n; ++a)
            fine.load[vertex][nodes[a]] +=
                w * measure *
                tables[t].basis.value[q * static_cast<std::size_t>(n) + static_cast<std::size_t>(a)];
        }
      }
    for (int k : triangles) fine.simplex.push_back(nodes[k]);
  }
}

Fine fine_hats(const FacetMesh& facets) {
  Fine fine;
  const std::size_t n = facets.node.size();
  for (std::size_t i = 0; i < n; ++i)
    fine.position.emplace_back(facets.position[3 * i], facets.position[3 * i + 1],
                               facets.position[3 * i + 2]);
  fine.normal.assign(n, Eigen::Vector3d::Zero());
  fine.area.assign(n, 0);
  fine.group.assign(n, 0);
  fine.load.resize(n);
  for (const Block& block : facets.blocks) {
    if (block.nodes_per_element > 1) {
      add_facets(block, fine);
      continue;
    }
    fine.corners = 1;
    for (std::size_t e = 0; e < block.size(); ++e) {
      const auto i = static_cast<std::size_t>(block.node[e]);
      fine.normal[i] = Eigen::Map<const Eigen::Vector3d>(&facets.end_normal[3 * i]);
      fine.area[i] = fine.normal[i].norm();
      fine.load[i][block.node[e]] = fine.area[i];
      fine.group[i] = block.label[e];
      fine.simplex.push_back(block.node[e]);
    }
  }
  return fine;
}

/// Merges fine vertices into coarser candidates. Each vertex has a list of (candidate, share); its shares sum
/// to 1.
struct Merge {
  std::vector<Eigen::Vector3d> centre;
  std::vector<std::vector<std::pair<int, double>>> share;  ///< per fine vertex
};

Merge one_each(const Fine& fine) {
  Merge merge{fine.position, {}};
  for (std::size_t i = 0; i < fine.position.size(); ++i) merge.share.push_back({{static_cast<int>(i), 1.0}});
  return merge;
}

/// Merges all vertices that lie on a line in direction `along`, with normals on the same side, into one
/// candidate.
Merge merge_lines(const Fine& fine, const Eigen::Vector3d& along) {
  double size = 0;
  for (const auto& x : fine.position) size = std::max(size, (x - fine.position[0]).norm());
  const double tolerance = 1e-6 * size;
  Merge merge;
  std::vector<Eigen::Vector3d> foot, facing;
  Grid feet(size > 0 ? 100 * tolerance : 1);
  std::vector<std::pair<double, double>> range;
  std::vector<int> line(fine.position.size());
  for (std::size_t i = 0; i < fine.position.size(); ++i) {
    const double height = fine.position[i].dot(along);
    const Eigen::Vector3d x = fine.position[i] - height * along;
    std::size_t k = foot.size();
    feet.near(x, tolerance, [&](std::size_t j) {
      if (j < k && (foot[j] - x).norm() <= tolerance && facing[j].dot(fine.normal[i]) > 0) k = j;
    });
    if (k == foot.size()) {
      feet.add(k, x);
      foot.push_back(x);
      facing.push_back(fine.normal[i]);
      range.emplace_back(height, height);
    }
    range[k] = {std::min(range[k].first, height), std::max(range[k].second, height)};
    line[i] = static_cast<int>(k);
  }
  for (std::size_t k = 0; k < foot.size(); ++k)
    merge.centre.push_back(foot[k] + (range[k].first + range[k].second) / 2 * along);
  for (int k : line) merge.share.push_back({{k, 1.0}});
  return merge;
}

/// Chooses points of a surface by an advancing front, such that no two are closer than `spacing`. The next
/// point is the one nearest to the points already chosen. Among several nearest points, it is the one at the
/// lowest corner, so that a row of points is traversed from end to end.
class Front {
 public:
  Front(const std::vector<Eigen::Vector3d>& point, const std::vector<Eigen::Vector3d>& normal, double spacing)
      : point_(point),
        normal_(normal),
        spacing_(spacing),
        near_(3 * spacing),
        grid_(near_),
        nearest_(point.size(), infinity),
        by_corner_(point.size()),
        rank_(point.size()) {
    for (std::size_t i = 0; i < point.size(); ++i) grid_.add(i, point[i]);
    std::vector<std::array<std::int64_t, 3>> place;
    for (const Eigen::Vector3d& x : point) place.push_back({level(x[0]), level(x[1]), level(x[2])});
    std::iota(by_corner_.begin(), by_corner_.end(), std::size_t{0});
    std::stable_sort(by_corner_.begin(), by_corner_.end(),
                     [&](std::size_t a, std::size_t b) { return place[a] < place[b]; });
    for (std::size_t k = 0; k < by_corner_.size(); ++k) rank_[by_corner_[k]] = k;
  }

  /// Returns the chosen points in the order in which they were chosen.
  std::vector<std::size_t> choose() {
    std::vector<std::size_t> chosen;
    std::size_t next = by_corner_[0];
    for (std::size_t far = 0; next < point_.size();) {
      chosen.push_back(next);
      grid_.near(point_[next], near_, [&](std::size_t i) { meet(i, next); });
      next = next_near();
      if (next < point_.size()) continue;
      // The front has ended; the remaining points may form a separate region. Only now are their distances
      // needed.
      std::vector<std::size_t> rest;
      for (std::size_t i = 0; i < point_.size(); ++i)
        if (is_free(i)) rest.push_back(i);
      for (; far < chosen.size(); ++far)
        for (const std::size_t i : rest) meet(i, chosen[far]);
      next = next_of_all();
    }
    return chosen;
  }

  /// Returns the distance of two points; infinite between opposite sides of a thin body, however close they
  /// are.
  double distance(std::size_t i, std::size_t j) const {
    return normal_[i].dot(normal_[j]) <= 0 ? infinity : (point_[i] - point_[j]).norm();
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  using Entry = std::pair<std::int64_t, std::size_t>;  ///< level of the distance, rank

  /// Lengths of the same level are equal except for round-off.
  std::int64_t level(double length) const { return std::llround(length / (1e-9 * spacing_)); }
  bool is_free(std::size_t i) const { return nearest_[i] >= spacing_ * (1 - 1e-6); }

  void meet(std::size_t i, std::size_t chosen) {
    const double d = distance(i, chosen);
    if (!(d < nearest_[i])) return;
    nearest_[i] = d;
    if (is_free(i) && d < near_) front_.emplace(level(d), rank_[i]);
  }

  /// Returns the next free point near the chosen ones, or the number of points if there is none.
  std::size_t next_near() {
    while (!front_.empty()) {
      const auto [at, rank] = front_.top();
      front_.pop();
      const std::size_t i = by_corner_[rank];
      if (is_free(i) && level(nearest_[i]) == at) return i;
    }
    return point_.size();
  }

  /// Returns the next of all free points, or the first if all of them face away from the chosen ones.
  std::size_t next_of_all() const {
    std::size_t best = point_.size();
    Entry lowest;
    for (std::size_t i = 0; i < point_.size(); ++i) {
      if (!is_free(i)) continue;
      const Entry entry = nearest_[i] < infinity ? Entry(level(nearest_[i]), rank_[i])
                                                 : Entry(std::numeric_limits<std::int64_t>::max(), i);
      if (best < point_.size() && lowest < entry) continue;
      best = i;
      lowest = entry;
    }
    return best;
  }

  const std::vector<Eigen::Vector3d>&point_, &normal_;
  double spacing_, near_;
  Grid grid_;
  std::vector<double> nearest_;  ///< distance of each point to the nearest chosen one, as far as known
  /// The points from the lowest corner on, and the rank of each point in this order.
  std::vector<std::size_t> by_corner_, rank_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front_;  ///< may contain outdated distances
};

/// Coarsens to centres that are at least `spacing` apart. Every point is shared among the centres near it by
/// linear hats of that radius.
Merge coarsen(const Merge& points, const std::vector<Eigen::Vector3d>& normal, double spacing) {
  Front front(points.centre, normal, spacing);
  const std::vector<std::size_t> chosen = front.choose();
  Merge merge;
  Grid centres(spacing);
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    merge.centre.push_back(points.centre[chosen[c]]);
    centres.add(c, merge.centre.back());
  }
  std::vector<std::vector<std::pair<int, double>>> share(points.centre.size());
  for (std::size_t i = 0; i < share.size(); ++i) {
    centres.near(points.centre[i], spacing, [&](std::size_t c) {
      const double d = front.distance(i, chosen[c]);
      if (d < spacing) share[i].emplace_back(static_cast<int>(c), 1 - d / spacing);
    });
    std::sort(share[i].begin(), share[i].end());
    double total = 0;
    for (const auto& [c, s] : share[i]) total += s;
    for (auto& [c, s] : share[i]) s /= total;
  }
  for (const auto& old : points.share) merge.share.push_back(share[static_cast<std::size_t>(old[0].first)]);
  return merge;
}

/// Builds the mesh of the candidates. In the fine simplices, each vertex is replaced by the candidate that
/// has its largest share. Only elements of the highest remaining dimension are kept.
void quotient(const Fine& fine, const Merge& merge, kernels::Surface& surface) {
  const auto holder = [&](std::int64_t vertex) {
    const auto& share = merge.share[static_cast<std::size_t>(vertex)];
    return std::max_element(share.begin(), share.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  const int corners = fine.corners;
  std::array<std::set<std::vector<std::int64_t>>, 4> seen;
  std::array<std::vector<std::int64_t>, 4> elements;
  for (std::size_t s = 0; s + static_cast<std::size_t>(corners) <= fine.simplex.size();
       s += static_cast<std::size_t>(corners)) {
    std::vector<std::int64_t> distinct;
    for (int k = 0; k < corners; ++k) {
      const std::int64_t c = holder(fine.simplex[s + static_cast<std::size_t>(k)]);
      if (std::find(distinct.begin(), distinct.end(), c) == distinct.end()) distinct.push_back(c);
    }
    std::vector<std::int64_t> key = distinct;
    std::sort(key.begin(), key.end());
    if (seen[distinct.size()].insert(key).second)
      elements[distinct.size()].insert(elements[distinct.size()].end(), distinct.begin(), distinct.end());
  }
  int k = 3;
  while (k > 1 && elements[static_cast<std::size_t>(k)].empty()) --k;
  surface.element_corners = k;
  surface.element = elements[static_cast<std::size_t>(k)];
}

}  // namespace

Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options) {
  const Fine fine = fine_hats(mesh.contact);
  if (fine.position.empty())
    throw InputError(
        "the contact groups hold no facets: give them a physical surface (a physical point for rods)");
  Merge merge = options.along ? merge_lines(fine, Eigen::Map<const Eigen::Vector3d>(options.along->data()))
                              : one_each(fine);
  if (options.spacing) {
    std::vector<Eigen::Vector3d> normal(merge.centre.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < fine.position.size(); ++i)
      normal[static_cast<std::size_t>(merge.share[i][0].first)] += fine.normal[i];
    merge = coarsen(merge, normal, *options.spacing);
  }

  Patches patches;
  kernels::Surface& surface = patches.geometry;
  const std::size_t m = merge.centre.size();
  std::vector<Eigen::Vector3d> normal(m, Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> centroid(m, Eigen::Vector3d::Zero());
  std::vector<std::map<std::int64_t, double>> load(m);
  surface.area.assign(m, 0);
  surface.group.assign(m, "");
  for (std::size_t i = 0; i < fine.position.size(); ++i)
    for (const auto& [c, s] : merge.share[i]) {
      const auto k = static_cast<std::size_t>(c);
      surface.area[k] += s * fine.area[i];
      normal[k] += s * fine.normal[i];
      surface.group[k] = groups[static_cast<std::size_t>(fine.group[i])];
      for (const auto& [node, w] : fine.load[i]) load[k][node] += s * w;
    }
  for (std::size_t k = 0; k < m; ++k) {
    normal[k].normalize();
    for (const auto& [node, w] : load[k]) centroid[k] += w * fine.position[static_cast<std::size_t>(node)];
    for (int d = 0; d < 3; ++d) {
      surface.node.push_back(merge.centre[k][d]);
      surface.centroid.push_back(centroid[k][d] / surface.area[k]);
      surface.normal.push_back(normal[k][d]);
    }
    for (const auto& [node, w] : load[k])
      patches.weights.push_back(
          {mesh.contact.node[static_cast<std::size_t>(node)], static_cast<int>(k), w / surface.area[k]});
  }
  quotient(fine, merge, surface);
  surface.components = options.direction ? 1 : 3;
  surface.direction = options.direction;
  return patches;
}

modes::Loads patch_loads(const mesh::Mesh& mesh, const Patches& patches) {
  return spread(mesh, patches.weights, patches.geometry.size(), patches.geometry.direction, HeldRows::zero);
}

modes::Loads along_normals(const modes::Loads& loads, const kernels::Surface& surface) {
  modes::Loads normal(loads.cols(), loads.cols() / 3);
  normal.reserve(Eigen::VectorXi::Constant(normal.cols(), 3));
  for (Eigen::Index row = 0; row < normal.rows(); ++row)
    normal.insert(row, row / 3) = surface.normal[static_cast<std::size_t>(row)];
  return loads * normal;
}

void restrict_to(Patches& patches, const std::vector<std::int64_t>& points) {
  kernels::WholeSurface whole = kernels::whole_surface(patches.geometry);
  std::vector<int> number(whole.area.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
    number[static_cast<std::size_t>(points[i])] = static_cast<int>(i);
  std::erase_if(patches.weights,
                [&](const Weight& weight) { return number[static_cast<std::size_t>(weight.candidate)] < 0; });
  for (Weight& weight : patches.weights)
    weight.candidate = number[static_cast<std::size_t>(weight.candidate)];
  kernels::restrict_candidates(patches.geometry, points);
  whole.held = points;
  patches.geometry.whole = std::move(whole);
}

}  // namespace ricochet::surface
