// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/moving_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Points join if they are nearer than this many times the largest free approach of their bodies in the step,
/// since contact may reverse their motion within it.
constexpr double approaches = 3;

/// A point may touch along a normal towards which its surface rises by less than this sine: half a right
/// angle more than the facets of a smooth face.
constexpr double most_rise = 0.5;
/// The same for the faces beside creases, whose normals are exact.
constexpr double most_rise_at_crease = 1e-3;

/// A candidate of b over this share of one of a is left to that one, if that one may touch b.
constexpr double same_place = 0.98;

/// Creases may cross beyond their ends by this share of their lengths, so that none slips between two.
constexpr double beyond_end = 1e-3;

/// A point begins to touch at a depth of at most this share of an element.
constexpr double near_surface = 1e-3;

/// A crossing of creases that is deeper than this share of them is on the far side of a body.
constexpr double deepest_crossing = 0.25;

[[noreturn]] void refuse(const Model& model, const Rows::PairBlock& pair, const char* why) {
  throw InputError(base::format("contact between \"{}\" and \"{}\": {}", model.bodies[pair.a].name,
                                pair.b < 0 ? pair.obstacle : model.bodies[pair.b].name, why));
}

void check(const Model& model, const Rows::PairBlock& pair) {
  for (const int k : {pair.a, pair.b}) {
    if (k < 0) continue;
    const kernels::Surface& surface = model.bodies[static_cast<std::size_t>(k)].kernel->surface;
    if (surface.components != 3 || surface.normal_residual || surface.whole)
      refuse(model, pair,
             "motion.rotation = \"finite\" needs kernels with all candidates in all components. Compute them "
             "for this scene with ricochet-kernel.");
    if (pair.b >= 0 && surface.element_corners != 3)
      refuse(model, pair,
             "with motion.rotation = \"finite\", bodies meet with their surfaces, but a kernel holds points "
             "alone. Compute it for this scene with ricochet-kernel.");
  }
}

/// From the centre of `there`, in its axes, to the end of an arm of another body, in the axes of that one.
Vector3d seen_from(const FloatingBody& there, const FloatingBody& other, const Vector3d& arm) {
  return there.attitude.conjugate() * (other.position + other.attitude * arm - there.position);
}

Matrix3d attitude_of(std::span<const FloatingBody> bodies, int k) {
  return bodies[static_cast<std::size_t>(k)].attitude.toRotationMatrix();
}

}  // namespace

MovingPoints::Body::Body(const Bodies::Block& block, const Vector3d& gravity)
    : surface(&block.kernel->surface),
      shape(*block.kernel),
      centre(block.own_centre()),
      modes(block.modes),
      elastic(block.modes - block.frame_modes()),
      first_elastic(block.first_mode + block.frame_modes()),
      in_modes(static_cast<Index>(block.kernel->surface.size())),
      residual(static_cast<Index>(block.kernel->surface.size())) {
  const std::size_t M = surface->size();
  if (const std::vector<double>& settling = block.kernel->loads.body_force_residual;
      block.supported && !settling.empty())
    for (std::size_t i = 0; i < M; ++i)
      settled.push_back(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&settling[9 * i]) *
                        (block.rotation.transpose() * gravity));
  for (std::vector<Vector3d>* x : {&w, &dw}) x->assign(M, Vector3d::Zero());
  for (std::vector<std::int64_t>* x : {&w_at, &dw_at}) x->assign(M, -1);
  number_of.assign(M, -1);
  used.assign(M, 0);
  joined.reserve(M);
  for (std::size_t i = 0; i < M; ++i)
    radius = std::max(
        {radius, (shape.surface().node[i] - centre).norm(), (shape.surface().crest[i] - centre).norm()});
}

MovingPoints::MovingPoints(const Model& model, const StepSystem& system)
    : c_(system.c),
      folded_(Vector::Zero(model.omega.size())),
      pairs_(model.pairs),
      M_(model.rows()),
      R_(model.rows()),
      S_(model.rows()),
      S_mean_(model.rows()) {
  for (const int n : model.folded.modes) folded_(n) = 1 / (model.omega(n) * model.omega(n));
  folds_ = !model.folded.modes.empty();
  bodies_.reserve(model.bodies.size());  // copies would lose the reserve of their lists
  for (const Bodies::Block& block : model.bodies) {
    Body& body = bodies_.emplace_back(block, model.gravity);
    const auto omega = model.omega.segment(body.first_elastic, body.elastic).transpose().array();
    for (int i = 0; i < static_cast<int>(body.surface->size()); ++i) {
      double give = (body.shape_of(i).colwise().squaredNorm().array() / omega.square()).sum();
      if (body.yields()) give += body.flexibility(i, i).trace();
      body.give.push_back(std::sqrt(give));
      body.largest_give = std::max(body.largest_give, body.give.back());
    }
  }
  const auto m = static_cast<std::size_t>(model.points()), n = static_cast<std::size_t>(model.rows());
  points_.resize(m);
  is_watched_.assign(m, false);
  member_of_.assign(m, -1);
  for (std::vector<int>* x : {&watched_, &members_, &tangents_at_}) x->reserve(m);
  for (std::vector<int>* x : {&rows_, &owner_, &along_}) x->reserve(n);
  crossings_.reserve(m);
  forced_.reserve(6 * m);
  for (Vector* x : {&start_, &free_, &u_}) x->setZero(model.rows());
  for (int pair = 0; pair < static_cast<int>(model.pairs.size()); ++pair) {
    check(model, model.pairs[static_cast<std::size_t>(pair)]);
    add_points(model, pair);
  }
  for (const Rows::FrictionPoint& rubs : model.friction) {
    Point& point = points_[static_cast<std::size_t>(rubs.point)];
    point.tangential = rubs.tangential;
    if (point.kind == Kind::obstacle)
      point.row.bottomRows<2>() = model.tangent.middleRows<2>(rubs.tangential - model.points());
  }
}

