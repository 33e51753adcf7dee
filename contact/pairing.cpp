#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "contact/model.hpp"
#include "kernels/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Normals at right angles to the direction still face along it: the ends of a half rim must not be lost.
constexpr double facing_slack = 1e-6;

/// A line meets an element up to this share of its size beyond the edges, so that none slips between two.
constexpr double edge_slack = 1e-6;

/// Depths below this share of the bodies' size are round-off of a touching placement.
constexpr double overlap_slack = 1e-12;

/// Round-off of a place, of the largest coordinate that it was computed from: a turn and two sums.
constexpr double place_slack = 16 * std::numeric_limits<double>::epsilon();

/// Change of n_i below which the search for a mutual normal has settled, and the one it must reach.
constexpr double settled = 1e-13, settled_enough = 1e-6;

/// Cosine between mutual normal and direction below which patches only glance: their gap stretches no
/// further.
constexpr double steepest = 0.5;

/// Candidate surface of a body, in the world.
struct Surface {
  int corners = 3;
  std::vector<Vector3d> node, normal;
  std::vector<Vector3d> offset;  ///< of each patch's centroid from its node [m]
  struct Element {
    std::array<int, 3> corner{};
    Vector3d centre = Vector3d::Zero();
    double size = 0;  ///< longest edge [m]
  };
  std::vector<Element> element;
  double extent = 0;    ///< diagonal of the nodes' bounding box [m]
  double farthest = 0;  ///< largest |coordinate| of a node, in the world and in the body's own frame [m]
};

/// A place on a candidate surface.
struct Place {
  Vector3d point, normal;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{};
};

Surface surface_of(const PlacedBody& body) {
  const kernels::Surface& from = body.kernel->surface;
  Surface to;
  to.corners = from.element_corners;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < from.size(); ++i) {
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
  const std::size_t k = static_cast<std::size_t>(to.corners);
  for (std::size_t t = 0; t + k <= from.element.size(); t += k) {
    Surface::Element element;
    for (std::size_t j = 0; j < k; ++j) {
      element.corner[j] = static_cast<int>(from.element[t + j]);
      element.centre += to.node[element.corner[j]] / static_cast<double>(k);
      for (std::size_t i = 0; i < j; ++i)
        element.size =
            std::max(element.size, (to.node[element.corner[i]] - to.node[element.corner[j]]).norm());
    }
    to.element.push_back(element);
  }
  return to;
}

/// What round-off is measured by [m]. Rods have no extent; then a metre counts, and how far out they are.
double size_of(const Surface& a, const Surface& b) {
  const double extent = std::max(a.extent, b.extent);
  return extent > 0 ? extent : 1 + std::max(a.farthest, b.farthest);
}

/// Depths and misses of a gap that mean nothing [m].
double round_off_of(const Surface& a, const Surface& b) {
  return overlap_slack * size_of(a, b) + place_slack * std::max(a.farthest, b.farthest);
}

/// The place of these weights, clipped to [0, 1]. None where the corners' normals cancel.
std::optional<Place> place(const Surface& b, const Surface::Element& element, std::array<double, 3> weight) {
  Place out{Vector3d::Zero(), Vector3d::Zero(), element.corner, weight};
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

/// Where the line x + t d meets an element.
///
/// Triangles: projection along d. Segments stand for strips that extend sideways, so the place is the one
/// abreast of the line along the segment as seen along d, and the line may pass beside it by half the
/// segment's length. Points: met within 1e-6 of `size`.
std::optional<Place> meet(const Surface& b, const Surface::Element& element, const Vector3d& x,
                          const Vector3d& d, double size) {
  const Vector3d& p = b.node[element.corner[0]];
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - v.dot(d) * d; };
  if (b.corners == 1) {
    if (across(x - p).norm() > edge_slack * size) return std::nullopt;
    return place(b, element, {1, 0, 0});
  }
  const double reach = element.size * (1 + edge_slack);
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
    return place(b, element, {1 - s, s, 0});
  }
  // r + t d = u e1 + v e2
  const Vector3d e2 = b.node[element.corner[2]] - p;
  const Vector3d normal = e1.cross(e2);
  const double determinant = normal.dot(d);
  if (std::abs(determinant) <= 1e-9 * normal.norm()) return std::nullopt;
  const double u = r.dot(e2.cross(d)) / determinant, v = r.dot(d.cross(e1)) / determinant;
  const double margin = std::min(edge_slack * element.size * element.size / std::abs(determinant), 0.5);
  if (u < -margin || v < -margin || u + v > 1 + margin) return std::nullopt;
  return place(b, element, {1 - u - v, u, v});
}

