// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/surface_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// A line intersects an element up to this share of the element's size beyond its edges, so that no line
/// slips between two elements.
constexpr double edge_slack = 1e-6;

/// Change of n_i at which the search for a mutual normal stops, and the largest change at which it may end.
constexpr double settled = 1e-13, settled_enough = 1e-6;

/// @param from  kernels::Surface or kernels::WholeSurface
template <class From>
WorldSurface placed(const PlacedBody& body, const From& from) {
  WorldSurface to;
  to.corners = from.element_corners;
  to.area = from.area;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < from.area.size(); ++i) {
    const Eigen::Map<const Vector3d> own(&from.node[3 * i]);
    to.node.push_back(body.rotation * own + body.translation);
    to.normal.push_back(body.rotation * Eigen::Map<const Vector3d>(&from.normal[3 * i]));
    to.offset.emplace_back(Vector3d::Zero());
    if (!from.centroid.empty())
      to.offset.back() = body.rotation * (Eigen::Map<const Vector3d>(&from.centroid[3 * i]) - own);
    box.extend(to.node.back());
    to.farthest = std::max({to.farthest, to.node.back().cwiseAbs().maxCoeff(), own.cwiseAbs().maxCoeff()});
  }
  if (!box.isEmpty()) to.extent = box.diagonal().norm();
  const std::size_t k = to.corners;
  for (std::size_t t = 0; t + k <= from.element.size(); t += k) {
    WorldSurface::Element element;
    for (std::size_t j = 0; j < k; ++j) element.corner[j] = static_cast<int>(from.element[t + j]);
    to.add(element);
  }
  return to;
}

/// The point with these weights, clipped to [0, 1]; no value if the normals at the corners cancel.
std::optional<Projection> projection(const WorldSurface& b, const WorldSurface::Element& element,
                                     std::array<double, 3> weight) {
  Projection out{Vector3d::Zero(), Vector3d::Zero(), element.corner, weight};
  double sum = 0;
  for (double& w : out.weight) sum += w = std::clamp(w, 0.0, 1.0);
  for (int j = 0; j < b.corners; ++j) {
    out.weight[j] /= sum;
    out.point += out.weight[j] * b.node[out.corner[j]];
    out.normal += out.weight[j] * b.normal[out.corner[j]];
  }
  const double length = out.normal.norm();
  if (!(length > 1e-9)) return std::nullopt;
  out.normal /= length;
  return out;
}

/// A line that is farther than this from the centre of an element does not intersect it [m].
double reach_of(const WorldSurface::Element& element) { return element.size * (1 + edge_slack); }

/// The intersection of the line x + t d with an element.
std::optional<Projection> intersection(const WorldSurface& b, const WorldSurface::Element& element,
                                       const Vector3d& x, const Vector3d& d, double size) {
  const Vector3d& p = b.node[element.corner[0]];
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - v.dot(d) * d; };
  if (b.corners == 1) {
    if (across(x - p).norm() > edge_slack * size) return std::nullopt;
    return projection(b, element, {1, 0, 0});
  }
  const double reach = reach_of(element);
  if (across(x - element.centre).squaredNorm() > reach * reach) return std::nullopt;
  const Vector3d r = x - p, e1 = b.node[element.corner[1]] - p;
  if (b.corners == 2) {
    const Vector3d tangent = across(e1);
    const double length = tangent.norm();
    if (length <= 1e-9 * element.size) return std::nullopt;
    const double s = tangent.dot(r) / (length * length);
    const double margin = std::min(edge_slack * element.size / length, 0.5);
    if (s < -margin || s > 1 + margin) return std::nullopt;
    if ((across(r) - s * tangent).norm() > 0.5 * element.size) return std::nullopt;
    return projection(b, element, {1 - s, s, 0});
  }
  // r + t d = u e1 + v e2
  const Vector3d e2 = b.node[element.corner[2]] - p;
  const Vector3d normal = e1.cross(e2);
  const double determinant = normal.dot(d);
  if (std::abs(determinant) <= 1e-9 * normal.norm()) return std::nullopt;
  const double u = r.dot(e2.cross(d)) / determinant, v = r.dot(d.cross(e1)) / determinant;
  const double margin = std::min(edge_slack * element.size * element.size / std::abs(determinant), 0.5);
  if (u < -margin || v < -margin || u + v > 1 + margin) return std::nullopt;
  return projection(b, element, {1 - u - v, u, v});
}