void MovingPoints::add_points(const Model& model, int number) {
  const Rows::PairBlock& pair = model.pairs[static_cast<std::size_t>(number)];
  point_of_a_.emplace_back(pair.b < 0 ? 0 : body(pair.a).surface->size(), -1);
  for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
    Point& point = points_[static_cast<std::size_t>(i)];
    point.pair = number;
    point.gap = model.gap(i);
    point.end[0].body = pair.a;
    point.end[1].body = pair.b;
    const int within = i - pair.first_point;
    if (pair.b >= 0)
      point.kind = within < pair.candidates_of_a                          ? Kind::candidate_of_a
                   : within < pair.candidates_of_a + pair.candidates_of_b ? Kind::candidate_of_b
                                                                          : Kind::creases;
    if (point.kind == Kind::creases) continue;
    const int own = point.kind == Kind::candidate_of_b ? pair.b : pair.a;
    const Selection::InnerIterator entry(model.selection[static_cast<std::size_t>(own)], i);
    point.candidate = static_cast<int>(entry.col()) / 3;
    point.place =
        body(own).shape.surface().crest[static_cast<std::size_t>(point.candidate)] - body(own).centre;
    End& end = point.end[static_cast<std::size_t>(point.own())];
    end.count = 1;
    end.candidate[0] = point.candidate;
    end.weight[0] = 1;
    if (point.kind == Kind::candidate_of_a)
      point_of_a_[static_cast<std::size_t>(number)][static_cast<std::size_t>(point.candidate)] = i;
    if (point.kind != Kind::obstacle) continue;
    point.open = false;
    point.initial = model.point_a.row(i).transpose();
    point.row.row(0) = model.normal.row(i);
  }
}

/// Distance of a point from the half-space, without its elastic displacement [m].
double MovingPoints::height(const Point& point, const FloatingBody& state) const noexcept {
  return point.gap - point.row.row(0).dot(state.position + state.attitude * point.place - point.initial);
}

/// By how much the elastic displacements may bring a point nearer [m].
double MovingPoints::swing_of(const Point& point, std::span<const Travel> travels) const noexcept {
  double out = 0;
  for (int k = 0; k < 2; ++k) {
    const int number = point.end[static_cast<std::size_t>(k)].body;
    if (number < 0) continue;
    const bool own = point.kind != Kind::creases && k == point.own();
    const double give =
        own ? body(number).give[static_cast<std::size_t>(point.candidate)] : body(number).largest_give;
    out += std::sqrt(2 * travels[static_cast<std::size_t>(number)].energy) * give;
  }
  return out;
}

/// Distance of the spheres around two bodies [m].
double MovingPoints::apart(const Model::PairBlock& pair,
                           std::span<const FloatingBody> bodies) const noexcept {
  return (bodies[static_cast<std::size_t>(pair.a)].position -
          bodies[static_cast<std::size_t>(pair.b)].position)
             .norm() -
         radius(pair.a) - radius(pair.b);
}

