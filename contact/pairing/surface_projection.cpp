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

using Element = WorldSurface::Element;

/// c of an arc between two points with these normals.
Vector3d bend_of(const Vector3d& x0, const Vector3d& x1, const Vector3d& n0, const Vector3d& n1) {
  const Vector3d sum = n0 + n1, d = x1 - x0;
  const double length = sum.norm();
  if (!(length > 0.5)) return Vector3d::Zero();
  return (d.dot(n1) - d.dot(n0)) / (4 + 2 * length) * sum / length;
}

/// b of a curved triangle: the slopes D_j·m_j across the middles of its edges, with the derivative D_j
/// towards the opposite corner and the mean normal m_j of the edge, vanish in the mean of least squares. The
/// last term adds 27/4 b to D_j.
Vector3d bubble_of(const WorldSurface& of, const Element& element) {
  const Vector3d along = (element.normal[0] + element.normal[1] + element.normal[2]).normalized();
  double slope = 0, square = 0;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    const Vector3d middle = (of.node[element.corner[j]] + of.node[element.corner[k]]) / 2,
                   across = of.node[element.corner[l]] - middle - 2 * element.bend[j] + 2 * element.bend[k] +
                            2 * element.bend[l],
                   m = (element.normal[j] + element.normal[k]).normalized();
    const double lift = 27.0 / 4 * along.dot(m);
    slope += lift * across.dot(m);
    square += lift * lift;
  }
  return square > 1 ? Vector3d(-slope / square * along) : Vector3d::Zero();
}

/// Normals of one sheet at a node are equal bit by bit in a kernel; rotation adds round-off.
bool same_sheet(const Vector3d& n0, const Vector3d& n1) { return (n0 - n1).squaredNorm() < 1e-20; }

/// One element beside an edge, by its corners at the two nodes of the edge.
struct Beside {
  int element, first, second;  ///< index; corners at the lower and the higher node
};

/// Adds a crease unless it is hollow.
void add_crease(WorldSurface& to, const std::array<int, 2>& node, const std::array<Beside, 2>& beside) {
  WorldSurface::Crease crease{node, {}, Vector3d::Zero()};
  const Vector3d& x = to.node[node[0]];
  const Vector3d along = (to.node[node[1]] - x).normalized();
  std::array<Vector3d, 2> normal;
  for (int side = 0; side < 2; ++side) {
    const Element& element = to.element[beside[side].element];
    const int third = 3 - beside[side].first - beside[side].second;
    const Vector3d into = to.node[element.corner[third]] - x;
    normal[side] = (element.normal[beside[side].first] + element.normal[beside[side].second]).normalized();
    // The tangent of a curved face at the crease differs from the chord of its element.
    crease.into[side] = (into - into.dot(along) * along).normalized();
    crease.into[side] = (crease.into[side] - crease.into[side].dot(normal[side]) * normal[side]).normalized();
  }
  if (!(normal[0].dot(crease.into[1]) < 0)) return;
  crease.normal = (normal[0] + normal[1]).normalized();
  to.crease.push_back(crease);
}

}  // namespace

