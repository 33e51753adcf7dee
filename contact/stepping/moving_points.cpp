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

/// Points join if they are nearer than this many times the largest free approach of a point of their body in
/// the step, since contact may reverse the motion of a body within it.
constexpr double approaches = 3;

[[noreturn]] void refuse(const Model& model, const Rows::PairBlock& pair, const char* why) {
  throw InputError(base::format("contact between \"{}\" and \"{}\": {}", model.bodies[pair.a].name,
                                pair.b < 0 ? pair.obstacle : model.bodies[pair.b].name, why));
}

void check(const Model& model, const Rows::PairBlock& pair) {
  if (pair.b >= 0)
    refuse(model, pair,
           "with motion.rotation = \"finite\", bodies meet obstacles only. Name a body and an obstacle, or "
           "set \"linear\".");
  const kernels::Surface& surface = model.bodies[pair.a].kernel->surface;
  if (surface.components != 3 || surface.normal_residual || surface.whole)
    refuse(model, pair,
           "motion.rotation = \"finite\" needs kernels with all candidates in all components. Compute them "
           "for this scene with ricochet-kernel.");
}

}  // namespace

MovingPoints::MovingPoints(const Model& model, const StepSystem& system)
    : c_(system.c),
      folded_(Vector::Zero(model.omega.size())),
      modes_(model.points()),
      residual_(model.points()),
      M_(model.rows()),
      R_(model.rows()),
      S_(model.rows()),
      S_mean_(model.rows()) {
  for (const int n : model.folded.modes) folded_(n) = 1 / (model.omega(n) * model.omega(n));
  folds_ = !model.folded.modes.empty();
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Bodies::Block& block = model.bodies[k];
    const kernels::Surface& surface = block.kernel->surface;
    bodies_.push_back({.number = static_cast<int>(k),
                       .surface = &surface,
                       .modes = block.modes,
                       .elastic = block.modes - FloatingBody::rigid,
                       .first_elastic = block.first_mode + FloatingBody::rigid});
  }
  points_.resize(static_cast<std::size_t>(model.points()));
  for (const Rows::PairBlock& pair : model.pairs) {
    check(model, pair);
    const Bodies::Block& block = model.bodies[pair.a];
    Body& body = bodies_[static_cast<std::size_t>(pair.a)];
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      Point& point = points_[static_cast<std::size_t>(i)];
      const Selection::InnerIterator entry(model.selection[pair.a], i);
      point.body = pair.a;
      point.candidate = static_cast<int>(entry.col()) / 3;
      point.initial = model.point_a.row(i).transpose();
      point.place = block.rotation.transpose() * (point.initial - block.centre);
      point.row.row(0) = model.normal.row(i);
      point.gap = model.gap(i);
      body.points.push_back(i);
      body.radius = std::max(body.radius, point.place.norm());
      const auto omega = model.omega.segment(body.first_elastic, body.elastic).transpose().array();
      double give = (shape_of(point).colwise().squaredNorm().array() / omega.square()).sum();
      if (body.yields()) give += body.flexibility(point.candidate, point.candidate).trace();
      point.give = std::sqrt(give);
    }
  }
  for (const Rows::FrictionPoint& rubs : model.friction) {
    Point& point = points_[static_cast<std::size_t>(rubs.point)];
    point.tangential = rubs.tangential;
    point.row.bottomRows<2>() = model.tangent.middleRows<2>(rubs.tangential - model.points());
  }
  const auto m = static_cast<std::size_t>(model.points()), n = static_cast<std::size_t>(model.rows());
  for (std::vector<int>* x : {&watched_, &members_, &tangents_at_}) x->reserve(m);
  for (std::vector<int>* x : {&rows_, &owner_, &along_}) x->reserve(n);
  motion_.resize(m);
  is_watched_.assign(m, false);
  member_of_.assign(m, -1);
  for (Vector* x : {&start_, &free_, &u_}) x->setZero(model.rows());
  direction_.setZero(3, model.rows());
}

/// Distance of a point from the half-space, without its elastic displacement [m].
double MovingPoints::height(const Point& point, const FloatingBody& state) const noexcept {
  return point.gap - point.row.row(0).dot(state.position + state.attitude * point.place - point.initial);
}

double MovingPoints::clearance(int body, const FloatingBody& state, double energy) const noexcept {
  const double swing = std::sqrt(2 * energy);
  double least = std::numeric_limits<double>::infinity();
  for (const int i : bodies_[static_cast<std::size_t>(body)].points) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    least = std::min(least, height(point, state) - swing * point.give);
  }
  return least;
}