/// By how much the elastic displacements of two bodies may bring them nearer [m].
double MovingPoints::swing_of(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept {
  double out = 0;
  for (const int k : {pair.a, pair.b})
    out += std::sqrt(2 * travels[static_cast<std::size_t>(k)].energy) * body(k).largest_give;
  return out;
}

/// Largest distance at which the points of two bodies may touch within the travels [m].
double MovingPoints::margin(const Model::PairBlock& pair, std::span<const Travel> travels) const noexcept {
  return swing_of(pair, travels) + travels[static_cast<std::size_t>(pair.a)].distance +
         travels[static_cast<std::size_t>(pair.b)].distance;
}

double MovingPoints::clearance(const Model::PairBlock& pair, std::span<const FloatingBody> bodies,
                               std::span<const Travel> energies) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  const FloatingBody& of_a = bodies[static_cast<std::size_t>(pair.a)];
  if (pair.b < 0) {
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      least = std::min(least, height(point, of_a) - swing_of(point, energies));
    }
    return least;
  }
  const double swing = swing_of(pair, energies), spheres = apart(pair, bodies);
  if (spheres > swing) return spheres - swing;
  // A point of a face is at most as far from its nearest candidate as that of an equilateral triangle.
  double facet = 0;
  for (const int k : {pair.a, pair.b}) facet = std::max(facet, body(k).shape.element_size() / std::sqrt(3.0));
  for (int i = pair.first_point; i < pair.first_point + pair.candidates_of_a + pair.candidates_of_b; ++i) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    const int own = point.end[static_cast<std::size_t>(point.own())].body,
              other = point.end[static_cast<std::size_t>(point.other())].body;
    const FloatingBody &state = bodies[static_cast<std::size_t>(own)],
                       &there = bodies[static_cast<std::size_t>(other)];
    const Vector3d x = seen_from(there, state, point.place) + body(other).centre;
    if (body(other).shape.box().exteriorDistance(x) >= least) continue;
    least = std::min(least, std::abs(body(other).shape.closest(x).distance));
  }
  return least - facet - swing;
}

void MovingPoints::watch(int number) noexcept {
  watched_.push_back(number);
  is_watched_[static_cast<std::size_t>(number)] = true;
}

void MovingPoints::watch(std::span<const FloatingBody> bodies, std::span<const Travel> travels,
                         const MeanForce& forces) noexcept {
  std::fill(is_watched_.begin(), is_watched_.end(), false);
  watched_.clear();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Model::PairBlock& pair = pairs_[k];
    if (pair.b >= 0) {
      find_feet(static_cast<int>(k), bodies, margin(pair, travels), forces);
      find_crossings(static_cast<int>(k), bodies, margin(pair, travels), forces);
      continue;
    }
    const double distance = travels[static_cast<std::size_t>(pair.a)].distance;
    const FloatingBody& state = bodies[static_cast<std::size_t>(pair.a)];
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      if (height(point, state) - swing_of(point, travels) < distance || has_force(i, forces)) watch(i);
    }
  }
  drop_members();
}

/// Finds what the candidates of a pair meet.
/// @param margin  largest distance at which they may touch before the next search [m]
void MovingPoints::find_feet(int number, std::span<const FloatingBody> bodies, double margin,
                             const MeanForce& forces) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  const double spheres = apart(pair, bodies);
  for (int i = pair.first_point; i < pair.first_point + pair.candidates_of_a + pair.candidates_of_b; ++i) {
    Point& point = points_[static_cast<std::size_t>(i)];
    const bool pressed = has_force(i, forces);
    point.distance = spheres;
    if (spheres < margin || pressed) {
      const int own = point.end[static_cast<std::size_t>(point.own())].body,
                other = point.end[static_cast<std::size_t>(point.other())].body;
      const FloatingBody &state = bodies[static_cast<std::size_t>(own)],
                         &there = bodies[static_cast<std::size_t>(other)];
      const BodySurface& surface = body(other).shape;
      const Vector3d x = seen_from(there, state, point.place) + body(other).centre;
      point.distance = surface.box().exteriorDistance(x);
      if (point.distance < margin || pressed) {
        meet(point, surface.closest(x), bodies);
        if (std::abs(point.distance) < margin || pressed) watch(i);
      }
    }
    if (!is_watched_[static_cast<std::size_t>(i)]) u_(i) = point.gap - std::abs(point.distance);
  }
}

