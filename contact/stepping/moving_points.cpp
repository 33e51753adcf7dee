// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/moving_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.hpp"
#include "contact/simd/dense.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Points join if they are nearer than this many times the largest free approach of their bodies in the step,
/// since contact may reverse their motion within it.
constexpr double approaches = 3;

/// A candidate of b over this share of one of a is left to that one, if that one may touch b.
constexpr double same_place = 0.98;

/// A point begins to touch at a depth of at most this share of an element.
constexpr double near_surface = 1e-3;

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
    if (!pair.is_half_space() && surface.element_corners != 3)
      refuse(model, pair,
             "with motion.rotation = \"finite\", bodies meet with their surfaces, but a kernel holds points "
             "alone. Compute it for this scene with ricochet-kernel.");
  }
}

/// Writes U of a candidate over a half-space, from its displacement in world axes and that of the half-space
/// along the normal.
void write_over(const MovingPoint& point, int number, const Vector3d& moved, double raise, Vector& u) {
  u(number) = point.row.row(0).dot(moved) - raise;
  if (point.tangential >= 0) u.segment<2>(point.tangential).noalias() = point.row.bottomRows<2>() * moved;
}

}  // namespace

MovingPoints::Body::Body(const Bodies::Block& block, std::shared_ptr<const BodySurface> of_kernel,
                         const Model& model, const StepSystem& system)
    : kernel(block.kernel),
      surface(std::move(of_kernel)),
      centre(block.own_centre()),
      candidates(block, shape(), model, system),
      used(block.kernel->surface.size(), 0) {
  for (const auto* places : {&shape().surface().node, &shape().surface().crest})
    for (const Vector3d& x : *places) radius = std::max(radius, (x - centre).norm());
  least_area = std::ranges::min(shape().surface().area);
}

MovingPoints::MovingPoints(const Model& model, const StepSystem& system, const MovingPoints* earlier)
    : pairs_(model.pairs),
      drives_(model.pairs.size()),
      far_(model.pairs.size(), -1),
      travelled_(model.pairs.size(), std::numeric_limits<double>::infinity()) {
  for (ReservedMatrix* x : {&flexibility_.S, &flexibility_.whole}) *x = ReservedMatrix(capacity_of(model));
  bodies_.reserve(model.bodies.size());  // copies would lose the reserve of their lists
  for (const Bodies::Block& block : model.bodies) {
    std::shared_ptr<const BodySurface> surface = known_surface(block.kernel);
    if (!surface && earlier != nullptr) surface = earlier->known_surface(block.kernel);
    if (!surface) surface = std::make_shared<const BodySurface>(*block.kernel);
    bodies_.emplace_back(block, std::move(surface), model, system);
  }
  const auto m = static_cast<std::size_t>(model.points()),
             held = static_cast<std::size_t>(capacity_of(model));
  points_.resize(m);
  is_watched_.assign(m, false);
  members_.of_point.assign(m, -1);
  for (std::vector<int>* x : {&watched_, &members_.points, &members_.first_row}) x->reserve(m);
  for (std::vector<int>* x : {&members_.rows, &members_.of_row}) x->reserve(held);
  flexibility_.levers.resize(2 * m);
  flexibility_.lowest.resize(2 * m);
  flexibility_.pulls.resize(2 * m);
  crossings_.reserve(m);
  tops_.reserve(most_found);
  summits_.reserve(most_found);
  near_.reserve(m);
  std::size_t most = 0;
  for (const Body& one : bodies_) most = std::max(most, one.used.size());
  flexibility_.displaced.assign(7 * (3 * most + 8), 0);
  flexibility_.columns.assign(4 * (held + 7), 0);
  flexibility_.of_member.resize(std::min(m, held));
  flexibility_.excess.resize(std::min(m, held));
  forced_.reserve(6 * m);
  for (Vector* x : {&start_, &free_, &driven_}) x->setZero(capacity_of(model));
  u_.setZero(model.rows());
  add_solids(earlier);
  for (int pair = 0; pair < static_cast<int>(model.pairs.size()); ++pair) {
    check(model, model.pairs[static_cast<std::size_t>(pair)]);
    add_points(model, pair);
  }
  for (const Rows::FrictionPoint& rubs : model.friction) {
    Point& point = points_[static_cast<std::size_t>(rubs.point)];
    point.tangential = rubs.tangential;
    if (point.over_half_space())
      point.row.bottomRows<2>() = model.tangent.middleRows<2>(rubs.tangential - model.points());
  }
}

