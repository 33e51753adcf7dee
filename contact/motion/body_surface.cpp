// SPDX-License-Identifier: BSD-2-Clause
#include "contact/motion/body_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Nearer to a crease than this share of an element, the direction to it is not known.
constexpr double indistinct = 1e-3;
/// A point beside a face and beyond its crease may be below its plane by this sine: elements that are curved
/// meet on an arc, while the foot is that of their chords.
constexpr double beside_face = 0.3;
/// Longest way of a point along the surface between two looks, in elements.
constexpr int most_moves = 16;
/// Sine below which segments are parallel.
constexpr double parallel = 0.02;

/// The element whose chords are nearest to x. Eigen::BVMinimize would allocate.
struct NearestElement {
  void look_at(int element) noexcept {
    const auto& corner = surface.element[static_cast<std::size_t>(element)].corner;
    const auto node = [&](std::size_t j) { return surface.node[static_cast<std::size_t>(corner[j])]; };
    const double square = square_distance(x, {node(0), node(1), node(2)});
    if (square >= least) return;
    least = square;
    nearest = element;
  }
  void search(int index) noexcept {
    const int *volume = nullptr, *volumes = nullptr, *object = nullptr, *objects = nullptr;
    tree.getChildren(index, volume, volumes, object, objects);
    for (; object != objects; ++object) look_at(*object);
    std::array<std::pair<double, int>, 2> boxes;  // nearest first
    std::size_t count = 0;
    for (; volume != volumes; ++volume)
      boxes[count++] = {tree.getVolume(*volume).squaredExteriorDistance(x), *volume};
    if (count == 2 && boxes[1] < boxes[0]) std::swap(boxes[0], boxes[1]);
    for (std::size_t k = 0; k < count; ++k)
      if (boxes[k].first < least) search(boxes[k].second);
  }

  const WorldSurface& surface;
  const Eigen::KdBVH<double, 3, int>& tree;
  Vector3d x;
  double least;  ///< square of the distance
  int nearest = -1;
};

}  // namespace

BodySurface::BodySurface(const kernels::Kernel& kernel)
    : BodySurface(surface_of({.name = kernel.body, .kernel = &kernel})) {}

BodySurface::BodySurface(WorldSurface of_body) : projection_(std::move(of_body)) {
  const WorldSurface& on = surface();
  for (const Vector3d& x : on.node) box_.extend(x);
  std::map<std::array<int, 2>, std::vector<std::array<int, 2>>> edges;
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  neighbour_.assign(on.element.size(), {-1, -1, -1});
  crease_.assign(on.element.size(), {true, true, true});
  at_crease_.assign(on.node.size(), false);
  size_at_.assign(on.node.size(), 0);
  std::vector<std::vector<int>> beside(on.node.size()), elements(on.node.size());
  for (int e = 0; e < static_cast<int>(on.element.size()) && on.corners == 3; ++e) {
    largest_element_ = std::max(largest_element_, on.element[at(e)].size);
    for (const int node : on.element[at(e)].corner)
      size_at_[at(node)] = std::max(size_at_[at(node)], on.element[at(e)].size);
    for (int j = 0; j < 3; ++j) {
      const int p = on.element[at(e)].corner[at(j)], q = on.element[at(e)].corner[at((j + 1) % 3)];
      edges[{std::min(p, q), std::max(p, q)}].push_back({e, j});
      beside[at(p)].push_back(q);
      beside[at(q)].push_back(p);
      elements[at(p)].push_back(e);
      // Σ w_j w_{j+1} ≤ 1/3
      camber_ =
          std::max(camber_, 4.0 / 3 * on.element[at(e)].bend[at(j)].norm() + on.element[at(e)].bubble.norm());
    }
  }
  std::ranges::replace(size_at_, 0.0, largest_element_);  // nodes without elements
  std::set<std::array<int, 2>> creases;
  for (const WorldSurface::Crease& crease : on.crease) creases.insert(crease.node);
  for (const auto& [nodes, sides] : edges) {
    const bool crease = sides.size() != 2 || creases.contains(nodes);
    for (const int node : nodes) at_crease_[at(node)] |= crease;
    if (sides.size() != 2) continue;
    for (int k = 0; k < 2; ++k) {
      const auto& [e, j] = sides[at(k)];
      neighbour_[at(e)][at(j)] = sides[at(1 - k)][0];
      crease_[at(e)][at(j)] = crease;
    }
  }
  for (std::vector<int>& nodes : beside) {
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
  const auto list = [](const std::vector<std::vector<int>>& of_nodes, std::vector<int>& first,
                       std::vector<int>& all) {
    for (const std::vector<int>& of_node : of_nodes) {
      first.push_back(static_cast<int>(all.size()));
      all.insert(all.end(), of_node.begin(), of_node.end());
    }
    first.push_back(static_cast<int>(all.size()));
  };
  list(beside, first_, around_);
  for (int node = 0; node < static_cast<int>(on.node.size()); ++node)
    for (const int k : around(node)) edges_.push_back((on.node[at(k)] - on.node[at(node)]).normalized());
  list(elements, first_element_, elements_at_);
}

/// Distance from a crease below which the direction to it is not known [m].
double BodySurface::near_crease(const Foot& foot) const noexcept {
  return indistinct * surface().element[static_cast<std::size_t>(foot.element)].size;
}

bool BodySurface::is_at_crease(const Foot& foot) const noexcept {
  const auto e = static_cast<std::size_t>(foot.element);
  for (std::size_t j = 0; j < 3; ++j) {
    if (foot.weight[(j + 2) % 3] == 0 && crease_[e][j]) return true;
    if (foot.weight[j] == 1 && at_crease_[static_cast<std::size_t>(surface().element[e].corner[j])])
      return true;
  }
  return false;
}

Vector3d BodySurface::on_chords(const Foot& foot) const noexcept {
  const WorldSurface::Element& element = surface().element[static_cast<std::size_t>(foot.element)];
  Vector3d out = Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j)
    out += foot.weight[j] * surface().node[static_cast<std::size_t>(element.corner[j])];
  return out;
}