/// Weights of the point of an element that is closest to x.
/// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5, by Voronoi regions.
std::array<double, 3> closest(const Surface& b, const Surface::Element& element, const Vector3d& x) {
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

std::optional<Place> closest_place(const Surface& b, const Vector3d& x) {
  std::optional<Place> best;
  double distance = std::numeric_limits<double>::infinity();
  for (const Surface::Element& element : b.element) {
    if ((x - element.centre).norm() - element.size >= distance) continue;
    const auto found = place(b, element, closest(b, element, x));
    if (!found || (found->point - x).norm() >= distance) continue;
    distance = (found->point - x).norm();
    best = found;
  }
  return best;
}

/// Of the places where the line x + t d meets b and `faces` holds, the one with the smallest |t|.
template <class Faces>
std::optional<Place> first_along(const Surface& b, const Vector3d& x, const Vector3d& d, double size,
                                 Faces faces) {
  std::optional<Place> best;
  double distance = std::numeric_limits<double>::infinity();
  for (const Surface::Element& element : b.element) {
    const auto found = meet(b, element, x, d, size);
    if (!found || !faces(*found)) continue;
    const double t = std::abs(d.dot(found->point - x));
    if (t >= distance) continue;
    distance = t;
    best = found;
  }
  return best;
}

/// The place on b that x faces along the mutual normal n = (n_a − n_b)/|n_a − n_b|, which depends on the
/// place: fixed-point iteration from the closest one. Each round shrinks the error about as the gap compares
/// with b's diameter. A line that misses b on the way is led back to it; the last one must meet it.
std::optional<std::pair<Place, Vector3d>> along_mutual_normal(const Surface& b, const Vector3d& x,
                                                              const Vector3d& n_a, double size) {
  const auto faces = [&](const Place& y) { return n_a.dot(y.normal) < 0; };
  auto y = closest_place(b, x);
  if (!y || !faces(*y)) return std::nullopt;
  Vector3d n = (n_a - y->normal).normalized();
  double change = 0;
  bool met = false;
  for (int round = 0; round < 20; ++round) {
    const double gap = n.dot(y->point - x);
    auto found = first_along(b, x, n, size, faces);
    met = found.has_value();
    if (!met) found = closest_place(b, x + gap * n);
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

/// What the gap along n between the means of the patches has over that between their nodes, as displacements
/// are means too. Lopsided patches stand off their nodes sideways; the surfaces meet across their mutual
/// normal, so that only what lies along it separates them.
double between_means(const Surface& a, std::size_t i, const Surface& b, const Place& y, const Vector3d& n) {
  Vector3d apart = -a.offset[i];
  for (int j = 0; j < b.corners; ++j) apart += y.weight[j] * b.offset[static_cast<std::size_t>(y.corner[j])];
  const Vector3d mutual = (a.normal[i] - y.normal).normalized();
  return mutual.dot(apart) / std::max(mutual.dot(n), steepest);
}

std::string title(const PairRequest& request) {
  return fmt::format("contact between \"{}\" and \"{}\"", request.a, request.b);
}

std::string text(const Vector3d& v) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x(), v.y(), v.z()); }

/// A kernel of one component knows no directions but its own.
void check_component(const PlacedBody& body, const std::optional<Vector3d>& normal,
                     const PairRequest& request) {
  const kernels::Surface& surface = body.kernel->surface;
  if (surface.components != 1) return;
  const Vector3d own = body.rotation * Eigen::Map<const Vector3d>(surface.direction->data());
  if (normal && std::abs(own.dot(*normal)) >= 1 - 1e-9) return;
  throw InputError(fmt::format(
      "{}: the kernel of \"{}\" holds the motion along {} alone, but the contact acts along {}. Set "
      "contact.direction = {}, or compute the kernel for this scene with ricochet-kernel.",
      title(request), body.name, text(own), normal ? text(*normal) : "each point's own normal", text(own)));
}

/// Pairs for a given place of a, before gap, reach and overlap are looked at.
Pairing find_pairs(const PlacedBody& a, const Surface& b, const std::optional<Vector3d>& direction) {
  const Surface from = surface_of(a);
  const double size = size_of(from, b);
  Pairing out;
  for (std::size_t i = 0; i < from.node.size(); ++i) {
    const Vector3d& x = from.node[i];
    std::optional<Place> y;
    Vector3d n = direction.value_or(Vector3d::Zero());
    if (!direction) {
      if (const auto found = along_mutual_normal(b, x, from.normal[i], size)) std::tie(y, n) = *found;
    } else if (from.normal[i].dot(n) > -facing_slack) {
      y = first_along(b, x, n, size, [&](const Place& place) { return place.normal.dot(n) < facing_slack; });
    }
    if (!y) {
      ++out.unpaired;
      continue;
    }
    const double gap = n.dot(y->point - x) + between_means(from, i, b, *y, n);
    Pairing::Point point{static_cast<int>(i), x, y->point, n, gap, a.kernel->surface.area[i], {}};
    for (int j = 0; j < b.corners; ++j)
      if (y->weight[j] > 0) point.weights.emplace_back(y->corner[j], y->weight[j]);
    out.points.push_back(std::move(point));
  }
  return out;
}

Pairing find_pairs(const PlacedBody& a, const HalfSpace& b) {
  const Surface from = surface_of(a);
  const Vector3d n = -b.normal;
  Pairing out;
  for (std::size_t i = 0; i < from.node.size(); ++i) {
    if (from.normal[i].dot(n) <= -facing_slack) {
      ++out.unpaired;
      continue;
    }
    const double height = n.dot(b.point - from.node[i]);
    out.points.push_back({static_cast<int>(i),
                          from.node[i],
                          from.node[i] + height * n,
                          n,
                          height - n.dot(from.offset[i]),
                          a.kernel->surface.area[i],
                          {}});
  }
  return out;
}

const Pairing::Point& closest_pair(const Pairing& pairing) {
  return *std::min_element(pairing.points.begin(), pairing.points.end(),
                           [](const auto& p, const auto& q) { return p.gap < q.gap; });
}

void check_some(const Pairing& pairing, const PairRequest& request) {
  if (pairing.points.empty())
    throw InputError(
        fmt::format("{}: no point of \"{}\" faces \"{}\" ({} candidates looked at). Check bodies.*.contact, "
                    "translate and rotate_deg, and contact.direction (it points out of \"{}\").",
                    title(request), request.a, request.b, pairing.unpaired, request.a));
}

/// gap, overlap and reach. `find` pairs for a given place of a.
template <class Find>
Pairing arrange(PlacedBody a, const PairRequest& request, double round_off, Find find) {
  Pairing out = find(a);
  check_some(out, request);
  if (request.gap) {
    if (!(*request.gap >= 0))
      throw InputError(fmt::format("{}: gap = {}: must not be negative.", title(request), *request.gap));
    Vector3d way = Vector3d::Zero();
    for (const auto& point : out.points) way += point.area * point.normal;
    way = request.direction.value_or(way.normalized());
    Vector3d shift = Vector3d::Zero();
    // Newton's method: with one direction the first round is exact, else pairs change as a moves.
    for (int round = 0;; ++round) {
      const Pairing::Point& nearest = closest_pair(out);
      const double excess = nearest.gap - *request.gap, rate = nearest.normal.dot(way);
      if (std::abs(excess) <= round_off + overlap_slack * std::abs(nearest.gap) && round > 0) break;
      if (round == 50 || !(rate > 1e-3))
        throw InputError(
            fmt::format("{}: gap = {} m can't be reached by moving \"{}\" along {}. Place it nearer with "
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
  if (nearest.gap < -round_off)
    throw InputError(
        fmt::format("{}: they overlap by {:.6g} m at {}. Move one with translate, or set contact.gap.",
                    title(request), -nearest.gap, text(nearest.a)));
  for (auto& point : out.points) point.gap = std::max(point.gap, 0.0);
  if (request.reach) {
    out.unpaired += static_cast<int>(
        std::erase_if(out.points, [&](const auto& point) { return !(point.gap < *request.reach); }));
    if (out.points.empty())
      throw InputError(fmt::format(
          "{}: reach = {} m: the closest pair is {:.6g} m apart. Raise it above that, or set contact.gap.",
          title(request), *request.reach, nearest.gap));
  }
  return out;
}

}  // namespace

Pairing pair(const PlacedBody& a, const PlacedBody& b, const PairRequest& request) {
  check_component(a, request.direction, request);
  check_component(b, request.direction, request);
  const Surface onto = surface_of(b);
  return arrange(a, request, round_off_of(surface_of(a), onto),
                 [&](const PlacedBody& moved) { return find_pairs(moved, onto, request.direction); });
}

Pairing pair(const PlacedBody& a, const HalfSpace& b, const PairRequest& request) {
  if (request.direction && request.direction->dot(-b.normal) < 1 - 1e-9)
    throw InputError(
        fmt::format("{}: direction = {}: against an obstacle contact acts along minus its normal. Leave "
                    "direction out, or set {}.",
                    title(request), text(*request.direction), text(-b.normal)));
  check_component(a, Vector3d(-b.normal), request);
  const Surface from = surface_of(a);
  const double round_off = round_off_of(from, from) + place_slack * b.point.cwiseAbs().maxCoeff();
  return arrange(a, request, round_off, [&](const PlacedBody& moved) { return find_pairs(moved, b); });
}

}  // namespace ricochet::contact
