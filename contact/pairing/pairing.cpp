// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "base/format.hpp"
#include "contact/pairing/crease_points.hpp"
#include "contact/pairing/surface_distance.hpp"
#include "contact/pairing/surface_projection.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Normals perpendicular to the direction count as facing along it, so that the ends of a half rim are not
/// lost.
constexpr double facing_slack = 1e-6;

/// Depths below this share of the bodies' size are round-off of a touching placement.
constexpr double overlap_slack = 1e-12;

/// Error of curved elements as a share of the bulge of patches. Rounded bodies that touch in the drawing may
/// overlap by as much.
constexpr double curved_slack = 0.05;

/// Round-off of a point, relative to the largest coordinate from which it was computed by a rotation and two
/// sums.
constexpr double place_slack = 16 * std::numeric_limits<double>::epsilon();

/// Cosine between mutual normal and direction below which patches only graze each other; their gap is not
/// stretched further.
constexpr double steepest = 0.5;

/// Round-off of an overlap or a gap [m].
double round_off_of(const WorldSurface& a, const WorldSurface& b) {
  return overlap_slack * size_of(a, b) + place_slack * std::max(a.farthest, b.farthest);
}

/// Height of a patch over its mean along n. The surfaces face each other along their mutual normal, so only
/// the part along that normal separates them.
/// @param own  the normal of the patch, @param mutual  unit, on the same side
double bulge_along(double bulge, const Vector3d& own, const Vector3d& mutual, const Vector3d& n) {
  return bulge * mutual.dot(own) / std::max(mutual.dot(n), steepest);
}

/// Over an obstacle. @param facing  cosine between the patch and the normal
double bulge_over(const WorldSurface& a, std::size_t i, const WorldSurface& b, const Projection& y,
                  double facing) {
  if (a.on_crease[i]) return std::max(0.0, a.bulge[i]);
  const Eigen::Matrix3d W = b.curvature(b.element[static_cast<std::size_t>(y.element)], y.point);
  return std::max(0.0, a.bulge[i] * facing + bulge_under(a.area[i], W));
}

double bulge_of(const WorldSurface& a, std::size_t i, const WorldSurface& b, const Projection& y,
                const Vector3d& n) {
  if (b.is_rigid) return bulge_over(a, i, b, y, std::max(0.0, a.normal[i].dot(n)));
  double of_b = 0;
  for (int j = 0; j < b.corners; ++j) of_b += y.weight[j] * b.bulge[y.corner[j]];
  const Vector3d own = a.on_crease[i] ? Vector3d(-y.normal) : a.normal[i];
  const Vector3d mutual = (own - y.normal).normalized();
  return std::max(0.0, bulge_along(a.bulge[i], own, mutual, n) + bulge_along(of_b, -y.normal, mutual, n));
}

std::string title(const PairRequest& request) {
  return base::format("contact between \"{}\" and \"{}\"", request.a, request.b);
}

std::string text(const Vector3d& v) { return base::format("[{:.6g}, {:.6g}, {:.6g}]", v.x(), v.y(), v.z()); }

/// A kernel of one component contains only the motion along its own direction.
void check_component(const PlacedBody& body, const std::optional<Vector3d>& normal,
                     const PairRequest& request) {
  const kernels::Surface& surface = body.kernel->surface;
  if (surface.components != 1) return;
  const Vector3d own = body.rotation * Eigen::Map<const Vector3d>(surface.direction->data());
  if (normal && std::abs(own.dot(*normal)) >= 1 - 1e-9) return;
  throw InputError(base::format(
      "{}: the kernel of \"{}\" holds the motion along {} alone, but the contact acts along {}. Set "
      "contact.direction = {}, or compute the kernel for this scene with ricochet-kernel.",
      title(request), body.name, text(own), normal ? text(*normal) : "each point's own normal", text(own)));
}