void bend_elements(WorldSurface& to) {
  std::vector<Vector3d> seen(to.node.size(), Vector3d::Zero());
  for (const Element& element : to.element)
    for (int j = 0; j < to.corners; ++j) {
      const int node = element.corner[j];
      if (seen[node].isZero(0))
        seen[node] = element.normal[j];
      else if (!same_sheet(seen[node], element.normal[j]))
        to.on_crease[node] = 1;
    }
  const auto bend = [&](const Beside& side) {
    const Element& element = to.element[side.element];
    return bend_of(to.node[element.corner[side.first]], to.node[element.corner[side.second]],
                   element.normal[side.first], element.normal[side.second]);
  };
  if (to.corners == 2) {
    for (int e = 0; e < static_cast<int>(to.element.size()); ++e) to.element[e].bend[0] = bend({e, 0, 1});
  } else if (to.corners == 3) {
    std::vector<std::pair<std::array<int, 2>, Beside>> edges;
    for (int e = 0; e < static_cast<int>(to.element.size()); ++e)
      for (int j = 0; j < 3; ++j) {
        const int k = (j + 1) % 3, p = to.element[e].corner[j], q = to.element[e].corner[k];
        edges.push_back({{std::min(p, q), std::max(p, q)}, p < q ? Beside{e, j, k} : Beside{e, k, j}});
      }
    std::stable_sort(edges.begin(), edges.end(), [](auto& a, auto& b) { return a.first < b.first; });
    for (std::size_t from = 0, end = 0; from < edges.size(); from = end) {
      while (end < edges.size() && edges[end].first == edges[from].first) ++end;
      const Beside &one = edges[from].second, &other = edges[end - 1].second;
      Vector3d c = bend(one);
      const Element &e = to.element[one.element], &f = to.element[other.element];
      if (end - from == 2 && !(same_sheet(e.normal[one.first], f.normal[other.first]) &&
                               same_sheet(e.normal[one.second], f.normal[other.second]))) {
        add_crease(to, edges[from].first, {one, other});
        // c·m = c_e·m for the mean normal m of either side
        const Vector3d d = bend(other), m = (e.normal[one.first] + e.normal[one.second]).normalized(),
                       n = (f.normal[other.first] + f.normal[other.second]).normalized();
        const double k = m.dot(n), p = c.dot(m), q = d.dot(n), left = 1 - k * k;
        c = left > 0.05 ? Vector3d(((p - k * q) * m + (q - k * p) * n) / left) : Vector3d((c + d) / 2);
      }
      for (std::size_t i = from; i < end; ++i) {
        const Beside& side = edges[i].second;
        const int j = side.first == (side.second + 1) % 3 ? side.second : side.first;
        to.element[side.element].bend[j] = c;
      }
    }
  }
  for (Element& element : to.element) {
    double most = 0;
    for (const Vector3d& c : element.bend) most = std::max(most, c.norm());
    element.curved = most > 1e-9 * element.size;
    if (element.curved && to.corners == 3) element.bubble = bubble_of(to, element);
  }
}

namespace {

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
    const Vector3d centroid =
        from.centroid.empty() ? own : Vector3d(Eigen::Map<const Vector3d>(&from.centroid[3 * i]));
    const Vector3d& n = to.normal.back();
    // Kernels of version 1 have the mean of the patch as its centroid.
    const bool of_mean = from.bulge.empty();
    to.crest.push_back(of_mean ? to.node.back() : Vector3d(body.rotation * centroid + body.translation));
    to.bulge.push_back(of_mean ? n.dot(body.rotation * (own - centroid)) : from.bulge[i]);
    box.extend(to.node.back());
    to.farthest = std::max({to.farthest, to.node.back().cwiseAbs().maxCoeff(), own.cwiseAbs().maxCoeff()});
  }
  if (!box.isEmpty()) to.extent = box.diagonal().norm();
  to.on_crease.assign(from.area.size(), 0);
  const std::size_t k = to.corners;
  for (std::size_t t = 0; t + k <= from.element.size(); t += k) {
    WorldSurface::Element element;
    for (std::size_t j = 0; j < k; ++j) element.corner[j] = static_cast<int>(from.element[t + j]);
    to.add(element);
    for (std::size_t j = 0; !from.element_normal.empty() && j < k; ++j)
      to.element.back().normal[j] =
          body.rotation * Eigen::Map<const Vector3d>(&from.element_normal[3 * (t + j)]);
  }
  if (!from.element_normal.empty()) bend_elements(to);
  return to;
}

