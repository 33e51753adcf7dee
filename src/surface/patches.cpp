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
#include "src/surface/fine_surface.hpp"
#include "src/surface/grid.hpp"

namespace ricochet::surface {

namespace {

using Eigen::Vector3d;
using Fine = FineSurface;

/// Merges fine vertices into coarser candidates. Each vertex has a list of (candidate, share); its shares sum
/// to 1.
struct Merge {
  std::vector<Eigen::Vector3d> centre;
  std::vector<std::vector<std::pair<int, double>>> share;  ///< per fine vertex
  std::vector<std::vector<std::int64_t>> home;  ///< per candidate: the vertices at its centre or on its line
};

Merge one_each(const Fine& fine) {
  Merge merge{fine.position, {}, {}};
  for (std::size_t i = 0; i < fine.position.size(); ++i) {
    merge.share.push_back({{static_cast<int>(i), 1.0}});
    merge.home.push_back({static_cast<std::int64_t>(i)});
  }
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
  merge.home.resize(foot.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    merge.share.push_back({{line[i], 1.0}});
    merge.home[static_cast<std::size_t>(line[i])].push_back(static_cast<std::int64_t>(i));
  }
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
    merge.home.push_back(points.home[chosen[c]]);
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

/// A smooth sheet of the surface around the centre of a candidate.
struct Sheet {
  std::size_t part = 0;  ///< as in FineSurface::Part::sheet
  Vector3d normal;       ///< mean over the sheet around this vertex, unit
};

/// The sheets around all home vertices of a candidate.
std::vector<Sheet> sheets_of(const Fine& fine, const std::vector<std::int64_t>& home) {
  std::vector<Sheet> out;
  for (const std::int64_t vertex : home) {
    const std::size_t first = out.size();
    for (const std::size_t p : fine.parts_at[static_cast<std::size_t>(vertex)]) {
      const Fine::Part& part = fine.part[p];
      auto sheet = std::find_if(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                [&](const Sheet& s) { return s.part == part.sheet; });
      if (sheet == out.end()) sheet = out.insert(out.end(), {part.sheet, Vector3d::Zero()});
      sheet->normal += part.area * part.normal;
    }
  }
  // The vertices of a line see the same sheets.
  std::vector<Sheet> distinct;
  for (const Sheet& sheet : out) {
    const auto like = std::ranges::find_if(distinct, [&](const Sheet& other) {
      return sheet.normal.normalized().dot(other.normal.normalized()) > std::cos(crease_angle);
    });
    if (home.size() > 1 && like != distinct.end())
      like->normal += sheet.normal;
    else
      distinct.push_back(sheet);
  }
  for (Sheet& sheet : distinct) sheet.normal.normalize();
  return distinct;
}

/// The sheet whose normal is closest to a direction.
const Sheet& sheet_facing(const std::vector<Sheet>& sheets, const Vector3d& direction) {
  return *std::ranges::max_element(sheets, {}, [&](const Sheet& s) { return s.normal.dot(direction); });
}

/// Builds the mesh of the candidates. In the fine simplices, each vertex is replaced by the candidate that
/// has its largest share. Only elements of the highest remaining dimension are kept. The normal at a corner
/// is that of the candidate's sheet that faces most like the sheet of the fine simplex.
void quotient(const Fine& fine, const Merge& merge, kernels::Surface& surface) {
  const auto holder = [&](std::int64_t vertex) {
    const auto& share = merge.share[static_cast<std::size_t>(vertex)];
    return std::max_element(share.begin(), share.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  const int corners = fine.corners;
  std::vector<std::vector<Sheet>> sheets, around;  // per candidate, per fine vertex
  if (corners == 3) {
    for (const auto& home : merge.home) sheets.push_back(sheets_of(fine, home));
    for (std::size_t i = 0; i < fine.position.size(); ++i)
      around.push_back(sheets_of(fine, {static_cast<std::int64_t>(i)}));
  }
  std::array<std::set<std::vector<std::int64_t>>, 4> seen;
  std::array<std::vector<std::int64_t>, 4> elements;
  std::array<std::vector<double>, 4> normals;
  for (std::size_t s = 0; s + static_cast<std::size_t>(corners) <= fine.simplex.size();
       s += static_cast<std::size_t>(corners)) {
    std::vector<std::int64_t> distinct;
    std::vector<double> normal;
    for (std::size_t k = s; k < s + static_cast<std::size_t>(corners); ++k) {
      const std::int64_t c = holder(fine.simplex[k]);
      if (std::find(distinct.begin(), distinct.end(), c) != distinct.end()) continue;
      distinct.push_back(c);
      if (corners < 3) continue;
      const Fine::Part& part = fine.part[fine.simplex_part[k]];
      const Vector3d& own = sheet_facing(around[static_cast<std::size_t>(part.vertex)], part.normal).normal;
      const Vector3d& n = sheet_facing(sheets[static_cast<std::size_t>(c)], own).normal;
      normal.insert(normal.end(), n.begin(), n.end());
    }
    std::vector<std::int64_t> key = distinct;
    std::sort(key.begin(), key.end());
    if (!seen[distinct.size()].insert(key).second) continue;
    auto& to = elements[distinct.size()];
    to.insert(to.end(), distinct.begin(), distinct.end());
    normals[distinct.size()].insert(normals[distinct.size()].end(), normal.begin(), normal.end());
  }
  int k = 3;
  while (k > 1 && elements[static_cast<std::size_t>(k)].empty()) --k;
  surface.element_corners = k;
  surface.element = elements[static_cast<std::size_t>(k)];
  if (k > 1) surface.element_normal = normals[static_cast<std::size_t>(k)];
}

/// The point of a patch from which gaps are measured, and its height over the mean of the patch.
struct Crest {
  Vector3d point;
  double bulge = 0;
};

/// Finds the crests of patches.
class Crests {
 public:
  Crests(const Fine& fine, const Merge& merge) : fine_(fine), merge_(merge), facets_(fine) {}

  /// @param share  of the candidate in each vertex
  Crest of(std::size_t candidate, const std::map<std::int64_t, double>& share) const {
    const std::vector<std::int64_t>& home = merge_.home[candidate];
    if (fine_.corners == 1) return {merge_.centre[candidate], 0};
    if (has_line(home)) {
      const Vector3d at = home.size() == 1 ? on_line(home.front(), share) : merge_.centre[candidate];
      std::vector<Sheet> sheets = sheets_of(fine_, home);
      if (home.size() > 1) {
        // The sheets at the ends of a line do not bulge beside it.
        const auto end = [&](std::int64_t vertex) {
          return fine_.position[static_cast<std::size_t>(vertex)];
        };
        const Vector3d along = (end(home.back()) - end(home.front())).normalized();
        std::erase_if(sheets,
                      [&](const Sheet& sheet) { return std::abs(sheet.normal.dot(along)) > same_face; });
      }
      return {at, bulge(at, sheets, share)};
    }
    Vector3d normal = Vector3d::Zero();
    for (const std::int64_t vertex : home) normal += fine_.normal[static_cast<std::size_t>(vertex)];
    normal.normalize();
    const auto [mean, within] = mean_facing(normal, share);
    std::vector<std::size_t> near;
    for (const auto& [vertex, s] : share)
      for (const std::size_t simplex : fine_.simplices_at[static_cast<std::size_t>(vertex)])
        near.push_back(simplex);
    mesh::sort_once(near);
    const auto found = facets_.along(mean, normal, near);
    const SurfacePoint at = found.value_or(SurfacePoint{merge_.centre[candidate], normal});
    return {at.point, within * at.normal.dot(at.point - mean)};
  }

 private:
  /// Parts of a patch whose normals are farther apart than 60 degrees from that of its centre lie on another
  /// face.
  static constexpr double same_face = 0.5;

  /// Whether the centre of a candidate lies on a crease, at a corner, or at the end of the surface. A merged
  /// line does if it runs along one; lines that only end there do not.
  bool has_line(const std::vector<std::int64_t>& home) const {
    if (home.size() == 1)
      return !fine_.lines_at[static_cast<std::size_t>(home[0])].empty() || fine_.sheets(home[0]) > 1;
    return std::ranges::any_of(home, [&](std::int64_t vertex) {
      return std::ranges::any_of(
          fine_.lines_at[static_cast<std::size_t>(vertex)],
          [&](const Fine::Line& line) { return std::ranges::count(home, line.to) > 0; });
    });
  }

  /// Mean of the part of a patch that faces like `normal`, and the share of its area.
  std::pair<Vector3d, double> mean_facing(const Vector3d& normal,
                                          const std::map<std::int64_t, double>& share) const {
    Vector3d moment = Vector3d::Zero();
    double area = 0, all = 0;
    for (const auto& [vertex, s] : share)
      for (const std::size_t p : fine_.parts_at[static_cast<std::size_t>(vertex)]) {
        const Fine::Part& part = fine_.part[p];
        all += s * part.area;
        if (part.normal.dot(normal) < same_face) continue;
        moment += s * part.moment;
        area += s * part.area;
      }
    return {moment / area, area / all};
  }

  /// (1/A) ∫ w n·(x̂ − x) ds with the normal n of each sheet around the centre
  double bulge(const Vector3d& at, const std::vector<Sheet>& sheets,
               const std::map<std::int64_t, double>& share) const {
    double sum = 0, area = 0;
    for (const auto& [vertex, s] : share)
      for (const std::size_t p : fine_.parts_at[static_cast<std::size_t>(vertex)]) {
        const Fine::Part& part = fine_.part[p];
        area += s * part.area;
        const Vector3d& n = sheet_facing(sheets, part.normal).normal;
        if (part.normal.dot(n) >= same_face) sum += s * n.dot(part.area * at - part.moment);
      }
    return sum / area;
  }

  /// Centroid of the trace of the hat on the line through its centre; the centre itself at corners.
  Vector3d on_line(std::int64_t centre, const std::map<std::int64_t, double>& share) const {
    const Vector3d& x = fine_.position[static_cast<std::size_t>(centre)];
    if (!fine_.on_line(centre)) return x;
    const auto& ways = fine_.lines_at[static_cast<std::size_t>(centre)];
    const auto share_of = [&](std::int64_t vertex) {
      const auto found = share.find(vertex);
      return found == share.end() ? 0 : found->second;
    };
    struct Piece {
      Fine::Line line;
      double from, length;  // along the way
    };
    std::array<std::vector<Piece>, 2> pieces;
    double weight = 0, moment = 0;  // ∫ w dl, ∫ w l dl with l < 0 on the second way
    for (const std::size_t way : {0, 1}) {
      const double sense = way == 0 ? 1 : -1;
      double l = 0;
      std::int64_t from = centre;
      for (Fine::Line line = ways[way];;) {
        const std::int64_t to = line.to;
        const double length = (fine_.position[static_cast<std::size_t>(to)] -
                               fine_.position[static_cast<std::size_t>(from)])
                                  .norm(),
                     a = share_of(from), b = share_of(to);
        weight += length * (a + b) / 2;
        moment += sense * length * (l * (a + b) / 2 + length * (a / 6 + b / 3));
        pieces[way].push_back({line, l, length});
        l += length;
        if (b == 0 || to == centre || !fine_.on_line(to)) break;
        const auto& next = fine_.lines_at[static_cast<std::size_t>(to)];
        line = next[next[0].to == from ? 1 : 0];
        from = to;
      }
    }
    const double at = moment / weight, distance = std::abs(at);
    const std::vector<Piece>& way = pieces[at > 0 ? 0 : 1];
    const Piece& piece = *std::ranges::find_if(
        way, [&](const Piece& one) { return distance <= one.from + one.length || &one == &way.back(); });
    return facets_.on_line(piece.line, (distance - piece.from) / piece.length);
  }

  const Fine& fine_;
  const Merge& merge_;
  CurvedFacets facets_;
};

}  // namespace

Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options) {
  const Fine fine = fine_surface(mesh.contact);
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
  std::vector<Vector3d> normal(m, Vector3d::Zero());
  std::vector<std::map<std::int64_t, double>> load(m), shares(m);
  surface.area.assign(m, 0);
  surface.group.assign(m, "");
  for (std::size_t i = 0; i < fine.position.size(); ++i)
    for (const auto& [c, s] : merge.share[i]) {
      const auto k = static_cast<std::size_t>(c);
      surface.area[k] += s * fine.area[i];
      normal[k] += s * fine.normal[i];
      surface.group[k] = groups[static_cast<std::size_t>(fine.group[i])];
      for (const auto& [node, w] : fine.load[i]) load[k][node] += s * w;
      if (s > 0) shares[k][static_cast<std::int64_t>(i)] += s;
    }
  const Crests crests(fine, merge);
  for (std::size_t k = 0; k < m; ++k) {
    normal[k].normalize();
    Vector3d mean = Vector3d::Zero();
    for (const auto& [node, w] : load[k]) mean += w * fine.position[static_cast<std::size_t>(node)];
    mean /= surface.area[k];
    const Crest crest = crests.of(k, shares[k]);
    surface.bulge.push_back(crest.bulge);
    for (int d = 0; d < 3; ++d) {
      surface.node.push_back(merge.centre[k][d]);
      surface.centroid.push_back(crest.point[d]);
      surface.normal.push_back(normal[k][d]);
      patches.arm.push_back(crest.point[d] - mean[d]);
    }
    for (const auto& [node, w] : load[k])
      patches.weights.push_back(
          {mesh.contact.node[static_cast<std::size_t>(node)], static_cast<int>(k), w / surface.area[k]});
  }
  patches.share = std::move(shares);
  quotient(fine, merge, surface);
  surface.components = options.direction ? 1 : 3;
  surface.direction = options.direction;
  return patches;
}

reduction::Loads patch_loads(const mesh::Mesh& mesh, const Patches& patches) {
  return spread(mesh, patches.weights, patches.geometry.size(), patches.geometry.direction, FixedRows::zero);
}

reduction::Loads along_normals(const reduction::Loads& loads, const kernels::Surface& surface) {
  reduction::Loads normal(loads.cols(), loads.cols() / 3);
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
  std::vector<double> arm;
  for (const std::int64_t i : points)
    for (std::size_t d = 0; d < 3; ++d) arm.push_back(patches.arm[3 * static_cast<std::size_t>(i) + d]);
  patches.arm = std::move(arm);
  std::vector<std::map<std::int64_t, double>> share;
  for (const std::int64_t i : points) share.push_back(std::move(patches.share[static_cast<std::size_t>(i)]));
  patches.share = std::move(share);
  kernels::restrict_candidates(patches.geometry, points);
  whole.held = points;
  patches.geometry.whole = std::move(whole);
}

}  // namespace ricochet::surface
