// SPDX-License-Identifier: BSD-2-Clause
// The search for points that may touch, and bounds of the distances of bodies.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/stepping/moving_points.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// A summit is followed by a point that was nearer to it than this many elements; candidates as near stand
/// back.
constexpr double near_summit = 1.5;
/// Summits that are nearer to each other than this many elements are one.
constexpr double same_summit = 0.01;

}  // namespace

/// By how much a summit of a pair may be nearer than the candidates around it [m]. On a crease, it may be as
/// much nearer as the nearest candidate of the finer surface is away, as in the middle of an equilateral
/// triangle.
double MovingPoints::rise_of(const Model::PairBlock& pair) const noexcept {
  if (pair.summits == 0) return 0;
  const BodySurface &a = body(pair.a).shape(), &b = shape_of_b(pair);
  const bool a_is_finer = std::cmp_equal(pair.candidates_of_a, a.surface().node.size());
  const bool creased = !a.surface().crease.empty() || !b.surface().crease.empty();
  return a.camber() + b.camber() + (creased ? (a_is_finer ? a : b).largest_element() / std::sqrt(3.0) : 0);
}

/// By how much the elastic displacements may bring a point nearer [m].
double MovingPoints::swing_of(const Point& point, std::span<const Travel> travels) const noexcept {
  double out = 0;
  for (const End& end : point.end) {
    if (end.body < 0) continue;
    const MovingCandidates& candidates = body(end.body).candidates;
    const bool own = point.kind != Kind::creases && point.kind != Kind::summit && &end == &point.own();
    out += std::sqrt(2 * travels[static_cast<std::size_t>(end.body)].energy) *
           (own ? candidates.give(point.candidate) : candidates.largest_give());
  }
  return out;
}

/// Distance of the spheres around two bodies, or of one from the box around an obstacle [m].
double MovingPoints::apart(const Model::PairBlock& pair,
                           std::span<const FloatingBody> bodies) const noexcept {
  if (pair.solid) {
    const Side b = side_of_b(pair, bodies);
    const Vector3d x = b.place_of(Vector3d::Zero(), side(pair.a, bodies));
    return b.shape.box().exteriorDistance(x) - radius(pair.a) - body(pair.a).shape().camber() -
           b.shape.camber();
  }
  double out =
      (bodies[static_cast<std::size_t>(pair.a)].position - bodies[static_cast<std::size_t>(pair.b)].position)
          .norm();
  for (const int k : {pair.a, pair.b}) out -= radius(k) + body(k).shape().camber();
  return out;
}

/// Distance of the sphere around one body from the surface of the other, within or beside which it is; at
/// most 0 if they meet [m].
double MovingPoints::inside(const Model::PairBlock& pair,
                            std::span<const FloatingBody> bodies) const noexcept {
  const Side a = side(pair.a, bodies), b = side_of_b(pair, bodies);
  const auto beyond = [](const Side& own, double own_radius, const Side& other) {
    const Vector3d x = other.place_of(Vector3d::Zero(), own);
    const double way = (x - other.shape.closest(x).point).norm();
    return way - own_radius - own.shape.camber() - other.shape.camber();
  };
  const double of_a = beyond(a, radius(pair.a), b);
  return std::max({0.0, of_a, pair.solid ? of_a : beyond(b, radius(pair.b), a)});
}

/// Distance of the sphere around a body from a half-space [m].
double MovingPoints::above(const Model::PairBlock& pair, const FloatingBody& state) const noexcept {
  const Point& any = points_[static_cast<std::size_t>(pair.first_point)];
  return any.gap - any.row.row(0).dot(state.position - any.initial) + drive_of(pair).raise - radius(pair.a) -
         body(pair.a).shape().camber();
}