/// The point with these weights, clipped to [0, 1]; no value if the normals at the corners cancel.
std::optional<Projection> projection(const WorldSurface& b, const Element& element,
                                     std::array<double, 3> weight) {
  Projection out{Vector3d::Zero(), Vector3d::Zero(), element.corner, weight,
                 static_cast<int>(&element - b.element.data())};
  double sum = 0;
  for (double& w : out.weight) sum += w = std::clamp(w, 0.0, 1.0);
  for (int j = 0; j < b.corners; ++j) {
    out.weight[j] /= sum;
    out.normal += out.weight[j] * element.normal[j];
  }
  out.point = b.at(element, out.weight);
  const double length = out.normal.norm();
  if (!(length > 1e-9)) return std::nullopt;
  out.normal /= length;
  return out;
}

/// Weights of a curved triangle at its intersection with the line x + t d, from those of the flat one, by
/// Newton's method on d × (x(u, v) − x) = 0; no value if the line grazes it.
std::optional<Eigen::Vector2d> intersection(const WorldSurface& b, const Element& element, const Vector3d& x,
                                            const Vector3d& d, Eigen::Vector2d uv) {
  const auto& c = element.bend;
  const Vector3d& p = b.node[element.corner[0]];
  const Vector3d e1 = b.node[element.corner[1]] - p, e2 = b.node[element.corner[2]] - p;
  constexpr int rounds = 12;
  for (int round = 0; round < rounds; ++round) {
    const double u = uv[0], v = uv[1], w = 1 - u - v;
    const Vector3d off = x - b.at(element, {w, u, v}), lift = 27 * element.bubble,
                   by_u = e1 + 4 * ((w - u) * c[0] + v * c[1] - v * c[2]) + v * (w - u) * lift,
                   by_v = e2 + 4 * (-u * c[0] + u * c[1] + (w - v) * c[2]) + u * (w - v) * lift,
                   normal = by_u.cross(by_v);
    const double determinant = normal.dot(d);
    if (std::abs(determinant) <= 1e-6 * normal.norm()) return std::nullopt;
    const Eigen::Vector2d step(off.dot(by_v.cross(d)) / determinant, off.dot(d.cross(by_u)) / determinant);
    uv += step;
    if (step.norm() < 1e-12) return uv;
    if (uv.norm() > 4) return std::nullopt;
  }
  return std::nullopt;
}

/// The intersection of the line x + t d with an element.
std::optional<Projection> intersection(const WorldSurface& b, const Element& element, const Vector3d& x,
                                       const Vector3d& d, double size) {
  const Vector3d& p = b.node[element.corner[0]];
  const auto across = [&](const Vector3d& v) -> Vector3d { return v - v.dot(d) * d; };
  if (b.corners == 1) {
    if (across(x - p).norm() > edge_slack * size) return std::nullopt;
    return projection(b, element, {1, 0, 0});
  }
  const double radius = radius_of(element);
  if (across(x - element.centre).squaredNorm() > radius * radius) return std::nullopt;
  const Vector3d r = x - p, e1 = b.node[element.corner[1]] - p;
  if (b.corners == 2) {
    const Vector3d tangent = across(e1);
    const double length = tangent.norm();
    if (length <= 1e-9 * element.size) return std::nullopt;
    double s = tangent.dot(r) / (length * length);
    // The tangential position of the curved segment is that of the chord plus 4 s (1 − s) times that of c.
    const double aside = tangent.dot(element.bend[0]) / (length * length), start = s;
    for (int round = 0; element.curved && round < 8; ++round) s = start - 4 * s * (1 - s) * aside;
    const double margin = std::min(edge_slack * element.size / length, 0.5);
    if (s < -margin || s > 1 + margin) return std::nullopt;
    if (across(x - b.at(element, {1 - s, s, 0})).norm() > 0.5 * element.size) return std::nullopt;
    return projection(b, element, {1 - s, s, 0});
  }
  // r + t d = u e1 + v e2
  const Vector3d e2 = b.node[element.corner[2]] - p;
  const Vector3d normal = e1.cross(e2);
  const double determinant = normal.dot(d);
  if (std::abs(determinant) <= 1e-9 * normal.norm()) return std::nullopt;
  double u = r.dot(e2.cross(d)) / determinant, v = r.dot(d.cross(e1)) / determinant;
  if (element.curved) {
    if (std::min({u, v, 1 - u - v}) < -1) return std::nullopt;
    const auto found = intersection(b, element, x, d, {u, v});
    if (!found) return std::nullopt;
    u = (*found)[0];
    v = (*found)[1];
  }
  const double margin = std::min(edge_slack * element.size * element.size / std::abs(determinant), 0.5);
  if (u < -margin || v < -margin || u + v > 1 + margin) return std::nullopt;
  return projection(b, element, {1 - u - v, u, v});
}