std::shared_ptr<const BodySurface> MovingPoints::known_surface(const kernels::Kernel* kernel) const {
  const auto found = std::ranges::find(bodies_, kernel, &Body::kernel);
  return found == bodies_.end() ? nullptr : found->surface;
}

void MovingPoints::take(const MovingPoints& earlier, const Correspondence& from) {
  for (std::size_t p = 0; p < from.pair.size(); ++p) {
    if (from.pair[p] < 0) continue;
    const auto then = static_cast<std::size_t>(from.pair[p]);
    const Model::PairBlock& pair = pairs_[p];
    far_[p] = earlier.far_[then];
    travelled_[p] = earlier.travelled_[then];
    for (int i = 0; i < pair.points; ++i) {
      Point& point = points_[static_cast<std::size_t>(pair.first_point + i)];
      const int tangential = point.tangential;
      point = earlier.points_[static_cast<std::size_t>(earlier.pairs_[then].first_point + i)];
      point.pair = static_cast<int>(p);
      point.end[0].body = pair.a;
      point.end[1].body = pair.b;
      point.end[1].solid = solid_of(pair);
      point.tangential = tangential;
    }
  }
  carry(earlier.u_, u_, from.rows);
  for (const auto& [number, candidate] : earlier.forced_)
    if (const auto now = std::ranges::find(from.body, number); now != from.body.end())
      forced_.push_back({static_cast<int>(now - from.body.begin()), candidate});
}

void MovingPoints::forget(int number) noexcept {
  const auto concerns = [&](int i) {
    const Model::PairBlock& pair =
        pairs_[static_cast<std::size_t>(points_[static_cast<std::size_t>(i)].pair)];
    return pair.a == number || pair.b == number;
  };
  for (const int i : watched_)
    if (concerns(i)) is_watched_[static_cast<std::size_t>(i)] = false;
  std::erase_if(watched_, concerns);
  std::erase_if(near_, [&](const Near& one) { return concerns(one.summit); });
  drop_members();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Model::PairBlock& pair = pairs_[k];
    if (pair.a != number && pair.b != number) continue;
    far_[k] = -1;
    travelled_[k] = std::numeric_limits<double>::infinity();
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      Point& point = points_[static_cast<std::size_t>(i)];
      if (point.kind == Kind::half_space) continue;
      point.open = true;
      point.crease = {-1, -1};
      if (!point.over_half_space()) point.row.setZero();
    }
  }
}

void MovingPoints::add_points(const Model& model, int number) {
  const Rows::PairBlock& pair = model.pairs[static_cast<std::size_t>(number)];
  auto& numbers = point_of_.emplace_back();
  const int solid = solid_of(pair);
  const auto shape_of = [&](std::size_t side) -> const BodySurface& {
    if (side == 1 && solid >= 0) return *solids_[static_cast<std::size_t>(solid)].surface;
    return body(side == 0 ? pair.a : pair.b).shape();
  };
  for (const std::size_t side : {0, 1})
    numbers[side].assign(pair.is_half_space() ? 0 : shape_of(side).surface().node.size(), -1);
  for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
    Point& point = points_[static_cast<std::size_t>(i)];
    point.pair = number;
    point.gap = model.gap(i);
    point.end[0].body = pair.a;
    point.end[1].body = pair.b;
    point.end[1].solid = solid;
    const int within = i - pair.first_point;
    if (pair.is_summit(i))
      point.kind = Kind::summit;
    else if (!pair.is_half_space())
      point.kind = within < pair.candidates_of_a ? Kind::candidate_of_a
                   : within < pair.candidates()  ? Kind::candidate_of_b
                                                 : Kind::creases;
    if (point.kind == Kind::creases || (point.kind == Kind::summit && !pair.is_half_space())) continue;
    const bool of_b = point.kind == Kind::candidate_of_b;
    point.candidate = model.candidate[static_cast<std::size_t>(i)];
    point.place = shape_of(of_b ? 1 : 0).surface().crest[static_cast<std::size_t>(point.candidate)];
    if (point.own().body >= 0)
      point.place -= body(point.own().body).centre;
    else
      point.stand_on_creases(shape_of(1).surface());
    point.end[of_b ? 1 : 0].set({point.candidate, 0, 0}, {1, 0, 0});
    if (!point.over_half_space()) {
      numbers[of_b ? 1 : 0][static_cast<std::size_t>(point.candidate)] = i;
      continue;
    }
    point.open = false;
    point.initial = model.point_a.row(i).transpose();
    point.row.row(0) = model.normal.row(i);
  }
}