/// Interpolated between the corners, so that it is continuous.
Vector3d BodySurface::normal_at(int element, const std::array<double, 3>& weight) const noexcept {
  Vector3d out = Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j)
    out += weight[j] * surface().element[static_cast<std::size_t>(element)].normal[j];
  return out.normalized();
}

/// Over an edge that is no crease, the normal is that of the curved surface; beyond a crease, it leads to the
/// point.
Foot BodySurface::foot_on(int number, const Vector3d& x) const noexcept {
  const WorldSurface& on = surface();
  const WorldSurface::Element& element = on.element[static_cast<std::size_t>(number)];
  Foot out{.element = number, .weight = closest_weights(on, element, x)};
  out.point = on.at(element, out.weight);
  out.normal = normal_at(number, out.weight);
  const bool at_crease = is_at_crease(out);
  const Vector3d way = x - out.point;
  if (const double length = way.norm(); at_crease && length > near_crease(out)) {
    // Inside, the point is nearer to a face.
    if (const Vector3d outward = way / length; outward.dot(out.normal) > -beside_face) out.normal = outward;
  } else if (const auto exact = on.on_form(element, x)) {
    out.point = exact->point;
    out.normal = exact->normal;
    out.distance = exact->distance;
    return out;
  }
  out.distance = out.normal.dot(way);
  return out;
}

Foot BodySurface::closest(const Vector3d& x, double within, int guess) const noexcept {
  NearestElement nearest{
      .surface = surface(), .tree = projection_.elements(), .x = x, .least = within * within};
  if (guess >= 0) nearest.look_at(guess);
  nearest.search(projection_.elements().getRootIndex());
  return nearest.nearest < 0 ? Foot{} : foot_on(nearest.nearest, x);
}

/// Goes where the chords are nearer, as `closest` does: the curved surface of the next element may be farther
/// just beyond an edge, where the point would stop.
Foot BodySurface::follow(const Foot& earlier, const Vector3d& x) const noexcept {
  const auto square_way = [&](const Foot& foot) { return (x - on_chords(foot)).squaredNorm(); };
  Foot best = foot_on(earlier.element, x);
  double least = square_way(best);
  for (int move = 0; move < most_moves; ++move) {
    Foot next = best;
    visit_beside(best, [&](int beside) {
      const Foot there = foot_on(beside, x);
      const double square = square_way(there);
      if (square >= least * (1 - 1e-12)) return;
      next = there;
      least = square;
    });
    if (next.element == best.element) break;
    best = next;
  }
  return best;
}