/// Takes the intersection of a line along d with a round element to the closed form, by Newton's method.
void take_to_form(const WorldSurface& b, const Vector3d& d, Projection& at) {
  constexpr int rounds = 12;
  for (int k = 0; k < rounds; ++k) {
    const auto exact = b.on_form(b.element[at.element], at.point);
    const double slope = exact ? exact->normal.dot(d) : 0;
    if (!(std::abs(slope) > 1e-3)) return;
    at.point -= exact->distance / slope * d;
    at.normal = exact->normal;
    if (std::abs(exact->distance) <= 1e-15 * b.farthest) return;
  }
}

/// Weights of the point of a triangle p, p + e1, p + e2 that is closest to x.
/// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5, by Voronoi regions.
std::array<double, 3> weights_in_triangle(const Vector3d& p, const Vector3d& e1, const Vector3d& e2,
                                          const Vector3d& x) {
  const Vector3d r = x - p;
  const double d1 = e1.dot(r), l1 = e1.squaredNorm();
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

/// The weights at which Σ a_j w_j + 4 Σ b_j w_j w_{j+1} + 27 c w_0 w_1 w_2 is largest in a triangle, by
/// comparing its critical points within the triangle, on its edges and at its corners.
std::array<double, 3> highest(const std::array<double, 3>& a, const std::array<double, 3>& b,
                              double c) noexcept {
  std::array<double, 3> best{};
  double most = -std::numeric_limits<double>::infinity();
  const auto offer = [&](const std::array<double, 3>& w) {
    double height = 27 * c * w[0] * w[1] * w[2];
    for (std::size_t j = 0; j < 3; ++j) height += w[j] * (a[j] + 4 * b[j] * w[(j + 1) % 3]);
    if (height <= most) return;
    most = height;
    best = w;
  };
  for (std::size_t j = 0; j < 3; ++j) {
    const std::size_t next = (j + 1) % 3;
    std::array<double, 3> w{};
    w[j] = 1;
    offer(w);
    const double along = b[j] > 0 ? 0.5 + (a[next] - a[j]) / (8 * b[j]) : 0;
    if (!(along > 0 && along < 1)) continue;
    w[j] = 1 - along;
    w[next] = along;
    offer(w);
  }
  // Newton's method for w = (1 − s − t, s, t), exact in the first round but for c, which is small.
  double s = 1.0 / 3, t = 1.0 / 3;
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    const double r = 1 - s - t, lift = 27 * c;
    const double by_s = a[1] - a[0] + 4 * (b[0] * (r - s) + (b[1] - b[2]) * t) + lift * t * (r - s),
                 by_t = a[2] - a[0] + 4 * ((b[1] - b[0]) * s + b[2] * (r - t)) + lift * s * (r - t),
                 ss = -8 * b[0] - 2 * lift * t, tt = -8 * b[2] - 2 * lift * s,
                 st = 4 * (b[1] - b[0] - b[2]) + lift * (r - s - t), area = ss * tt - st * st;
    if (!(ss < 0 && area > 0)) return best;
    const double ds = (st * by_t - tt * by_s) / area, dt = (st * by_s - ss * by_t) / area;
    s += ds;
    t += dt;
    if (std::max(std::abs(s - 0.5), std::abs(t - 0.5)) > 1) return best;
    if (std::abs(ds) + std::abs(dt) < 1e-15) break;
  }
  if (s > 0 && t > 0 && s + t < 1) offer({1 - s - t, s, t});
  return best;
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

std::array<double, 3> closest_weights(const WorldSurface& b, const Element& element, const Vector3d& x) {
  const Vector3d& p = b.node[element.corner[0]];
  if (b.corners == 1) return {1, 0, 0};
  const Vector3d e1 = b.node[element.corner[1]] - p;
  if (b.corners == 3) return weights_in_triangle(p, e1, b.node[element.corner[2]] - p, x);
  const double s = e1.squaredNorm() > 0 ? std::clamp(e1.dot(x - p) / e1.squaredNorm(), 0.0, 1.0) : 0;
  return {1 - s, s, 0};
}

/// The drop is that of the chords.
std::array<double, 3> highest_weights(const WorldSurface& surface, const Element& element,
                                      const Height& height) noexcept {
  std::array<double, 3> a{}, b{};
  for (int j = 0; j < 3; ++j) {
    const Vector3d &x = surface.node[element.corner[j]], &next = surface.node[element.corner[(j + 1) % 3]];
    a[j] = height.up.dot(x - element.centre) - height.drop(x);
    b[j] = height.up.dot(element.bend[j]) + (next - x).dot(height.curvature * (next - x)) / 8;
  }
  return highest(a, b, height.up.dot(element.bubble));
}

double radius_of(const Element& element) {
  double bend = 0;
  for (const Vector3d& c : element.bend) bend += c.norm();
  return element.size * (1 + edge_slack) + bend + element.bubble.norm();
}

double smallest_element(const WorldSurface& surface) {
  double least = std::numeric_limits<double>::infinity();
  for (const WorldSurface::Element& element : surface.element) least = std::min(least, element.size);
  return least;
}

double square_distance(const Vector3d& x, const std::array<Vector3d, 3>& triangle) {
  const auto w = weights_in_triangle(triangle[0], triangle[1] - triangle[0], triangle[2] - triangle[0], x);
  return (w[0] * triangle[0] + w[1] * triangle[1] + w[2] * triangle[2] - x).squaredNorm();
}

void WorldSurface::add(Element of_corners) {
  for (int j = 0; j < corners; ++j) {
    of_corners.centre += node[of_corners.corner[j]] / static_cast<double>(corners);
    for (int i = 0; i < j; ++i)
      of_corners.size =
          std::max(of_corners.size, (node[of_corners.corner[i]] - node[of_corners.corner[j]]).norm());
  }
  for (int j = 0; j < corners; ++j) of_corners.normal[j] = normal[of_corners.corner[j]];
  for (Vector3d& c : of_corners.bend) c.setZero();
  for (int j = corners; j < 3; ++j) of_corners.normal[j].setZero();
  element.push_back(of_corners);
}

Vector3d WorldSurface::at(const Element& on, const std::array<double, 3>& weight) const {
  Vector3d out = Vector3d::Zero();
  for (int j = 0; j < corners; ++j) out += weight[j] * node[on.corner[j]];
  if (on.curved) {
    for (int j = 0; j < (corners == 3 ? 3 : 1); ++j) out += 4 * weight[j] * weight[(j + 1) % 3] * on.bend[j];
    out += 27 * weight[0] * weight[1] * weight[2] * on.bubble;
  }
  return out;
}

Eigen::Matrix3d WorldSurface::curvature(const Element& on, const Vector3d& point) const noexcept {
  if (on.round) return round->closest(point).curvature;
  if (!on.curved) return Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> edges, turns;
  for (int j = 0; j < 2; ++j) {
    edges.col(j) = node[on.corner[j + 1]] - node[on.corner[0]];
    turns.col(j) = on.normal[j + 1] - on.normal[0];
  }
  const Eigen::Matrix3d W = turns * (edges.transpose() * edges).inverse() * edges.transpose();
  return 0.5 * (W + W.transpose());
}

std::optional<RoundSurface::At> WorldSurface::on_form(const Element& on, const Vector3d& x) const noexcept {
  if (!on.round) return std::nullopt;
  const RoundSurface::At out = round->closest(x);
  if (round->form == RoundSurface::Form::cone &&
      std::abs(round->axes.col(2).dot(out.point - round->origin)) > round->length / 2)
    return std::nullopt;
  return out;
}

double bulge_under(double area, const Eigen::Matrix3d& curvature) noexcept {
  return area * curvature.trace() / (8 * std::sqrt(3.0));
}

WorldSurface placed(const Obstacle& obstacle) {
  WorldSurface out = *obstacle.surface;
  const auto move = [&](Vector3d& x) { x = obstacle.rotation * x + obstacle.point; };
  const auto turn = [&](Vector3d& x) { x = obstacle.rotation * x; };
  for (Vector3d& x : out.node) {
    move(x);
    out.farthest = std::max(out.farthest, x.cwiseAbs().maxCoeff());
  }
  for (Vector3d& x : out.crest) move(x);
  for (Vector3d& n : out.normal) turn(n);
  for (Element& on : out.element) {
    move(on.centre);
    for (Vector3d& n : on.normal) turn(n);
    for (Vector3d& c : on.bend) turn(c);
    turn(on.bubble);
  }
  for (WorldSurface::Crease& crease : out.crease) {
    for (Vector3d& way : crease.into) turn(way);
    turn(crease.normal);
  }
  if (out.round) {
    out.round->axes = obstacle.rotation * out.round->axes;
    move(out.round->origin);
  }
  return out;
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
  for (const Element& element : surface_.element) {
    const Vector3d radius = Vector3d::Constant(radius_of(element));
    box.emplace_back(element.centre - radius, element.centre + radius);
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
        auto found = intersection(surface_, surface_.element[element], x, d, size);
        if (found) take_to_form(surface_, d, *found);
        if (!found || !faces(*found)) return std::nullopt;
        return std::pair(*found, std::abs(d.dot(found->point - x)));
      });
  Eigen::BVMinimize(elements_, nearest);
  return nearest.projection;
}