/// Keeps the members that are watched, and the candidates under them.
void MovingPoints::drop_members() noexcept {
  const auto stays = [&](int i) { return static_cast<bool>(is_watched_[static_cast<std::size_t>(i)]); };
  std::erase_if(members_.points, [&](int i) {
    if (!stays(i)) members_.of_point[static_cast<std::size_t>(i)] = -1;
    return !stays(i);
  });
  for (std::size_t s = 0; s < members_.points.size(); ++s)
    members_.of_point[static_cast<std::size_t>(members_.points[s])] = static_cast<int>(s);
  for (Body& one : bodies_) std::fill(one.used.begin(), one.used.end(), false);
  for (const int i : members_.points)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
        body(end.body).used[static_cast<std::size_t>(end.candidate[k])] = true;
  for (Body& one : bodies_) one.candidates.keep(one.used);
}

Vector3d MovingPoints::elastic(const End& end, const Vector& q) noexcept {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
    out += end.weight[k] * body(end.body).candidates.displacement(end.candidate[k], q);
  return out;
}

/// The rows of a point in world axes.
Matrix3d MovingPoints::in_world(const Point& point, std::span<const FloatingBody> bodies) const noexcept {
  if (point.over_half_space()) return point.row;
  return point.row * side(point.other(), bodies).state.axes.transpose();
}

Vector3d MovingPoints::normal_in_world(const Point& point,
                                       std::span<const FloatingBody> bodies) const noexcept {
  const Vector3d own = point.row.row(0).transpose();
  return point.over_half_space() ? own : Vector3d(side(point.other(), bodies).state.axes * own);
}

/// The element size there of the finer of its bodies [m].
double MovingPoints::smallest_element(const Point& point) const noexcept {
  double out = std::numeric_limits<double>::infinity();
  for (const End& end : point.end) {
    if (end.body < 0) continue;
    double size = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
      size += end.weight[k] * body(end.body).shape().element_size(end.candidate[k]);
    out = std::min(out, size);
  }
  return out;
}

/// Takes a summit to where it is now, with the elastic displacement that it had.
void MovingPoints::follow_summit(Point& point, std::span<const FloatingBody> bodies) const noexcept {
  const Vector3d w = point.place_now - point.place;
  const Side own = side(point.end[0].body, bodies);
  if (point.over_half_space())
    point.stand_on(own.shape.summit(point.top.element,
                                    {.up = own.state.axes.transpose() * point.row.row(0).transpose()}),
                   own);
  else
    point.face(own, side(point.end[1], bodies));
  point.place_now = point.place + w;
}

bool MovingPoints::has_jumped(std::size_t position) noexcept {
  Point& point =
      points_[static_cast<std::size_t>(members_.points[static_cast<std::size_t>(members_.of_row[position])])];
  if (point.kind != Kind::summit) return false;
  const double way = (point.place - point.stood).norm();
  point.stood = point.place;
  return way > 0.5 * smallest_element(point);
}

/// Square of the way from a candidate to a summit, on the body of the candidate [m²].
double MovingPoints::square_way(const Point& candidate, const Point& summit) const noexcept {
  const Vector3d there = candidate.kind == Kind::candidate_of_b
                             ? Vector3d(summit.foot.point - centre_of(candidate.own()))
                             : summit.place;
  return (candidate.place - there).squaredNorm();
}

/// Lets candidates near a summit touch only when the surface is pressed by as much as it falls away from the
/// summit over an element: by f (h/r)², if it falls by f at the distance r, in the direction in which it
/// falls least. Where elastic displacements make it rise in one, the summit is not the nearest place, and
/// none of them stands back: at f = 0, no candidate is nearer than the summit, so that none is moved by it.
void MovingPoints::stand_back() noexcept {
  for (auto first = near_.begin(); first != near_.end();) {
    const auto end =
        std::find_if(first, near_.end(), [&](const Near& one) { return one.summit != first->summit; });
    const Point& summit = points_[static_cast<std::size_t>(first->summit)];
    if (summit.open) {  // it has come to an edge
      first = end;
      continue;
    }
    const double h = smallest_element(summit), height = summit.gap - u_(first->summit);
    double fall = std::numeric_limits<double>::infinity();
    for (auto one = first; one != end; ++one) {
      const Point& point = points_[static_cast<std::size_t>(one->candidate)];
      const double square = square_way(point, summit);
      if (square > 0.25 * h * h)
        fall = std::min(fall, (point.gap - u_(one->candidate) - height) * h * h / square);
    }
    if (!(fall > 0)) first = end;
    for (; first != end; ++first)
      u_(first->candidate) = std::min(
          u_(first->candidate), points_[static_cast<std::size_t>(first->candidate)].gap - height - fall);
  }
}