/// Finds the creases of a pair that cross, and gives them to points: to those that have crossed nearby, then
/// to others.
void MovingPoints::find_crossings(int number, std::span<const FloatingBody> bodies, double margin,
                                  const MeanForce& forces) noexcept {
  const Model::PairBlock& pair = pairs_[static_cast<std::size_t>(number)];
  const int first = pair.first_point + pair.candidates_of_a + pair.candidates_of_b,
            end = pair.first_point + pair.points;
  if (first == end) return;
  const WorldSurface &of_a = body(pair.a).shape.surface(), &of_b = body(pair.b).shape.surface();
  const FloatingBody &state = bodies[static_cast<std::size_t>(pair.a)],
                     &there = bodies[static_cast<std::size_t>(pair.b)];
  const auto in_b = [&](const Vector3d& x) -> Vector3d {
    return seen_from(there, state, x - body(pair.a).centre) + body(pair.b).centre;
  };
  crossings_.clear();
  const auto node = [](const WorldSurface& on, const WorldSurface::Crease& crease, std::size_t k) {
    return on.node[static_cast<std::size_t>(crease.node[k])];
  };
  Point probe = points_[static_cast<std::size_t>(first)];
  for (int i = 0; i < static_cast<int>(of_a.crease.size()); ++i) {
    const WorldSurface::Crease& a = of_a.crease[static_cast<std::size_t>(i)];
    const Vector3d p0 = in_b(node(of_a, a, 0)), p1 = in_b(node(of_a, a, 1)), middle = (p0 + p1) / 2;
    const double reach = margin + (p1 - p0).norm() / 2;
    if (!(body(pair.b).shape.box().squaredExteriorDistance(middle) < reach * reach)) continue;
    for (int j = 0; j < static_cast<int>(of_b.crease.size()); ++j) {
      const WorldSurface::Crease& b = of_b.crease[static_cast<std::size_t>(j)];
      const Vector3d q0 = node(of_b, b, 0), q1 = node(of_b, b, 1);
      const double within = reach + (q1 - q0).norm() / 2;
      if ((middle - (q0 + q1) / 2).squaredNorm() > within * within) continue;
      if (!cross(probe, i, j, bodies) || !(std::abs(probe.distance) < margin)) continue;
      if (crossings_.size() < crossings_.capacity()) crossings_.push_back({i, j, probe.distance});
    }
  }
  std::sort(crossings_.begin(), crossings_.end(),
            [](const Crossing& one, const Crossing& other) { return one.distance < other.distance; });
  const auto share = [](const WorldSurface& on, int one, int other) {
    if (one < 0 || other < 0) return false;
    for (const int x : on.crease[static_cast<std::size_t>(one)].node)
      for (const int y : on.crease[static_cast<std::size_t>(other)].node)
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
        cross(point, found->of_a, found->of_b, bodies);
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

/// Sets the vectors of the rows to a normal, which turns them as little as possible.
void MovingPoints::set_row(Point& point, const Vector3d& normal) noexcept {
  Vector3d tangent = point.row.row(1).transpose();
  tangent -= normal.dot(tangent) * normal;
  if (tangent.squaredNorm() > 0.1) {
    tangent.normalize();
    point.row.row(1) = tangent;
    point.row.row(2) = normal.cross(tangent);
  } else {
    point.row.bottomRows<2>() = tangents_of(normal);
  }
  point.row.row(0) = normal;
}

/// Takes a foot as what a candidate meets.
void MovingPoints::meet(Point& point, const Foot& foot, std::span<const FloatingBody> bodies) noexcept {
  const int own = point.end[static_cast<std::size_t>(point.own())].body,
            other = point.end[static_cast<std::size_t>(point.other())].body;
  const FloatingBody &state = bodies[static_cast<std::size_t>(own)],
                     &there = bodies[static_cast<std::size_t>(other)];
  const Eigen::Quaterniond to_own = state.attitude.conjugate() * there.attitude;
  const auto rise = [&](const Vector3d& n) { return body(own).shape.rise(point.candidate, to_own * n); };
  const Vector3d x = seen_from(there, state, point.place) + body(other).centre;
  const auto suits = [&](const Vector3d& n) { return rise(-n) <= most_rise; };
  point.foot = body(other).shape.settle(foot, x, suits);
  point.distance = point.foot.distance;
  const double deepest = -std::min(body(own).shape.element_size(), body(other).shape.element_size());
  point.open = !suits(point.foot.normal) || point.distance < deepest;
  set_row(point, point.kind == Kind::candidate_of_a ? Vector3d(-point.foot.normal) : point.foot.normal);
  End& end = point.end[static_cast<std::size_t>(point.other())];
  end.count = 3;
  end.candidate = body(other).shape.surface().element[static_cast<std::size_t>(point.foot.element)].corner;
  end.weight = point.foot.weight;
}

/// Takes two creases as those of a point. Returns whether they cross so that they may touch.
bool MovingPoints::cross(Point& point, int of_a, int of_b, std::span<const FloatingBody> bodies) noexcept {
  const Body &a = body(point.end[0].body), &b = body(point.end[1].body);
  const FloatingBody &state = bodies[static_cast<std::size_t>(point.end[0].body)],
                     &there = bodies[static_cast<std::size_t>(point.end[1].body)];
  const WorldSurface::Crease& one = a.shape.surface().crease[static_cast<std::size_t>(of_a)];
  const WorldSurface::Crease& other = b.shape.surface().crease[static_cast<std::size_t>(of_b)];
  const Eigen::Quaterniond to_b = there.attitude.conjugate() * state.attitude;
  const Vector3d offset = there.attitude.conjugate() * (state.position - there.position) + b.centre;
  const auto at_a = [&](std::size_t k) -> Vector3d {
    return a.shape.surface().node[static_cast<std::size_t>(one.node[k])] - a.centre;
  };
  const auto at_b = [&](std::size_t k) -> Vector3d {
    return b.shape.surface().node[static_cast<std::size_t>(other.node[k])];
  };
  const Vector3d p0 = to_b * at_a(0) + offset, p1 = to_b * at_a(1) + offset;
  double s = 0, t = 0;
  point.crease = {of_a, of_b};
  point.open = true;
  if (!crossing(p0, p1, at_b(0), at_b(1), s, t)) return false;
  point.open = std::max({-s, s - 1, -t, t - 1}) > beyond_end;
  s = std::clamp(s, 0.0, 1.0);
  t = std::clamp(t, 0.0, 1.0);
  Vector3d normal = (p1 - p0).cross(at_b(1) - at_b(0)).normalized();
  if (normal.dot(to_b * one.normal) < 0) normal = -normal;
  for (std::size_t k = 0; k < 2; ++k)
    point.open = point.open || normal.dot(to_b * one.into[k]) > most_rise_at_crease ||
                 -normal.dot(other.into[k]) > most_rise_at_crease;
  const Vector3d p = p0 + s * (p1 - p0), q = at_b(0) + t * (at_b(1) - at_b(0));
  point.distance = normal.dot(q - p);
  point.open = point.open ||
               point.distance < -deepest_crossing * std::min((p1 - p0).norm(), (at_b(1) - at_b(0)).norm());
  point.place = at_a(0) + s * (at_a(1) - at_a(0));
  set_row(point, normal);
  point.end[0].count = point.end[1].count = 2;
  point.end[0].candidate = {one.node[0], one.node[1], 0};
  point.end[0].weight = {1 - s, s, 0};
  point.end[1].candidate = {other.node[0], other.node[1], 0};
  point.end[1].weight = {1 - t, t, 0};
  return !point.open;
}

/// Keeps the members that are watched, and the candidates under them.
void MovingPoints::drop_members() noexcept {
  const auto stays = [&](int i) { return static_cast<bool>(is_watched_[static_cast<std::size_t>(i)]); };
  std::erase_if(members_, [&](int i) {
    if (!stays(i)) member_of_[static_cast<std::size_t>(i)] = -1;
    return !stays(i);
  });
  for (std::size_t s = 0; s < members_.size(); ++s)
    member_of_[static_cast<std::size_t>(members_[s])] = static_cast<int>(s);
  for (Body& one : bodies_) std::fill(one.used.begin(), one.used.end(), false);
  for (const int i : members_)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (int k = 0; k < end.count; ++k)
        if (end.weight[static_cast<std::size_t>(k)] > 0)
          body(end.body).used[static_cast<std::size_t>(end.candidate[static_cast<std::size_t>(k)])] = true;
  for (Body& one : bodies_) drop_candidates(one);
}

/// Blocks move towards the front, in their order, so that none is overwritten before it has moved.
void MovingPoints::drop_candidates(Body& of) noexcept {
  const auto stays = [&](int candidate) {
    return static_cast<bool>(of.used[static_cast<std::size_t>(candidate)]);
  };
  if (std::all_of(of.joined.begin(), of.joined.end(), stays)) return;
  Index kept = 0;
  for (std::size_t s = 0; s < of.joined.size(); ++s) {
    if (!stays(of.joined[s])) continue;
    Index column = 0;
    for (std::size_t t = 0; t <= s; ++t) {
      if (!stays(of.joined[t])) continue;
      for (PointBlocks* blocks : {&of.in_modes, &of.residual})
        (*blocks)(kept, column) = Matrix3d((*blocks)(static_cast<Index>(s), static_cast<Index>(t)));
      ++column;
    }
    ++kept;
  }
  std::erase_if(of.joined, [&](int candidate) {
    if (!stays(candidate)) of.number_of[static_cast<std::size_t>(candidate)] = -1;
    return !stays(candidate);
  });
  for (std::size_t s = 0; s < of.joined.size(); ++s)
    of.number_of[static_cast<std::size_t>(of.joined[s])] = static_cast<int>(s);
}

const Vector3d& MovingPoints::displacement(int number, int candidate, const Vector& q) noexcept {
  Body& of = body(number);
  const auto i = static_cast<std::size_t>(candidate);
  if (of.w_at[i] != calls_) {
    of.w[i].noalias() = of.shape_of(candidate) * q.segment(of.first_elastic, of.elastic);
    if (!of.settled.empty()) of.w[i] += of.settled[i];
  }
  of.w_at[i] = calls_;
  return of.w[i];
}

Vector3d MovingPoints::elastic(const End& end, const Vector& q) noexcept {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
    if (end.weight[k] > 0) out += end.weight[k] * displacement(end.body, end.candidate[k], q);
  return out;
}

void MovingPoints::place(std::span<const FloatingBody> bodies, const Vector& q) noexcept {
  ++calls_;
  for (const Model::PairBlock& pair : pairs_) {
    if (pair.b >= 0) continue;
    const FloatingBody& state = bodies[static_cast<std::size_t>(pair.a)];
    const Matrix3d A = state.attitude.toRotationMatrix();
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      const Vector3d moved = state.position + A * point.place - point.initial;
      u_(i) = point.row.row(0).dot(moved);
      if (point.tangential >= 0)
        u_.segment<2>(point.tangential).noalias() = point.row.bottomRows<2>() * moved;
    }
  }
  for (const int i : watched_) {
    Point& point = points_[static_cast<std::size_t>(i)];
    if (point.kind != Kind::obstacle) {
      place_between(i, bodies, q);
      continue;
    }
    const Vector3d w = elastic(point.end[0], q);
    point.place_now = point.place + w;
    const Vector3d turned = bodies[static_cast<std::size_t>(point.end[0].body)].attitude * w;
    u_(i) += point.row.row(0).dot(turned);
    if (point.tangential >= 0)
      u_.segment<2>(point.tangential).noalias() += point.row.bottomRows<2>() * turned;
  }
}

/// Follows a point between two bodies.
void MovingPoints::place_between(int number, std::span<const FloatingBody> bodies, const Vector& q) noexcept {
  Point& point = points_[static_cast<std::size_t>(number)];
  const End &own = point.end[static_cast<std::size_t>(point.own())],
            &other = point.end[static_cast<std::size_t>(point.other())];
  const FloatingBody &state = bodies[static_cast<std::size_t>(own.body)],
                     &there = bodies[static_cast<std::size_t>(other.body)];
  if (point.kind == Kind::creases) {
    cross(point, point.crease[0], point.crease[1], bodies);
  } else {
    const Vector3d x = seen_from(there, state, point.place) + body(other.body).centre;
    meet(point, body(other.body).shape.follow(point.foot, x), bodies);
  }
  const Vector3d w = elastic(own, q);
  point.place_now = point.place + w;
  // The normal leads out of a.
  const double sign = point.kind == Kind::candidate_of_b ? -1 : 1;
  const double nearer =
      sign * point.row.row(0).dot(there.attitude.conjugate() * (state.attitude * w) - elastic(other, q));
  u_(number) = point.gap - (point.distance - nearer);
  if (point.open)
    u_(number) = point.gap - std::max(std::abs(point.distance), body(other.body).shape.element_size());
}

void MovingPoints::advance(std::span<const FloatingBody> bodies, const Vector& dq, double step,
                           const MeanForce& forces) noexcept {
  ++calls_;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const FloatingBody& state = bodies[k];
    bodies_[k].fastest = step * (state.velocity.norm() + 0.5 * step * state.acceleration().norm() +
                                 (state.momentum + 0.5 * step * state.torque).norm() *
                                     state.inertia.largest_inverse * bodies_[k].radius);
  }
  const auto move = [&](int number, int candidate) {
    Body& of = body(number);
    const auto i = static_cast<std::size_t>(candidate);
    if (of.dw_at[i] == calls_) return;
    of.dw_at[i] = calls_;
    of.dw[i].noalias() = of.shape_of(candidate) * dq.segment(of.first_elastic, of.elastic);
  };
  for (Body& of : bodies_) of.elastic_fastest = 0;
  for (const int i : watched_)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k) {
        if (!(end.weight[k] > 0)) continue;
        move(end.body, end.candidate[k]);
        Body& of = body(end.body);
        of.elastic_fastest =
            std::max(of.elastic_fastest, of.dw[static_cast<std::size_t>(end.candidate[k])].norm());
      }
  for (const int i : watched_) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    if (member_of_[static_cast<std::size_t>(i)] >= 0) continue;
    const bool pressed = has_force(i, forces);
    double fastest = 0;
    for (const End& end : point.end)
      if (end.body >= 0) fastest += body(end.body).fastest + body(end.body).elastic_fastest;
    if (!pressed && !(point.gap - u_(i) < approaches * fastest)) continue;
    if (!pressed && point.kind != Kind::obstacle &&
        (point.open || repeats(point) || u_(i) - point.gap > deepest_start(point, approaches * fastest)))
      continue;
    member_of_[static_cast<std::size_t>(i)] = static_cast<int>(members_.size());
    members_.push_back(i);
  }
  for (const int i : members_)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
        if (end.weight[k] > 0) join(end.body, end.candidate[k]);
  list_rows();
  for (std::size_t s = 0; s < members_.size(); ++s) {
    Point& point = points_[static_cast<std::size_t>(members_[s])];
    Matrix3d in_world = point.row;
    const FloatingBody& state =
        bodies[static_cast<std::size_t>(point.end[static_cast<std::size_t>(point.own())].body)];
    if (point.kind != Kind::obstacle)
      in_world = point.row *
                 attitude_of(bodies, point.end[static_cast<std::size_t>(point.other())].body).transpose();
    point.acting = in_world;
    const Vector3d common = state.position + state.attitude * point.place_now;
    Vector3d d = Vector3d::Zero();
    double sign = 1;
    for (std::size_t k = 0; k < 2; ++k, sign = -1) {
      End& end = point.end[k];
      if (end.body < 0) continue;
      const FloatingBody& of = bodies[static_cast<std::size_t>(end.body)];
      end.direction = sign * in_world * of.attitude.toRotationMatrix();
      end.arm = static_cast<int>(k) == point.own()
                    ? point.place_now
                    : Vector3d(of.attitude.conjugate() * (common - of.position));
      Vector3d free = of.attitude.conjugate() * (step * of.velocity + 0.5 * step * step * of.acceleration());
      free += step * of.own_spin(of.momentum + 0.5 * step * of.torque).cross(end.arm);
      for (std::size_t j = 0; j < static_cast<std::size_t>(end.count); ++j)
        if (end.weight[j] > 0)
          free += end.weight[j] * body(end.body).dw[static_cast<std::size_t>(end.candidate[j])];
      d += end.direction * free;
    }
    for (int along = 0; along < rows_of(point); ++along) {
      const Index at = along == 0 ? static_cast<Index>(s) : static_cast<Index>(tangents_at_[s] + along - 1);
      start_(at) = u_(rows_[static_cast<std::size_t>(at)]);
      free_(at) = start_(at) + d(along);
    }
  }
}