/// Whether no node around one is higher towards n.
bool BodySurface::is_peak(int node, const Vector3d& n) const noexcept {
  const auto height = [&](int k) { return n.dot(surface().node[static_cast<std::size_t>(k)]); };
  const double own = height(node);
  return std::ranges::none_of(around(node), [&](int k) { return height(k) > own; });
}

Foot BodySurface::summit(int element, const Height& height) const noexcept {
  const auto on_element = [&](int number) {
    const WorldSurface::Element& on = surface().element[static_cast<std::size_t>(number)];
    Foot out{.element = number, .weight = highest_weights(surface(), on, height)};
    out.point = surface().at(on, out.weight);
    return out;
  };
  Foot best = on_element(element);
  double most = height.of(best.point);
  for (int move = 0; move < most_moves; ++move) {
    Foot next = best;
    visit_beside(best, [&](int number) {
      const Foot there = on_element(number);
      const double of_there = height.of(there.point);
      if (of_there <= most + 1e-14 * largest_element_) return;
      next = there;
      most = of_there;
    });
    if (next.element == best.element) break;
    best = next;
  }
  best.normal = normal_at(best.element, best.weight);
  return best;
}

double BodySurface::bend_down(const Foot& summit, const Height& height) const noexcept {
  const double most = height.of(summit.point);
  double out = std::numeric_limits<double>::infinity();
  const auto look_at = [&](int number) {
    const WorldSurface::Element& on = surface().element[static_cast<std::size_t>(number)];
    for (const int corner : on.corner) {
      const Vector3d& x = surface().node[static_cast<std::size_t>(corner)];
      const double square = (x - summit.point).squaredNorm();
      // Near a node, round-off would count.
      if (square > 0.01 * on.size * on.size) out = std::min(out, 2 * (most - height.of(x)) / square);
    }
  };
  look_at(summit.element);
  visit_beside(summit, look_at);
  return out;
}

void BodySurface::summits(const Vector3d& n, double least, std::vector<Foot>& out) const noexcept {
  out.clear();
  for (int node = 0; node < static_cast<int>(surface().node.size()); ++node) {
    if (out.size() == out.capacity()) break;
    if (!(n.dot(surface().node[static_cast<std::size_t>(node)]) + camber_ > least) || !is_peak(node, n) ||
        elements_at(node).empty())
      continue;
    const Foot found = summit(elements_at(node).front(), {.up = n});
    if (!surface().element[static_cast<std::size_t>(found.element)].curved || !(n.dot(found.point) > least))
      continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const Foot& one) {
      return (one.point - found.point).norm() < indistinct * element_size(found);
    });
    if (!known) out.push_back(found);
  }
  std::sort(out.begin(), out.end(),
            [&](const Foot& one, const Foot& other) { return n.dot(one.point) > n.dot(other.point); });
}

/// From its place on the chords of its element, so that it stays where it is without a way.
Foot BodySurface::beside(const Foot& foot, const Vector3d& way) const noexcept {
  Foot out = follow(foot, on_chords(foot) + way);
  out.distance = 0;
  return out;
}

Eigen::Matrix3d BodySurface::curvature(const Foot& foot) const noexcept {
  return surface().curvature(surface().element[static_cast<std::size_t>(foot.element)], foot.point);
}

double BodySurface::rise(int node, const Vector3d& n) const noexcept {
  double out = -1;
  for (const Vector3d& edge : part(edges_, first_, node)) out = std::max(out, n.dot(edge));
  return out;
}

bool crossing(const Vector3d& p0, const Vector3d& p1, const Vector3d& q0, const Vector3d& q1, double& s,
              double& t) noexcept {
  const Vector3d a = p1 - p0, b = q1 - q0, r = q0 - p0;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b), area = aa * bb - ab * ab;
  if (!(area > parallel * parallel * aa * bb)) return false;
  s = (a.dot(r) * bb - b.dot(r) * ab) / area;
  t = (a.dot(r) * ab - b.dot(r) * aa) / area;
  return true;
}

}  // namespace ricochet::contact