/// By how much the elastic displacements of two bodies may bring them nearer [m].
double MovingPoints::swing_of(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept {
  double out = 0;
  for (const int k : {pair.a, pair.b})
    if (k >= 0)
      out += std::sqrt(2 * travels[static_cast<std::size_t>(k)].energy) * body(k).candidates.largest_give();
  return out;
}

/// Largest distance at which the points of two bodies may touch within the travels [m].
double MovingPoints::margin(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept {
  return swing_of(pair, travels) + travels[static_cast<std::size_t>(pair.a)].distance +
         (pair.b < 0 ? drive_of(pair).travel : travels[static_cast<std::size_t>(pair.b)].distance);
}

double MovingPoints::clearance(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                               std::span<const Travel> energies) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  const FloatingBody& of_a = bodies[static_cast<std::size_t>(pair.a)];
  if (pair.is_half_space()) {
    for (int i = pair.first_point; i < pair.first_point + pair.candidates_of_a; ++i) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      least = std::min(least, height(point, of_a) - swing_of(point, energies));
    }
    return least - body(pair.a).shape().camber();
  }
  const double swing = swing_of(pair, energies), spheres = apart(pair, bodies);
  if (spheres > swing) return spheres - swing;
  if (const double within = inside(pair, bodies); within > swing) return within - swing;
  // A point of a face is at most as far from its nearest candidate as that of an equilateral triangle. Over
  // an obstacle, all candidates of a are points.
  double facet = 0;
  Vector3d out_of_a = Vector3d::Zero();
  for (const int k : {pair.a, pair.b})
    if (k >= 0) facet = std::max(facet, body(k).shape().largest_element() / std::sqrt(3.0));
  for (int i = pair.first_point; i < pair.first_point + pair.candidates(); ++i) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    const Side own = side(point.own(), bodies), other = side(point.other(), bodies);
    const Vector3d x = other.place_of(point.place, own);
    if (other.shape.box().exteriorDistance(x) >= least) continue;
    const Foot foot = other.shape.closest(x, least + other.shape.camber());
    if (foot.element < 0 || std::abs(foot.distance) >= least) continue;
    least = std::abs(foot.distance);
    out_of_a = (point.kind == Kind::candidate_of_a ? 1 : -1) * (other.state.axes * (foot.point - x));
  }
  if (const double length = out_of_a.norm(); length > 0)
    return std::max(least - facet, gap_along(pair, bodies, out_of_a / length)) - swing;
  return least - facet - swing;
}

/// How far two bodies are apart along a unit direction out of a, whatever their shapes between their nodes;
/// negative if no plane across it separates them [m].
double MovingPoints::gap_along(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                               const Vector3d& n) const noexcept {
  double gap = 0;
  for (const double sign : {1.0, -1.0}) {
    const Side one = sign > 0 ? side(pair.a, bodies) : side_of_b(pair, bodies);
    const Vector3d outward = sign * (one.state.axes.transpose() * n);
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vector3d& x : one.shape.surface().node)
      farthest = std::max(farthest, outward.dot(x - one.centre));
    gap -= farthest + one.shape.camber() + sign * n.dot(one.state.position);
  }
  return gap;
}

void MovingPoints::watch(int number) noexcept {
  watched_.push_back(number);
  is_watched_[static_cast<std::size_t>(number)] = true;
}

void MovingPoints::watch_none() noexcept {
  std::fill(travelled_.begin(), travelled_.end(), std::numeric_limits<double>::infinity());
  unwatch();
}

void MovingPoints::unwatch() noexcept {
  for (const int i : watched_) is_watched_[static_cast<std::size_t>(i)] = false;
  watched_.clear();
  near_.clear();
}