/// Largest depth at which a point may begin to touch. One that is deeper has come in where nothing could stop
/// it, as at an edge that is hollow: it would be thrown out. @param approach  in a step, at most
double MovingPoints::deepest_start(const Point& point, double approach) const noexcept {
  double element = std::numeric_limits<double>::infinity();
  for (const End& end : point.end) element = std::min(element, body(end.body).shape.element_size());
  return std::max(approach, near_surface * element);
}

/// Whether a candidate of b lies over one of a that may touch b, too.
bool MovingPoints::repeats(const Point& point) const noexcept {
  if (point.kind != Kind::candidate_of_b) return false;
  const auto heaviest = std::ranges::max_element(point.foot.weight);
  if (!(*heaviest > same_place)) return false;
  const End& of_a = point.end[0];
  const int there = point_of_a_[static_cast<std::size_t>(point.pair)][static_cast<std::size_t>(
      of_a.candidate[static_cast<std::size_t>(heaviest - point.foot.weight.begin())])];
  return there >= 0 && !points_[static_cast<std::size_t>(there)].open;
}

/// Gathers the blocks of a candidate with the others of its body that have joined, unless it has.
void MovingPoints::join(int number, int candidate) noexcept {
  Body& of = body(number);
  if (of.number_of[static_cast<std::size_t>(candidate)] >= 0) return;
  const auto s = static_cast<Index>(of.joined.size());
  of.number_of[static_cast<std::size_t>(candidate)] = static_cast<int>(s);
  of.joined.push_back(candidate);
  for (PointBlocks* blocks : {&of.in_modes, &of.residual}) blocks->resize(s + 1);
  const auto own = of.shape_of(candidate);
  const auto c = c_.segment(of.first_elastic, of.elastic).transpose(),
             folded = folded_.segment(of.first_elastic, of.elastic).transpose();
  // Φ d Φᵀ, entry by entry: a product of matrices would allocate.
  const auto block = [&](const auto& diagonal, const auto& other) {
    Matrix3d out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(i, j) = own.row(i).cwiseProduct(diagonal).dot(other.row(j));
    return out;
  };
  for (Index t = 0; t <= s; ++t) {
    const int other = of.joined[static_cast<std::size_t>(t)];
    of.in_modes(s, t) = block(c, of.shape_of(other));
    if (of.yields())
      of.residual(s, t) = of.flexibility(candidate, other);
    else
      of.residual(s, t).setZero();
    if (folds_) of.residual(s, t) += block(folded, of.shape_of(other));
  }
}