/// Weights of the point of an element that is closest to x.
/// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5, by Voronoi regions.
std::array<double, 3> closest_weights(const WorldSurface& b, const WorldSurface::Element& element,
                                      const Vector3d& x) {
  const Vector3d& p = b.node[element.corner[0]];
  if (b.corners == 1) return {1, 0, 0};
  const Vector3d e1 = b.node[element.corner[1]] - p, r = x - p;
  const double d1 = e1.dot(r), l1 = e1.squaredNorm();
  if (b.corners == 2) {
    const double s = l1 > 0 ? std::clamp(d1 / l1, 0.0, 1.0) : 0;
    return {1 - s, s, 0};
  }
  const Vector3d e2 = b.node[element.corner[2]] - p;
  const double d2 = e2.dot(r);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = d1 - l1, d4 = d2 - e1.dot(e2);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = d1 - e1.dot(e2), d6 = d2 - e2.squaredNorm();
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

constexpr double none = std::numeric_limits<double>::max();

/// The objective of Eigen::BVMinimize: finds the nearest projection, and among equally near ones that of the
/// first element.
template <class Bound, class At>
struct Nearest {
  using Scalar = double;
  Nearest(Bound of_box, At of_element) : bound(of_box), at(of_element) {}

  /// Slightly below the bound, so that round-off hides neither a projection nor another one at the smallest
  /// distance so far.
  double minimumOnVolume(const Eigen::AlignedBox3d& box) {
    const double least = bound(box);
    return least == none ? none : std::max(least, 0.0) * (1 - 1e-9) - std::numeric_limits<double>::min();
  }
  double minimumOnObject(int number) {
    const auto found = at(number);
    if (!found) return none;
    const double far = found->second;
    if (far < distance || (far == distance && number < element)) {
      projection = found->first;
      distance = far;
      element = number;
    }
    return far;
  }

  Bound bound;
  At at;
  std::optional<Projection> projection;
  double distance = none;
  int element = 0;
};

}  // namespace

void WorldSurface::add(Element of_corners) {
  for (int j = 0; j < corners; ++j) {
    of_corners.centre += node[of_corners.corner[j]] / static_cast<double>(corners);
    for (int i = 0; i < j; ++i)
      of_corners.size =
          std::max(of_corners.size, (node[of_corners.corner[i]] - node[of_corners.corner[j]]).norm());
  }
  element.push_back(of_corners);
}

WorldSurface surface_of(const PlacedBody& body) {
  const kernels::Surface& held = body.kernel->surface;
  return held.whole ? placed(body, *held.whole) : placed(body, held);
}

double size_of(const WorldSurface& a, const WorldSurface& b) {
  const double extent = std::max(a.extent, b.extent);
  return extent > 0 ? extent : 1 + std::max(a.farthest, b.farthest);
}

SurfaceProjection::SurfaceProjection(WorldSurface surface) : surface_(std::move(surface)) {
  std::vector<int> number(surface_.element.size());
  std::iota(number.begin(), number.end(), 0);
  std::vector<Eigen::AlignedBox3d> box;
  for (const WorldSurface::Element& element : surface_.element) {
    const Vector3d reach = Vector3d::Constant(reach_of(element));
    box.emplace_back(element.centre - reach, element.centre + reach);
  }
  elements_.init(number.begin(), number.end(), box.begin(), box.end());
}

std::optional<Projection> SurfaceProjection::first_along(
    const Vector3d& x, const Vector3d& d, double size,
    const std::function<bool(const Projection&)>& faces) const {
  Nearest nearest(
      [&](const Eigen::AlignedBox3d& box) {
        const double slack = edge_slack * size;
        const Vector3d away = box.center() - x, half = box.sizes() / 2 + Vector3d::Constant(slack);
        // The line misses the box if d × e_k separates them for one of the axes e_k.
        for (int k = 0; k < 3; ++k) {
          const Vector3d side = d.cross(Vector3d::Unit(k));
          if (std::abs(side.dot(away)) > half.dot(side.cwiseAbs())) return none;
        }
        return std::abs(d.dot(away)) - half.dot(d.cwiseAbs());
      },
      [&](int element) -> std::optional<std::pair<Projection, double>> {
        const auto found = intersection(surface_, surface_.element[element], x, d, size);
        if (!found || !faces(*found)) return std::nullopt;
        return std::pair(*found, std::abs(d.dot(found->point - x)));
      });
  Eigen::BVMinimize(elements_, nearest);
  return nearest.projection;
}

std::optional<Projection> SurfaceProjection::closest(const Vector3d& x) const {
  Nearest nearest([&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(x); },
                  [&](int element) -> std::optional<std::pair<Projection, double>> {
                    const WorldSurface::Element& on = surface_.element[element];
                    const auto found = projection(surface_, on, closest_weights(surface_, on, x));
                    if (!found) return std::nullopt;
                    return std::pair(*found, (found->point - x).norm());
                  });
  Eigen::BVMinimize(elements_, nearest);
  return nearest.projection;
}

std::optional<std::pair<Projection, Vector3d>> SurfaceProjection::along_mutual_normal(const Vector3d& x,
                                                                                      const Vector3d& n_a,
                                                                                      double size) const {
  const auto faces = [&](const Projection& y) { return n_a.dot(y.normal) < 0; };
  auto y = closest(x);
  if (!y || !faces(*y)) return std::nullopt;
  Vector3d n = (n_a - y->normal).normalized();
  double change = 0;
  bool met = false;
  for (int round = 0; round < 20; ++round) {
    const double gap = n.dot(y->point - x);
    auto found = first_along(x, n, size, faces);
    met = found.has_value();
    if (!met) found = closest(x + gap * n);
    if (!found || !faces(*found)) return std::nullopt;
    y = found;
    const Vector3d next = (n_a - y->normal).normalized();
    change = (next - n).norm();
    if (change < settled) break;
    n = next;
  }
  if (!met || change > settled_enough) return std::nullopt;
  return std::pair(*y, n);
}

}  // namespace ricochet::contact