void MovingPoints::watch(std::span<const FloatingBody> bodies, std::span<const Travel> travels,
                         const MeanForce& forces) noexcept {
  unwatch();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Model::PairBlock& pair = pairs_[k];
    if (!is_live(pair, bodies)) continue;
    if (!pair.is_half_space()) {
      const double reach = margin(pair, travels);
      double away = apart(pair, bodies);
      if (away < reach && !forces.pairs()[k].carries) away = std::max(away, inside(pair, bodies));
      const bool is_far = away >= reach && !forces.pairs()[k].carries;
      if (!is_far || far_[k] < 0) {
        find_feet(static_cast<int>(k), bodies, reach, forces);
        find_crossings(static_cast<int>(k), bodies, reach, forces);
        find_summits(static_cast<int>(k), bodies, reach, forces);
      }
      far_[k] = is_far ? away : -1;
      travelled_[k] = is_far ? std::numeric_limits<double>::infinity() : reach - swing_of(pair, travels);
      continue;
    }
    const auto& [energy, distance] = travels[static_cast<std::size_t>(pair.a)];
    const FloatingBody& state = bodies[static_cast<std::size_t>(pair.a)];
    const double travel = distance + drives_[k].travel,
                 reach = travel + std::sqrt(2 * energy) * body(pair.a).candidates.largest_give();
    if (above(pair, state) >= reach && !forces.pairs()[k].carries) continue;
    for (int i = pair.first_point; i < pair.first_point + pair.candidates_of_a; ++i) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      if (height(point, state) - swing_of(point, travels) < travel || has_force(i, forces)) watch(i);
    }
    find_summits(static_cast<int>(k), bodies, reach, forces);
  }
  drop_members();
}

int MovingPoints::reached(std::span<const FloatingBody> bodies) const noexcept {
  for (const int i : watched_)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      if (end.body >= 0 && bodies[static_cast<std::size_t>(end.body)].asleep) return end.body;
  return -1;
}

/// Finds what the candidates of a pair meet, except those that were so far away at the last search that they
/// cannot be near.
/// @param margin  largest distance at which they may touch before the next search [m]
void MovingPoints::find_feet(int number, std::span<const FloatingBody> bodies, double margin,
                             const MeanForce& forces) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  const double spheres = apart(pair, bodies), reach = margin + rise_of(pair),
               travelled = travelled_[static_cast<std::size_t>(number)];
  for (int i = pair.first_point; i < pair.first_point + pair.candidates(); ++i) {
    Point& point = points_[static_cast<std::size_t>(i)];
    const bool pressed = has_force(i, forces);
    point.distance = std::max(spheres, std::abs(point.distance) - travelled);
    if (point.distance < reach || pressed) {
      const Side own = side(point.own(), bodies), other = side(point.other(), bodies);
      const Vector3d x = other.place_of(point.place, own);
      const double slide = 2 * point.spread;  // along its creases, at most
      point.distance = other.shape.box().exteriorDistance(x) - slide;
      if (point.distance < reach || pressed) {
        const Foot foot = other.shape.closest(
            x, pressed ? std::numeric_limits<double>::infinity() : reach + slide, point.foot.element);
        point.distance = reach;
        if (foot.element >= 0) point.meet(foot, own, other);
        if (std::abs(point.distance) < margin || pressed) watch(i);
      }
    }
    if (!is_watched_[static_cast<std::size_t>(i)]) u_(i) = point.gap - std::abs(point.distance);
  }
}