void MovingPoints::list_rows() noexcept {
  rows_.clear();
  owner_.clear();
  along_.clear();
  tangents_at_.clear();
  const auto add = [&](int row, std::size_t member, int along) {
    rows_.push_back(row);
    owner_.push_back(static_cast<int>(member));
    along_.push_back(along);
  };
  for (std::size_t s = 0; s < members_.size(); ++s) add(members_[s], s, 0);
  for (std::size_t s = 0; s < members_.size(); ++s) {
    const int tangential = points_[static_cast<std::size_t>(members_[s])].tangential;
    tangents_at_.push_back(static_cast<int>(rows_.size()));
    if (tangential < 0) continue;
    add(tangential, s, 1);
    add(tangential + 1, s, 2);
  }
}

StepMatrices MovingPoints::matrices(std::span<const FloatingBody> bodies, double step, double a) noexcept {
  const auto k = static_cast<Index>(rows_.size());
  auto M = M_.begin(k), R = R_.begin(k), S = S_.begin(k);
  auto S_mean = S_mean_.begin(a > 0 ? k : 0);
  const auto position = [&](std::size_t member, int along) {
    return along == 0 ? static_cast<Index>(member) : static_cast<Index>(tangents_at_[member] + along - 1);
  };
  const double share = 0.5 * step * step;
  for (std::size_t s = 0; s < members_.size(); ++s) {
    const Point& point = points_[static_cast<std::size_t>(members_[s])];
    for (std::size_t t = 0; t <= s; ++t) {
      const Point& other = points_[static_cast<std::size_t>(members_[t])];
      Matrix3d in_modes = Matrix3d::Zero(), in_residual = in_modes;
      for (const End& here : point.end)
        for (const End& there : other.end) {
          if (here.body < 0 || here.body != there.body) continue;
          const Body& of = body(here.body);
          const FloatingBody& state = bodies[static_cast<std::size_t>(here.body)];
          Matrix3d modes = -share * cross_matrix(here.arm) * state.inertia.inverse * cross_matrix(there.arm),
                   residual = Matrix3d::Zero();
          modes.diagonal().array() += share * state.inverse_mass;
          for (std::size_t i = 0; i < static_cast<std::size_t>(here.count); ++i)
            for (std::size_t j = 0; j < static_cast<std::size_t>(there.count); ++j) {
              const double weight = here.weight[i] * there.weight[j];
              if (!(weight > 0)) continue;
              const Index x = of.number_of[static_cast<std::size_t>(here.candidate[i])],
                          y = of.number_of[static_cast<std::size_t>(there.candidate[j])];
              of.in_modes.add(x, y, weight, modes);
              of.residual.add(x, y, weight, residual);
            }
          in_modes += here.direction * modes * there.direction.transpose();
          in_residual += here.direction * residual * there.direction.transpose();
        }
      for (int i = 0; i < rows_of(point); ++i)
        for (int j = 0; j < rows_of(other); ++j) {
          const Index row = position(s, i), column = position(t, j);
          M(row, column) = M(column, row) = in_modes(i, j);
          R(row, column) = R(column, row) = in_residual(i, j);
        }
    }
  }
  S = M + R;
  if (a > 0) S_mean = a * M + R;
  return {.M = M, .R = R, .S = S, .S_mean = S_mean};
}

