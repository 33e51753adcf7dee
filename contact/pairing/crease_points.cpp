// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/crease_points.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Share of an element by which a point must be nearer than its neighbours, and round-off of slopes.
constexpr double nearer = 1e-6, level = 1e-9;

/// Finds pairs of a model that share candidates with a new point.
class Neighbours {
 public:
  Neighbours(const WorldSurface& a, const WorldSurface& b, const Pairing& pairing)
      : by_a_(a.node.size()), by_b_(b.node.size()) {
    for (const Pairing::Point& point : pairing.points) add(point);
  }

  void add(const Pairing::Point& point) {
    for (const auto& [i, weight] : point.of_a) by_a_[i].push_back(point.gap);
    for (const auto& [j, weight] : point.of_b) by_b_[j].push_back(point.gap);
  }

  /// Whether a pair around this point is as near.
  bool as_near(const Pairing::Point& point, double tolerance) const {
    const auto near = [&](double gap) { return gap <= point.gap + tolerance; };
    const auto any = [&](const auto& gaps, const Pairing::Weights& weights) {
      return std::ranges::any_of(weights,
                                 [&](const auto& w) { return std::ranges::any_of(gaps[w.first], near); });
    };
    return any(by_a_, point.of_a) || any(by_b_, point.of_b);
  }

 private:
  std::vector<std::vector<double>> by_a_, by_b_;  ///< gaps of the pairs of each candidate
};

/// Weights of both nodes of a crease for a point on it. They refer to the points x̂ of their patches, which
/// are the lever arms.
Pairing::Weights weights_on(const WorldSurface& surface, const WorldSurface::Crease& crease,
                            const Vector3d& x) {
  const auto [i, j] = crease.node;
  const Vector3d way = surface.crest[j] - surface.crest[i];
  const double s = std::clamp(way.dot(x - surface.crest[i]) / way.squaredNorm(), 0.0, 1.0);
  Pairing::Weights out;
  if (s < 1) out.emplace_back(i, 1 - s);
  if (s > 0) out.emplace_back(j, s);
  return out;
}

/// The crossing of two creases, if both faces of either fall away from it.
std::optional<Pairing::Point> crossing(const WorldSurface& a, const WorldSurface::Crease& on_a,
                                       const Vector3d& shift, const WorldSurface& b,
                                       const WorldSurface::Crease& on_b,
                                       const std::optional<Vector3d>& direction) {
  const Vector3d x = a.node[on_a.node[0]] + shift, y = b.node[on_b.node[0]],
                 e = a.node[on_a.node[1]] + shift - x, f = b.node[on_b.node[1]] - y;
  Vector3d apart = e.cross(f);
  const double sine = apart.norm();
  if (!(sine > 1e-3 * e.norm() * f.norm())) return std::nullopt;
  apart /= apart.dot(on_a.normal) > 0 ? sine : -sine;
  for (int side = 0; side < 2; ++side)
    if (apart.dot(on_a.into[side]) > level || apart.dot(on_b.into[side]) < -level) return std::nullopt;
  const Vector3d n = direction.value_or(apart);
  if (!(n.dot(apart) > 0)) return std::nullopt;
  // x + s e + g n = y + t f
  Eigen::Matrix3d columns;
  columns << e, -f, n;
  const Vector3d stg = columns.partialPivLu().solve(y - x);
  const double s = stg[0], t = stg[1];
  if (std::min({s, t, 1 - s, 1 - t}) < -level) return std::nullopt;
  const Vector3d at_a = x + s * e, at_b = y + t * f;
  Pairing::Point point{
      at_a, at_b, n, stg[2], 0, 0, weights_on(a, on_a, at_a - shift), weights_on(b, on_b, at_b)};
  point.area = sum_of(a.area, point.of_a);
  point.bulge = std::max(0.0, sum_of(a.bulge, point.of_a) + sum_of(b.bulge, point.of_b));
  return point;
}

/// A node of b on a crease and the point of a that it faces.
std::optional<Pairing::Point> corner_on_face(const SurfaceProjection& a, const Vector3d& shift,
                                             const WorldSurface& b, int node, double size,
                                             const std::optional<Vector3d>& direction) {
  const Vector3d &y = b.crest[node], &own = b.normal[node];
  std::optional<Projection> x;
  Vector3d n = Vector3d::Zero();
  if (!direction) {
    if (const auto found = a.along_mutual_normal(y - shift, own, true, size)) std::tie(x, n) = *found;
    n = -n;
  } else {
    n = *direction;
    if (own.dot(n) < 0)
      x = a.first_along(y - shift, n, size, [&](const Projection& found) { return found.normal.dot(n) > 0; });
  }
  if (!x) return std::nullopt;
  const Vector3d at = x->point + shift;
  Pairing::Point point{at, y, n, n.dot(y - at), 0, 0, weights_of(*x), {{node, 1.0}}};
  point.area = sum_of(a.surface().area, point.of_a);
  point.bulge = std::max(0.0, sum_of(a.surface().bulge, point.of_a) + b.bulge[node]);
  return point;
}

/// Whether x lies inside a body, seen from the closest point of its surface.
bool inside(const SurfaceProjection& body, const Vector3d& x) {
  const auto y = body.closest(x);
  return y && y->normal.dot(x - y->point) < 0;
}

}  // namespace

double sum_of(const std::vector<double>& values, const Pairing::Weights& weights) {
  double sum = 0;
  for (const auto& [i, weight] : weights) sum += weight * values[i];
  return sum;
}

Pairing::Weights weights_of(const Projection& y) {
  Pairing::Weights out;
  for (int j = 0; j < 3; ++j)
    if (y.weight[j] > 0) out.emplace_back(y.corner[j], y.weight[j]);
  return out;
}

void add_crease_points(const SurfaceProjection& over_a, const Vector3d& shift, const SurfaceProjection& onto,
                       const std::optional<Vector3d>& direction, Pairing& pairing) {
  const WorldSurface &a = over_a.surface(), &b = onto.surface();
  if (b.crease.empty()) return;
  const double size = size_of(a, b);
  double element = size;
  for (const WorldSurface* surface : {&a, &b})
    for (const WorldSurface::Element& one : surface->element) element = std::min(element, one.size);
  Neighbours neighbours(a, b, pairing);
  const auto offer = [&](std::optional<Pairing::Point> point) {
    if (!point || neighbours.as_near(*point, nearer * element)) return;
    // Sides that face away from each other seem to overlap by all that is between them.
    if (point->gap < -level * element && !(inside(onto, point->a) && inside(over_a, point->b - shift)))
      return;
    neighbours.add(*point);
    pairing.points.push_back(std::move(*point));
  };
  for (const WorldSurface::Crease& on_a : a.crease)
    for (const WorldSurface::Crease& on_b : b.crease) {
      // Creases face each other as their faces do.
      if (!(on_a.normal.dot(on_b.normal) < 0)) continue;
      offer(crossing(a, on_a, shift, b, on_b, direction));
    }
  std::vector<int> node;
  for (const WorldSurface::Crease& crease : b.crease)
    node.insert(node.end(), crease.node.begin(), crease.node.end());
  std::ranges::sort(node);
  node.erase(std::unique(node.begin(), node.end()), node.end());
  for (const int j : node) offer(corner_on_face(over_a, shift, b, j, size, direction));
}

}  // namespace ricochet::contact