/// Lists the summits of a pair, those that are nearest to what they meet first.
/// @param margin  largest distance at which they may touch before the next search [m]
void MovingPoints::list_summits(int number, std::span<const FloatingBody> bodies, double margin) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  const Side own = side(pair.a, bodies);
  Point summit = points_[static_cast<std::size_t>(pair.first_summit())];
  summits_.clear();
  if (pair.is_half_space()) {
    const Vector3d n = own.state.axes.transpose() * summit.row.row(0).transpose();
    // height = g − n·(c + A (X − centre) − initial) + raise
    const double at_centre = summit.gap - summit.row.row(0).dot(own.state.position - summit.initial) +
                             drive_of(pair).raise + n.dot(own.centre);
    own.shape.summits(n, at_centre - margin, tops_);
    for (const Foot& top : tops_) {
      summit.stand_on(top, own);
      summits_.push_back(summit);
    }
    return;
  }
  const Side other = side_of_b(pair, bodies);
  const double reach = margin + rise_of(pair);
  const auto is_curved = [](const Side& of, const Foot& foot) {
    return of.shape.surface().element[static_cast<std::size_t>(foot.element)].curved;
  };
  for (int i = pair.first_point; i < pair.first_point + pair.candidates(); ++i) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    if (!(std::abs(point.distance) < reach) || point.foot.element < 0 || summits_.size() == most_found)
      continue;
    if (!is_nearest(point)) continue;
    const Side& of = point.kind == Kind::candidate_of_a ? own : other;
    const Foot here = of.shape.closest(point.place + of.centre);
    summit.top = point.kind == Kind::candidate_of_a ? here : point.foot;
    summit.foot = point.kind == Kind::candidate_of_a ? point.foot : here;
    summit.face(own, other);
    if (summit.open || !(std::abs(summit.distance) < margin) ||
        !(is_curved(own, summit.top) || is_curved(other, summit.foot)))
      continue;
    const bool known = std::any_of(summits_.begin(), summits_.end(), [&](const Point& one) {
      return (one.place - summit.place).norm() < same_summit * own.shape.element_size(summit.top);
    });
    if (!known) summits_.push_back(summit);
  }
  std::sort(summits_.begin(), summits_.end(),
            [](const Point& one, const Point& two) { return one.distance < two.distance; });
}

/// Whether no candidate around one is nearer to the other body.
bool MovingPoints::is_nearest(const Point& point) const noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(point.pair)];
  const std::vector<int>& numbers =
      point_of_[static_cast<std::size_t>(point.pair)][point.kind == Kind::candidate_of_b ? 1 : 0];
  const BodySurface& own = point.kind == Kind::candidate_of_b ? shape_of_b(pair) : body(pair.a).shape();
  return std::ranges::none_of(own.around(point.candidate), [&](int beside) {
    const int number = numbers[static_cast<std::size_t>(beside)];
    return number >= 0 &&
           std::abs(points_[static_cast<std::size_t>(number)].distance) < std::abs(point.distance);
  });
}

/// Finds the summits of a pair, and gives them to points: to those that stood nearby, then to others. Lists
/// the candidates near them.
void MovingPoints::find_summits(int number, std::span<const FloatingBody> bodies, double margin,
                                const MeanForce& forces) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  if (pair.summits == 0) return;
  list_summits(number, bodies, margin);
  for (const bool follow : {true, false})
    for (int i = pair.first_summit(); i < pair.first_summit() + pair.summits; ++i) {
      Point& point = points_[static_cast<std::size_t>(i)];
      if (is_watched_[static_cast<std::size_t>(i)]) continue;
      const bool pressed = has_force(i, forces);
      const double near = near_summit * smallest_element(point);
      const auto found = std::find_if(summits_.begin(), summits_.end(), [&](const Point& one) {
        return !follow || (!point.open && (one.place - point.place).norm() < near);
      });
      if (found != summits_.end() && (follow || !pressed)) {
        point.top = found->top;
        point.foot = found->foot;
        follow_summit(point, bodies);
        point.open = false;
        summits_.erase(found);
        watch(i);
        list_near(i, bodies, near_summit * smallest_element(point));
      } else if (!follow) {
        point.open = true;
        if (pressed) watch(i);
        u_(i) = point.gap - std::min(margin, body(pair.a).shape().largest_element());
      }
    }
}