MovingPoints::Load MovingPoints::load(int number, const Vector& p, Vector& modal) const noexcept {
  Load out;
  const Body& of = body(number);
  for (std::size_t s = 0; s < members_.size(); ++s) {
    const Point& point = points_[static_cast<std::size_t>(members_[s])];
    for (const End& end : point.end) {
      if (end.body != number) continue;
      const Vector3d force = force_on(end, s, p);
      if (force.isZero(0)) continue;
      out.force += force;
      out.torque += end.arm.cross(force);
      for (std::size_t j = 0; j < static_cast<std::size_t>(end.count); ++j)
        if (end.weight[j] > 0)
          modal.segment(of.first_elastic, of.elastic).noalias() +=
              of.shape_of(end.candidate[j]).transpose() * (end.weight[j] * force);
    }
  }
  return out;
}

/// On an end of a member, in the axes of its body [N].
Vector3d MovingPoints::force_on(const End& end, std::size_t member, const Vector& p) const noexcept {
  Vector3d out = -p(static_cast<Index>(member)) * end.direction.row(0).transpose();
  if (points_[static_cast<std::size_t>(members_[member])].tangential >= 0)
    out.noalias() -= end.direction.bottomRows<2>().transpose() * p.segment<2>(tangents_at_[member]);
  return out;
}