/// Finds the pairs for a given position of a, before gap, reach and overlap are checked.
/// @param shift  of a since `over_a` was made, whose surface is that of a
Pairing find_pairs(const SurfaceProjection& over_a, const Vector3d& shift, const SurfaceProjection& onto,
                   const std::optional<Vector3d>& direction) {
  const WorldSurface &from = over_a.surface(), &b = onto.surface();
  const double size = size_of(from, b);
  Pairing out;
  for (std::size_t i = 0; i < from.node.size(); ++i) {
    const Vector3d x = from.crest[i] + shift;
    std::optional<Projection> y;
    Vector3d n = direction.value_or(Vector3d::Zero());
    if (!direction) {
      // The normal of an obstacle is exact, that of a patch is not.
      if (const auto found =
              onto.along_mutual_normal(x, from.normal[i], from.on_crease[i] != 0 || b.is_rigid, size))
        std::tie(y, n) = *found;
    } else if (from.normal[i].dot(n) > -facing_slack) {
      y = onto.first_along(x, n, size,
                           [&](const Projection& found) { return found.normal.dot(n) < facing_slack; });
    }
    if (!y) {
      ++out.unpaired;
      continue;
    }
    out.points.push_back({x,
                          y->point,
                          n,
                          n.dot(y->point - x),
                          from.area[i],
                          bulge_of(from, i, b, *y, n),
                          {{static_cast<int>(i), 1.0}},
                          weights_of(*y)});
  }
  add_crease_points(over_a, shift, onto, direction, out);
  return out;
}

const Pairing::Point& closest_pair(const Pairing& pairing) {
  return *std::min_element(pairing.points.begin(), pairing.points.end(),
                           [](const auto& p, const auto& q) { return p.gap < q.gap; });
}

/// The largest number of summits of a pair that may touch at a time.
constexpr int most_summits = 6;

bool is_curved(const WorldSurface& surface) {
  return surface.corners == 3 && std::ranges::any_of(surface.element, &WorldSurface::Element::curved);
}

/// The point of a surface that is farthest along n.
Projection farthest_along(const Vector3d& n, const WorldSurface& surface) {
  Projection out;
  double farthest = -std::numeric_limits<double>::infinity();
  for (const WorldSurface::Element& element : surface.element) {
    const auto weight = highest_weights(surface, element, {.up = n});
    const Vector3d x = surface.at(element, weight);
    if (n.dot(x) <= farthest) continue;
    farthest = n.dot(x);
    out = {x, n, element.corner, weight};
  }
  return out;
}

/// Adds points for summits of curved surfaces, which begin at a place.
void add_summits(const Pairing::Point& begin, Pairing& out) {
  out.summits = most_summits;
  out.points.insert(out.points.end(), most_summits, begin);
}

/// @param everywhere  because bodies turn: takes all candidates, and adds points for summits, which begin at
/// the lowest one
Pairing find_pairs(const PlacedBody& a, const Obstacle& b, bool everywhere) {
  const WorldSurface from = surface_of(a);
  const Vector3d n = -b.normal;
  Pairing out;
  for (std::size_t i = 0; i < from.node.size(); ++i) {
    if (!everywhere && from.normal[i].dot(n) <= -facing_slack) {
      ++out.unpaired;
      continue;
    }
    const Vector3d& x = from.crest[i];
    const double height = n.dot(b.point - x),
                 bulge = from.bulge[i] *
                         (everywhere || from.on_crease[i] ? 1 : std::max(0.0, from.normal[i].dot(n)));
    out.points.push_back(
        {x, x + height * n, n, height, from.area[i], std::max(0.0, bulge), {{static_cast<int>(i), 1.0}}, {}});
  }
  if (!everywhere) return out;
  out.candidates_of_a = static_cast<int>(out.points.size());
  if (!is_curved(from)) return out;
  const Projection top = farthest_along(n, from);
  const double height = n.dot(b.point - top.point);
  Pairing::Point summit{top.point, top.point + height * n, n, height, 0, 0, weights_of(top), {}};
  summit.area = sum_of(from.area, summit.of_a);
  summit.bulge = std::max(0.0, sum_of(from.bulge, summit.of_a));
  add_summits(summit, out);
  return out;
}

/// The largest number of creases of two bodies that turn which may cross at a time.
constexpr std::size_t most_crossings = 24;

/// The point of a that is x, or of b if `flips`, over y on the other surface.
Pairing::Point point_over(const Projection& y, const Vector3d& x, Pairing::Weights own, double area,
                          bool flips) {
  const Vector3d way = y.point - x;
  const double length = way.norm();
  // Beyond an edge, the way leads aside; inside, along the normal.
  const bool inside = y.normal.dot(way) > 0.9 * length && length > 0;
  const Vector3d n = length > 0 ? Vector3d((inside ? -1 : 1) / length * way) : Vector3d(-y.normal);
  const double gap = inside ? -length : length;
  if (flips) return {y.point, x, -n, gap, area, 0, weights_of(y), std::move(own)};
  return {x, y.point, n, gap, area, 0, std::move(own), weights_of(y)};
}