/// Lists the candidates near a summit, and finds what they meet.
void MovingPoints::list_near(int number, std::span<const FloatingBody> bodies, double near) noexcept {
  const Point& summit = points_[static_cast<std::size_t>(number)];
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(summit.pair)];
  for (int i = pair.first_point; i < pair.first_point + pair.candidates(); ++i) {
    Point& point = points_[static_cast<std::size_t>(i)];
    if (!(square_way(point, summit) < near * near)) continue;
    if (near_.size() < near_.capacity()) near_.push_back({i, number});
    if (pair.is_half_space() || is_watched_[static_cast<std::size_t>(i)]) continue;
    const Side own = side(point.own(), bodies), other = side(point.other(), bodies);
    const Foot foot = other.shape.closest(other.place_of(point.place, own),
                                          std::abs(summit.distance) + near + other.shape.camber());
    if (foot.element >= 0) point.meet(foot, own, other);
  }
}

/// Finds the creases of a pair that cross, and gives them to points: to those that have crossed nearby, then
/// to others.
void MovingPoints::find_crossings(int number, std::span<const FloatingBody> bodies, double margin,
                                  const MeanForce& forces) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  const int first = pair.first_point + pair.candidates(), end = pair.first_summit();
  if (first == end) return;
  const Side a = side(pair.a, bodies), b = side_of_b(pair, bodies);
  const std::vector<WorldSurface::Crease>&of_a = a.shape.surface().crease, &of_b = b.shape.surface().crease;
  const auto node = [](const Side& of, const WorldSurface::Crease& crease, std::size_t k) {
    return of.shape.surface().node[static_cast<std::size_t>(crease.node[k])];
  };
  crossings_.clear();
  Point probe = points_[static_cast<std::size_t>(first)];
  for (int i = 0; i < static_cast<int>(of_a.size()); ++i) {
    const WorldSurface::Crease& one = of_a[static_cast<std::size_t>(i)];
    const Vector3d p0 = b.place_of(node(a, one, 0) - a.centre, a),
                   p1 = b.place_of(node(a, one, 1) - a.centre, a), middle = (p0 + p1) / 2;
    const double reach = margin + (p1 - p0).norm() / 2;
    if (!(b.shape.box().squaredExteriorDistance(middle) < reach * reach)) continue;
    for (int j = 0; j < static_cast<int>(of_b.size()); ++j) {
      const WorldSurface::Crease& two = of_b[static_cast<std::size_t>(j)];
      const Vector3d q0 = node(b, two, 0), q1 = node(b, two, 1);
      const double within = reach + (q1 - q0).norm() / 2;
      if ((middle - (q0 + q1) / 2).squaredNorm() > within * within) continue;
      if (!probe.cross(i, j, a, b) || !(std::abs(probe.distance) < margin)) continue;
      if (crossings_.size() < crossings_.capacity()) crossings_.push_back({i, j, probe.distance});
    }
  }
  std::sort(crossings_.begin(), crossings_.end(),
            [](const Crossing& one, const Crossing& other) { return one.distance < other.distance; });
  const auto share = [](const std::vector<WorldSurface::Crease>& creases, int one, int other) {
    if (one < 0 || other < 0) return false;
    for (const int x : creases[static_cast<std::size_t>(one)].node)
      for (const int y : creases[static_cast<std::size_t>(other)].node)
        if (x == y) return true;
    return false;
  };
  for (const bool follow : {true, false})
    for (int i = first; i < end; ++i) {
      Point& point = points_[static_cast<std::size_t>(i)];
      if (is_watched_[static_cast<std::size_t>(i)]) continue;
      const auto found = std::find_if(crossings_.begin(), crossings_.end(), [&](const Crossing& one) {
        if (one.of_a < 0) return false;
        return !follow || (share(of_a, one.of_a, point.crease[0]) && share(of_b, one.of_b, point.crease[1]));
      });
      const bool pressed = has_force(i, forces);
      if (found != crossings_.end() && (follow || !pressed)) {
        point.cross(found->of_a, found->of_b, a, b);
        found->of_a = -1;
        watch(i);
      } else if (!follow && pressed) {
        point.open = true;
        watch(i);
      } else if (!follow) {
        point.crease = {-1, -1};
        point.row.setZero();
        point.open = true;
        u_(i) = point.gap - margin;
      }
    }
}

}  // namespace ricochet::contact