void MovingPoints::write_frames(std::span<const FloatingBody> bodies, RowFrames& out) const noexcept {
  for (const int i : watched_) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    const FloatingBody& state =
        bodies[static_cast<std::size_t>(point.end[static_cast<std::size_t>(point.own())].body)];
    Matrix3d rows = point.row;
    if (point.kind != Kind::obstacle)
      rows = point.row *
             attitude_of(bodies, point.end[static_cast<std::size_t>(point.other())].body).transpose();
    const Vector3d x = state.position + state.attitude * point.place_now,
                   y = x + (point.own() == 0 ? 1 : -1) * (point.gap - u_(i)) * rows.row(0).transpose();
    out.point_a.row(i) = (point.own() == 0 ? x : y).transpose();
    out.point_b.row(i) = (point.own() == 0 ? y : x).transpose();
    if (member_of_[static_cast<std::size_t>(i)] >= 0) rows = point.acting;
    out.normal.row(i) = rows.row(0);
    if (point.tangential >= 0)
      out.tangent.middleRows<2>(point.tangential - static_cast<Index>(points_.size())) = rows.bottomRows<2>();
  }
}

void MovingPoints::write_forces(const Vector& p, std::vector<Vector>& out) noexcept {
  for (const auto& [number, candidate] : forced_)
    out[static_cast<std::size_t>(number)].segment<3>(3 * candidate).setZero();
  forced_.clear();
  for (std::size_t s = 0; s < members_.size(); ++s)
    for (const End& end : points_[static_cast<std::size_t>(members_[s])].end) {
      const Vector3d force = end.body < 0 ? Vector3d::Zero() : force_on(end, s, p);
      if (force.isZero(0)) continue;
      for (std::size_t j = 0; j < static_cast<std::size_t>(end.count); ++j) {
        if (!(end.weight[j] > 0)) continue;
        out[static_cast<std::size_t>(end.body)].segment<3>(3 * end.candidate[j]) += end.weight[j] * force;
        forced_.push_back({end.body, end.candidate[j]});
      }
    }
}

}  // namespace ricochet::contact