void MovingPoints::place(std::span<const FloatingBody> bodies, const Vector& q) noexcept {
  for (Body& one : bodies_) one.candidates.begin_displacements();
  for (const int i : watched_) place(i, bodies, &q);
  for (const Near& one : near_)
    if (!is_watched_[static_cast<std::size_t>(one.candidate)]) place(one.candidate, bodies, nullptr);
  stand_back();
}

/// Computes U of a point, and where it is. @param q  (N), or null: without elastic displacements
void MovingPoints::place(int number, std::span<const FloatingBody> bodies, const Vector* q) noexcept {
  Point& point = points_[static_cast<std::size_t>(number)];
  const Side own = side(point.own(), bodies);
  const auto elastic = [&](const End& end) -> Vector3d {
    return q == nullptr ? Vector3d::Zero() : this->elastic(end, *q);
  };
  if (!point.over_half_space()) {
    const Side other = side(point.other(), bodies);
    point.follow(own, other);
    const Vector3d w = elastic(point.own());
    point.place_now = point.place + w;
    u_(number) = point.gap - (point.distance - point.nearer(w, elastic(point.other()), own, other));
    if (point.open)
      u_(number) = point.gap - std::max(std::abs(point.distance), other.shape.largest_element());
    return;
  }
  if (point.kind == Kind::summit && !point.open) follow_summit(point, bodies);
  const Vector3d w = elastic(point.end[0]), turned = own.state.axes * w;
  point.place_now = point.place + w;
  if (point.kind == Kind::summit)
    u_(number) = point.gap - height(point, own.state) + point.row.row(0).dot(turned);
  else  // A displacement is far smaller than a place: its digits must not be lost.
    write_over(point, number, own.state.position + own.state.axes * point.place - point.initial + turned,
               drives_[static_cast<std::size_t>(point.pair)].raise, u_);
}

void MovingPoints::write_displacements(std::span<const FloatingBody> bodies, Vector& u) const noexcept {
  u = u_;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Model::PairBlock& pair = pairs_[k];
    if (!are_there(pair, bodies)) {
      u.segment(pair.first_point, pair.points).setConstant(-std::numeric_limits<double>::infinity());
      continue;
    }
    const FloatingBody& state = bodies[static_cast<std::size_t>(pair.a)];
    const Vector3d n = pair.is_half_space()
                           ? Vector3d(points_[static_cast<std::size_t>(pair.first_point)].row.row(0))
                           : Vector3d(Vector3d::Zero()),
                   own = state.axes.transpose() * n;
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      if (is_watched_[static_cast<std::size_t>(i)]) continue;
      const Point& point = points_[static_cast<std::size_t>(i)];
      if (point.kind == Kind::half_space)
        u(i) = n.dot(state.position - point.initial) + own.dot(point.place) - drives_[k].raise;
      else if (point.kind == Kind::summit && point.over_half_space() && !point.open)
        u(i) = point.gap - height(point, state);
      else if (far_[k] >= 0)
        u(i) = point.gap - far_[k];
    }
  }
  for (const Near& one : near_) u(one.candidate) = u_(one.candidate);
}

bool MovingPoints::advance(std::span<const FloatingBody> bodies, const Vector& dq, double step,
                           const MeanForce& forces) noexcept {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const FloatingBody& state = bodies[k];
    bodies_[k].candidates.begin_changes(dq);
    bodies_[k].elastic_fastest = 0;
    bodies_[k].free = state.free_motion(step);
    bodies_[k].fastest = state.farthest(bodies_[k].radius, step);
  }
  // In the middle of the step: from its start, a body would roll into the obstacle, by ½ a (ΩΔ)² in each.
  for (const int i : watched_)
    if (Point& point = points_[static_cast<std::size_t>(i)]; point.kind == Kind::summit && !point.open)
      follow_summit(point, bodies);
  for (const int i : watched_)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k) {
        Body& of = body(end.body);
        of.elastic_fastest = std::max(of.elastic_fastest, of.candidates.change(end.candidate[k], dq).norm());
      }
  add_members(forces);
  if (!list_rows()) return false;
  join_candidates();
  set_rows(bodies, dq);
  return true;
}