double mean_size(const WorldSurface& surface) {
  double sum = 0;
  for (const WorldSurface::Element& element : surface.element) sum += element.size;
  return sum / static_cast<double>(std::max<std::size_t>(surface.element.size(), 1));
}

/// All points of two bodies that may touch while they turn: the candidates of the one with the finer mesh,
/// those of the other one on its creases, and points for creases that cross and for summits.
Pairing find_all(const SurfaceProjection& over_a, const SurfaceProjection& over_b) {
  const WorldSurface &a = over_a.surface(), &b = over_b.surface();
  const bool a_is_finer = b.is_rigid || mean_size(a) <= mean_size(b);
  Pairing out;
  const auto add = [&](const WorldSurface& from, const SurfaceProjection& onto, bool all, bool flips) {
    for (std::size_t i = 0; i < from.node.size(); ++i) {
      if (!all && !from.on_crease[i]) continue;
      const auto y = onto.closest(from.crest[i]);
      if (!y) continue;
      out.points.push_back(point_over(*y, from.crest[i], {{static_cast<int>(i), 1.0}}, from.area[i], flips));
      if (b.is_rigid && !flips) out.points.back().bulge = bulge_over(from, i, b, *y, 1);
    }
  };
  add(a, over_b, a_is_finer, false);
  out.candidates_of_a = static_cast<int>(out.points.size());
  add(b, over_a, !a_is_finer, true);
  out.candidates_of_b = static_cast<int>(out.points.size()) - out.candidates_of_a;
  for (std::size_t k = 0; k < std::min({most_crossings, a.crease.size(), b.crease.size()}); ++k) {
    const auto [i, j] = a.crease[k].node;
    const Vector3d x = (a.node[i] + a.node[j]) / 2;
    if (const auto y = over_b.closest(x))
      out.points.push_back(point_over(*y, x, {{i, 0.5}, {j, 0.5}}, 0, false));
  }
  if ((is_curved(a) || is_curved(b)) && !out.points.empty()) {
    Pairing::Point summit = closest_pair(out);
    // Between candidates, a surface may be nearer.
    const Projection top = farthest_along(summit.normal, a);
    if (const auto y = over_b.closest(top.point)) {
      Pairing::Point point = point_over(*y, top.point, weights_of(top), 0, false);
      if (point.gap < summit.gap) summit = std::move(point);
    }
    summit.area = sum_of(a.area, summit.of_a);
    summit.bulge = std::max(0.0, sum_of(a.bulge, summit.of_a) + sum_of(b.bulge, summit.of_b));
    add_summits(summit, out);
  }
  return out;
}

void check_some(const Pairing& pairing, const PairRequest& request) {
  if (pairing.points.empty())
    throw InputError(
        base::format("{}: no point of \"{}\" faces \"{}\" ({} candidates examined). Check bodies.*.contact, "
                     "translate and rotate_deg, and contact.direction (it points out of \"{}\").",
                     title(request), request.a, request.b, pairing.unpaired, request.a));
}

/// Applies gap and reach, and checks overlap. `find` returns the pairs for a given position of a.
template <class Find>
Pairing arrange(PlacedBody a, const PairRequest& request, double round_off, Find find) {
  Pairing out = find(a);
  check_some(out, request);
  if (request.gap) {
    if (!(*request.gap >= 0))
      throw InputError(base::format("{}: gap = {}: must not be negative.", title(request), *request.gap));
    Vector3d way = Vector3d::Zero();
    if (request.everywhere)
      way = closest_pair(out).normal;
    else
      for (const auto& point : out.points) way += point.area * point.normal;
    way = request.direction.value_or(way.normalized());
    Vector3d shift = Vector3d::Zero();
    // Newton's method. With a given direction, the first round is exact; otherwise, pairs change as a moves.
    for (int round = 0;; ++round) {
      const Pairing::Point& nearest = closest_pair(out);
      const double excess = nearest.gap - *request.gap, rate = nearest.normal.dot(way);
      if (std::abs(excess) <= round_off + overlap_slack * std::abs(nearest.gap) && round > 0) break;
      if (round == 50 || !(rate > 1e-3))
        throw InputError(
            base::format("{}: gap = {} m cannot be reached by moving \"{}\" along {}. Place it nearer with "
                         "translate, or set contact.direction.",
                         title(request), *request.gap, a.name, text(way)));
      shift += excess / rate * way;
      a.translation += excess / rate * way;
      out = find(a);
      check_some(out, request);
    }
    out.shift = shift;
  }
  const Pairing::Point nearest = closest_pair(out);
  if (nearest.gap < -round_off - curved_slack * nearest.bulge)
    throw InputError(
        base::format("{}: they overlap by {:.6g} m at {}. Move one with translate, or set contact.gap.",
                     title(request), -nearest.gap, text(nearest.a)));
  for (auto& point : out.points) point.gap = std::max(point.gap, 0.0);
  out.reach = request.reach;
  if (request.zone) {
    const double within = std::max(nearest.gap, 0.0) + *request.zone;
    out.reach = std::min(within, out.reach.value_or(within));
  }
  if (out.reach) {
    out.beyond_reach = static_cast<int>(
        std::erase_if(out.points, [&](const auto& point) { return !(point.gap < *out.reach); }));
    out.unpaired += out.beyond_reach;
    if (out.points.empty())
      throw InputError(base::format(
          "{}: reach = {} m: the closest pair is {:.6g} m apart. Raise it above that, or set contact.gap.",
          title(request), *out.reach, nearest.gap));
  }
  return out;
}