void MovingPoints::watch(std::span<const FloatingBody> bodies, std::span<const Travel> travels,
                         const MeanForce& forces) noexcept {
  std::fill(is_watched_.begin(), is_watched_.end(), false);
  watched_.clear();
  for (const Body& body : bodies_) {
    const Travel& travel = travels[static_cast<std::size_t>(body.number)];
    const FloatingBody& state = bodies[static_cast<std::size_t>(body.number)];
    const double swing = std::sqrt(2 * travel.energy);
    for (const int i : body.points) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      if (!(height(point, state) - swing * point.give < travel.distance) && forces.end()(i) == 0 &&
          forces.before()(i) == 0)
        continue;
      watched_.push_back(i);
      is_watched_[static_cast<std::size_t>(i)] = true;
    }
  }
  drop_members();
}

/// Keeps the members that are watched. Blocks move towards the front, in their order, so that none is
/// overwritten before it has moved.
void MovingPoints::drop_members() noexcept {
  const auto stays = [&](int i) { return static_cast<bool>(is_watched_[static_cast<std::size_t>(i)]); };
  if (std::all_of(members_.begin(), members_.end(), stays)) return;
  Index kept = 0;
  for (std::size_t s = 0; s < members_.size(); ++s) {
    if (!stays(members_[s])) continue;
    Index column = 0;
    for (std::size_t t = 0; t <= s; ++t) {
      if (!stays(members_[t])) continue;
      for (PointBlocks* blocks : {&modes_, &residual_})
        (*blocks)(kept, column) = Matrix3d((*blocks)(static_cast<Index>(s), static_cast<Index>(t)));
      ++column;
    }
    ++kept;
  }
  std::erase_if(members_, [&](int i) {
    if (!stays(i)) member_of_[static_cast<std::size_t>(i)] = -1;
    return !stays(i);
  });
  for (std::size_t s = 0; s < members_.size(); ++s)
    member_of_[static_cast<std::size_t>(members_[s])] = static_cast<int>(s);
}

void MovingPoints::place(std::span<const FloatingBody> bodies, const Vector& q) noexcept {
  for (const Body& body : bodies_) {
    const FloatingBody& state = bodies[static_cast<std::size_t>(body.number)];
    const Matrix3d A = state.attitude.toRotationMatrix();
    for (const int i : body.points) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      const Vector3d moved = state.position + A * point.place - point.initial;
      u_(i) = point.row.row(0).dot(moved);
      if (point.tangential >= 0)
        u_.segment<2>(point.tangential).noalias() = point.row.bottomRows<2>() * moved;
    }
  }
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const int i = watched_[k];
    const Point& point = points_[static_cast<std::size_t>(i)];
    const Body& body = bodies_[static_cast<std::size_t>(point.body)];
    const Vector3d w = shape_of(point) * q.segment(body.first_elastic, body.elastic);
    motion_[static_cast<std::size_t>(i)].place = point.place + w;
    const Vector3d turned = bodies[static_cast<std::size_t>(point.body)].attitude * w;
    u_(i) += point.row.row(0).dot(turned);
    if (point.tangential >= 0)
      u_.segment<2>(point.tangential).noalias() += point.row.bottomRows<2>() * turned;
  }
}

void MovingPoints::advance(std::span<const FloatingBody> bodies, const Vector& dq, double step,
                           const MeanForce& forces) noexcept {
  for (const int i : watched_) {
    const Point& point = points_[static_cast<std::size_t>(i)];
    const Body& body = bodies_[static_cast<std::size_t>(point.body)];
    const FloatingBody& state = bodies[static_cast<std::size_t>(point.body)];
    Motion& motion = motion_[static_cast<std::size_t>(i)];
    motion.free =
        state.attitude.conjugate() * (step * state.velocity + 0.5 * step * step * state.acceleration());
    motion.free += step * state.own_spin(state.momentum + 0.5 * step * state.torque).cross(motion.place);
    motion.free.noalias() += shape_of(point) * dq.segment(body.first_elastic, body.elastic);
  }
  for (const Body& body : bodies_) {
    double fastest = 0;
    for (const int i : watched_)
      if (points_[static_cast<std::size_t>(i)].body == body.number)
        fastest = std::max(fastest, motion_[static_cast<std::size_t>(i)].free.norm());
    for (const int i : watched_) {
      const Point& point = points_[static_cast<std::size_t>(i)];
      if (point.body != body.number || member_of_[static_cast<std::size_t>(i)] >= 0) continue;
      if (point.gap - u_(i) < approaches * fastest || forces.end()(i) != 0 || forces.before()(i) != 0)
        join(i);
    }
  }
  list_rows();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const int i = members_[static_cast<std::size_t>(owner_[k])];
    const Point& point = points_[static_cast<std::size_t>(i)];
    const FloatingBody& state = bodies[static_cast<std::size_t>(point.body)];
    const auto at = static_cast<Index>(k);
    direction_.col(at) = state.attitude.conjugate() * Vector3d(point.row.row(along_[k]).transpose());
    start_(at) = u_(rows_[k]);
    free_(at) = start_(at) + direction_.col(at).dot(motion_[static_cast<std::size_t>(i)].free);
  }
}