/// Adds the points that may touch in the step.
void MovingPoints::add_members(const MeanForce& forces) noexcept {
  for (const int i : watched_) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    if (members_.of_point[static_cast<std::size_t>(i)] >= 0) continue;
    double fastest = drives_[static_cast<std::size_t>(point.pair)].farthest;
    for (const End& end : point.end)
      if (end.body >= 0) fastest += body(end.body).fastest + body(end.body).elastic_fastest;
    if (!has_force(i, forces)) {
      if (!(point.gap - u_(i) < approaches * fastest)) continue;
      if (!point.over_half_space() &&
          (point.open || repeats(point) || u_(i) - point.gap > deepest_start(point, approaches * fastest)))
        continue;
    }
    members_.of_point[static_cast<std::size_t>(i)] = static_cast<int>(members_.points.size());
    members_.points.push_back(i);
  }
}

void MovingPoints::join_candidates() noexcept {
  for (const int i : members_.points)
    for (const End& end : points_[static_cast<std::size_t>(i)].end)
      for (std::size_t k = 0; k < static_cast<std::size_t>(end.count); ++k)
        body(end.body).candidates.join(end.candidate[k]);
}

/// Sets arms and directions in the middle of the step, U and U + d.
void MovingPoints::set_rows(std::span<const FloatingBody> bodies, const Vector& dq) noexcept {
  for (std::size_t s = 0; s < members_.points.size(); ++s) {
    Point& point = points_[static_cast<std::size_t>(members_.points[s])];
    const FloatingBody& fixed = side(point.own(), bodies).state;
    point.acting = in_world(point, bodies);
    const Vector3d common = fixed.position + fixed.axes * point.place_now;
    Vector3d d = Vector3d::Zero(), by_obstacle = Vector3d::Zero();
    if (point.over_half_space())
      by_obstacle(0) = drives_[static_cast<std::size_t>(point.pair)].rises;
    else if (const int solid = point.end[1].solid; solid >= 0)
      by_obstacle = point.acting * solids_[static_cast<std::size_t>(solid)].moved(common);
    double sign = 1;
    for (std::size_t k = 0; k < 2; ++k, sign = -1) {
      End& end = point.end[k];
      if (end.body < 0) continue;
      const FloatingBody& of = bodies[static_cast<std::size_t>(end.body)];
      end.direction = sign * point.acting * of.axes;
      end.arm =
          &end == &point.own() ? point.place_now : Vector3d(of.axes.transpose() * (common - of.position));
      Vector3d free = body(end.body).free.at(end.arm);
      for (std::size_t j = 0; j < static_cast<std::size_t>(end.count); ++j)
        free += end.weight[j] * body(end.body).candidates.change(end.candidate[j], dq);
      d += end.direction * free;
    }
    for (int along = 0; along < point.rows(); ++along) {
      const Index at = position(s, along);
      start_(at) = u_(members_.rows[static_cast<std::size_t>(at)]);
      driven_(at) = by_obstacle(along);
      free_(at) = start_(at) + d(along) - by_obstacle(along);
    }
  }
}

/// Largest depth at which a point may begin to touch. One that is deeper has come in where nothing could stop
/// it, as at an edge that is hollow: it would be thrown out. @param approach  in a step, at most
double MovingPoints::deepest_start(const Point& point, double approach) const noexcept {
  return std::max(approach, near_surface * smallest_element(point));
}

/// Whether a candidate of b lies over one of a that may touch b, too.
bool MovingPoints::repeats(const Point& point) const noexcept {
  if (point.kind != Kind::candidate_of_b || point.spread > 0) return false;
  const End& of_a = point.end[0];
  const auto heaviest = std::max_element(of_a.weight.begin(), of_a.weight.begin() + of_a.count);
  if (!(*heaviest > same_place)) return false;
  const int there = point_of_[static_cast<std::size_t>(point.pair)][0][static_cast<std::size_t>(
      of_a.candidate[static_cast<std::size_t>(heaviest - of_a.weight.begin())])];
  return there >= 0 && !points_[static_cast<std::size_t>(there)].open;
}