std::optional<Projection> SurfaceProjection::closest(const Vector3d& x, double within) const {
  Nearest nearest(
      [&](const Eigen::AlignedBox3d& box) {
        const double least = box.exteriorDistance(x);
        return least <= within ? least : none;
      },
      [&](int element) -> std::optional<std::pair<Projection, double>> {
        const Element& on = surface_.element[element];
        auto found = projection(surface_, on, closest_weights(surface_, on, x));
        if (!found) return std::nullopt;
        if (const auto exact = surface_.on_form(on, x)) {
          found->point = exact->point;
          found->normal = exact->normal;
        }
        const double distance = (found->point - x).norm();
        if (distance > within) return std::nullopt;
        return std::pair(*found, distance);
      });
  Eigen::BVMinimize(elements_, nearest);
  return nearest.projection;
}

std::optional<std::pair<Projection, Vector3d>> SurfaceProjection::along_mutual_normal(const Vector3d& x,
                                                                                      const Vector3d& n_a,
                                                                                      bool on_crease,
                                                                                      double size) const {
  const auto mutual = [&](const Projection& y) -> Vector3d {
    return on_crease ? Vector3d(-y.normal) : Vector3d((n_a - y.normal).normalized());
  };
  const auto faces = [&](const Projection& y) { return n_a.dot(y.normal) < 0; };
  auto y = closest(x);
  if (!y || !faces(*y)) return std::nullopt;
  Vector3d n = mutual(*y);
  double change = 0;
  bool met = false;
  for (int round = 0; round < 20; ++round) {
    const double gap = n.dot(y->point - x);
    auto found = first_along(x, n, size, faces);
    met = found.has_value();
    if (!met) found = closest(x + gap * n);
    if (!found || !faces(*found)) return std::nullopt;
    y = found;
    const Vector3d next = mutual(*y);
    change = (next - n).norm();
    if (change < settled) break;
    n = next;
  }
  if (!met || change > settled_enough) return std::nullopt;
  return std::pair(*y, n);
}

}  // namespace ricochet::contact