/// Adds a point to those that may touch, and gathers its blocks with the others of its body.
void MovingPoints::join(int number) noexcept {
  const auto s = static_cast<Index>(members_.size());
  member_of_[static_cast<std::size_t>(number)] = static_cast<int>(s);
  members_.push_back(number);
  for (PointBlocks* blocks : {&modes_, &residual_}) blocks->resize(s + 1);
  const Point& point = points_[static_cast<std::size_t>(number)];
  const Body& body = bodies_[static_cast<std::size_t>(point.body)];
  const auto own = shape_of(point);
  const auto c = c_.segment(body.first_elastic, body.elastic).transpose(),
             folded = folded_.segment(body.first_elastic, body.elastic).transpose();
  // Φ d Φᵀ, entry by entry: a product of matrices would allocate.
  const auto block = [&](const auto& diagonal, const auto& other) {
    Matrix3d out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(i, j) = own.row(i).cwiseProduct(diagonal).dot(other.row(j));
    return out;
  };
  for (Index t = 0; t <= s; ++t) {
    const Point& other = points_[static_cast<std::size_t>(members_[static_cast<std::size_t>(t)])];
    if (other.body != point.body) {
      modes_(s, t).setZero();
      residual_(s, t).setZero();
      continue;
    }
    modes_(s, t) = block(c, shape_of(other));
    if (body.yields())
      residual_(s, t) = body.flexibility(point.candidate, other.candidate);
    else
      residual_(s, t).setZero();
    if (folds_) residual_(s, t) += block(folded, shape_of(other));
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
    const FloatingBody& state = bodies[static_cast<std::size_t>(point.body)];
    const Matrix3d lever = cross_matrix(motion_[static_cast<std::size_t>(members_[s])].place);
    const Matrix3d turns = -share * lever * state.inertia.inverse;
    for (std::size_t t = 0; t <= s; ++t) {
      const Point& other = points_[static_cast<std::size_t>(members_[t])];
      const bool same = other.body == point.body;
      Matrix3d modes = Matrix3d::Zero(), residual = modes;
      if (same) {
        modes.noalias() = turns * cross_matrix(motion_[static_cast<std::size_t>(members_[t])].place);
        modes.diagonal().array() += share / state.mass;
        modes += modes_(static_cast<Index>(s), static_cast<Index>(t));
        residual = residual_(static_cast<Index>(s), static_cast<Index>(t));
      }
      for (int i = 0; i < rows_of(point); ++i) {
        const Index row = position(s, i);
        const Vector3d in_modes = modes.transpose() * direction_.col(row),
                       in_residual = residual.transpose() * direction_.col(row);
        for (int j = 0; j < rows_of(other); ++j) {
          const Index column = position(t, j);
          M(row, column) = M(column, row) = in_modes.dot(direction_.col(column));
          R(row, column) = R(column, row) = in_residual.dot(direction_.col(column));
        }
      }
    }
  }
  S = M + R;
  if (a > 0) S_mean = a * M + R;
  return {.M = M, .R = R, .S = S, .S_mean = S_mean};
}

MovingPoints::Load MovingPoints::load(int number, const Vector& p, Vector& modal) const noexcept {
  Load out;
  const Body& body = bodies_[static_cast<std::size_t>(number)];
  for (std::size_t s = 0; s < members_.size(); ++s) {
    const Point& point = points_[static_cast<std::size_t>(members_[s])];
    if (point.body != number) continue;
    Vector3d force = Vector3d::Zero();
    for (int i = 0; i < rows_of(point); ++i) {
      const Index at = i == 0 ? static_cast<Index>(s) : static_cast<Index>(tangents_at_[s] + i - 1);
      force -= p(at) * direction_.col(at);
    }
    if (force.isZero(0)) continue;
    out.force += force;
    out.torque += motion_[static_cast<std::size_t>(members_[s])].place.cross(force);
    modal.segment(body.first_elastic, body.elastic).noalias() += shape_of(point).transpose() * force;
  }
  return out;
}

}  // namespace ricochet::contact