bool MovingPoints::list_rows() noexcept {
  members_.rows.clear();
  members_.of_row.clear();
  members_.first_row.clear();
  for (std::size_t s = 0; s < members_.points.size(); ++s) {
    const Point& point = points_[static_cast<std::size_t>(members_.points[s])];
    members_.first_row.push_back(static_cast<int>(members_.rows.size()));
    if (std::ssize(members_.rows) + point.rows() > start_.size()) return false;
    for (int along = 0; along < point.rows(); ++along) {
      members_.rows.push_back(along == 0 ? members_.points[s] : point.tangential + along - 1);
      members_.of_row.push_back(static_cast<int>(s));
    }
  }
  return true;
}

MovingPoints::Load MovingPoints::load(int number, const Vector& p, Vector& modal) noexcept {
  Load out;
  const Body& of = body(number);
  const auto joined = static_cast<Index>(of.candidates.joined());
  Eigen::Map<Eigen::Matrix3Xd> forces(flexibility_.displaced.data(), 3, joined);
  forces.setZero();
  for (std::size_t e = of.first_lever; e < of.last_lever; ++e) {
    const simd::Lever& lever = flexibility_.levers[e];
    Vector3d force = Vector3d::Zero();
    for (std::size_t x = 0; x < lever.rows; ++x)
      force -= p(static_cast<Index>(lever.first + x)) * Eigen::Map<const Vector3d>(lever.row[x]);
    out.force += force;
    out.torque += Eigen::Map<const Vector3d>(lever.arm).cross(force);
    for (std::size_t j = 0; j < lever.count; ++j)
      forces.col(static_cast<Index>(lever.at[j])) += lever.weight[j] * force;
  }
  for (Index k = 0; k < joined && of.candidates.has_static(); ++k)
    out.on_static +=
        forces.col(k).dot(of.candidates.static_change(of.candidates.at_place(static_cast<std::size_t>(k))));
  if (of.first_lever < of.last_lever) of.candidates.push(forces.data(), modal);
  return out;
}

/// On an end of a member, in the axes of its body [N].
Vector3d MovingPoints::force_on(const End& end, std::size_t member, const Vector& p) const noexcept {
  const Index first = position(member, 0);
  Vector3d out = -p(first) * end.direction.row(0).transpose();
  if (points_[static_cast<std::size_t>(members_.points[member])].tangential >= 0)
    out.noalias() -= end.direction.bottomRows<2>().transpose() * p.segment<2>(first + 1);
  return out;
}

void MovingPoints::write_frames(std::span<const FloatingBody> bodies, RowFrames& out) const noexcept {
  for (const int i : watched_) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    const FloatingBody& fixed = side(point.own(), bodies).state;
    const bool of_a = &point.own() == &point.end[0];
    const Vector3d x = fixed.position + fixed.axes * point.place_now, normal = normal_in_world(point, bodies),
                   opposite = x + (of_a ? 1 : -1) * (point.gap - u_(i)) * normal;
    out.point_a.row(i) = (of_a ? x : opposite).transpose();
    out.point_b.row(i) = (of_a ? opposite : x).transpose();
    const Matrix3d rows =
        members_.of_point[static_cast<std::size_t>(i)] >= 0 ? point.acting : in_world(point, bodies);
    out.normal.row(i) = rows.row(0);
    if (point.tangential >= 0)
      out.tangent.middleRows<2>(point.tangential - static_cast<Index>(points_.size())) = rows.bottomRows<2>();
  }
}

void MovingPoints::write_forces(const Vector& p, std::span<const FloatingBody> bodies,
                                std::vector<Vector>& out) noexcept {
  std::erase_if(forced_, [&](const std::array<int, 2>& one) {
    const auto& [number, candidate] = one;
    if (bodies[static_cast<std::size_t>(number)].asleep) return false;
    out[static_cast<std::size_t>(number)].segment<3>(3 * candidate).setZero();
    return true;
  });
  for (std::size_t s = 0; s < members_.points.size(); ++s)
    for (const End& end : points_[static_cast<std::size_t>(members_.points[s])].end) {
      const Vector3d force = end.body < 0 ? Vector3d::Zero() : force_on(end, s, p);
      if (force.isZero(0)) continue;
      for (std::size_t j = 0; j < static_cast<std::size_t>(end.count); ++j) {
        out[static_cast<std::size_t>(end.body)].segment<3>(3 * end.candidate[j]) += end.weight[j] * force;
        forced_.push_back({end.body, end.candidate[j]});
      }
    }
}

}  // namespace ricochet::contact