Pairing pair_surfaces(const PlacedBody& a, const SurfaceProjection& onto, const PairRequest& request) {
  const SurfaceProjection over_a(surface_of(a));
  return arrange(a, request, round_off_of(over_a.surface(), onto.surface()), [&](const PlacedBody& moved) {
    if (request.everywhere) return find_all(SurfaceProjection(surface_of(moved)), onto);
    return find_pairs(over_a, moved.translation - a.translation, onto, request.direction);
  });
}

}  // namespace

Pairing pair(const PlacedBody& a, const PlacedBody& b, const PairRequest& request) {
  check_component(a, request.direction, request);
  check_component(b, request.direction, request);
  return pair_surfaces(a, SurfaceProjection(surface_of(b)), request);
}

Pairing pair(const PlacedBody& a, const Obstacle& b, const PairRequest& request) {
  if (b.surface) {
    check_component(a, request.direction, request);
    Pairing out = pair_surfaces(a, SurfaceProjection(placed(b)), request);
    const auto end = static_cast<std::size_t>(out.candidates_of_a + out.candidates_of_b);
    for (std::size_t i = 0; i < out.points.size(); ++i)
      if (i < static_cast<std::size_t>(out.candidates_of_a) || i >= end) out.points[i].of_b.clear();
    return out;
  }
  if (request.direction && request.direction->dot(-b.normal) < 1 - 1e-9)
    throw InputError(
        base::format("{}: direction = {}: against an obstacle contact acts along minus its normal. Leave "
                     "direction out, or set {}.",
                     title(request), text(*request.direction), text(-b.normal)));
  check_component(a, Vector3d(-b.normal), request);
  const WorldSurface from = surface_of(a);
  const double round_off = round_off_of(from, from) + place_slack * b.point.cwiseAbs().maxCoeff();
  return arrange(a, request, round_off,
                 [&](const PlacedBody& moved) { return find_pairs(moved, b, request.everywhere); });
}

namespace {

/// Accuracy of the true distance as a share of an element.
constexpr double distance_share = 1e-3;

std::optional<TrueDistance> distance_between(const SurfaceProjection& one, const SurfaceProjection& other,
                                             const PairRequest& request) {
  if (request.direction || one.surface().corners != 3 || other.surface().corners != 3) return std::nullopt;
  const double element = std::min(smallest_element(one.surface()), smallest_element(other.surface()));
  return TrueDistance{surface_distance(one, other, distance_share * element), element};
}

}  // namespace

std::optional<TrueDistance> true_distance(const PlacedBody& a, const PlacedBody& b,
                                          const PairRequest& request) {
  return distance_between(SurfaceProjection(surface_of(a)), SurfaceProjection(surface_of(b)), request);
}

std::optional<TrueDistance> true_distance(const PlacedBody& a, const Obstacle& b,
                                          const PairRequest& request) {
  if (b.surface)
    return distance_between(SurfaceProjection(surface_of(a)), SurfaceProjection(placed(b)), request);
  const WorldSurface surface = surface_of(a);
  if (surface.corners != 3) return std::nullopt;
  const double element = smallest_element(surface);
  return TrueDistance{std::max(0.0, surface_distance(surface, b, distance_share * element)), element};
}

}  // namespace ricochet::contact
