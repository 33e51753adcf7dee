// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/figures/receivers.hpp"
#include "contact/figures/spectrum.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/run_steps.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// A body that can move rigidly, with the number of its rigid modes, which come first among its modes.
struct Mover {
  int body;
  Eigen::Index rigid;
};

std::vector<Mover> movers(const Model& model) {
  std::vector<Mover> out;
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Model::BodyBlock& body = model.bodies[k];
    const auto omega = model.omega.segment(body.first_mode, body.modes).array();
    if (const Eigen::Index rigid = (omega == 0).count(); rigid > 0)
      out.push_back({static_cast<int>(k), rigid});
  }
  return out;
}

/// Mean velocity [m/s] and angular velocity [rad/s] of a body.
struct RigidVelocity {
  Vector3d velocity = Vector3d::Zero(), spin = Vector3d::Zero();
};

/// Whether the body has the six rigid modes of a solid, and hence a spin.
bool turns(const Mover& mover) { return mover.rigid == 6; }

/// Motion of each body; 0 if supports hold it. The rigid modes of a free body carry all of its momentum and
/// no vibration.
std::vector<RigidVelocity> motions(const Model& model, const std::vector<Mover>& movers, const Vector& v) {
  std::vector<RigidVelocity> out(model.bodies.size());
  for (const Mover& mover : movers) {
    const Model::BodyBlock& body = model.bodies[mover.body];
    const auto rate = v.segment(body.first_mode, mover.rigid);
    RigidVelocity& motion = out[mover.body];
    motion.velocity = body.momentum.leftCols(mover.rigid) * rate / body.mass;
    if (!turns(mover)) continue;
    const Vector3d about_centre =
        body.angular_momentum.leftCols(mover.rigid) * rate - body.centre.cross(body.mass * motion.velocity);
    motion.spin = body.inertia.ldlt().solve(about_centre);
  }
  return out;
}

double approach(const Model& model, const std::vector<RigidVelocity>& motion) {
  double fastest = 0;
  for (const Model::PairBlock& pair : model.pairs) {
    Vector3d relative = motion[pair.a].velocity;
    if (pair.b >= 0) relative -= motion[pair.b].velocity;
    const Vector3d normal = model.normal.middleRows(pair.first_point, pair.points).colwise().mean();
    fastest = std::max(fastest, relative.dot(normal));
  }
  return fastest;
}

/// Gathers the quantities of an impact step by step.
class Follower {
 public:
  Follower(const Model& model, const StepOptions& options, bool receivers)
      : model_(model),
        step_(options.step),
        moving_(movers(model)),
        start_(motions(model, moving_, model.initial_rates())),
        end_(start_),
        pressed_(model.gap.size(), false),
        linearity_(model, 0) {
    if (receivers && !model.receivers.empty()) receivers_.emplace(model, options);
    heard_.resize(3 * model.receivers.size());
    before_.kinetic = model.initial_rates().squaredNorm() / 2;
  }

  void observe(const Stepper& stepper) {
    const std::int64_t passed = stepper.steps() - last_;
    last_ = stepper.steps();
    const double force = stepper.force().head(stepper.points()).sum();
    without_force_ += passed;
    if (force > 0) {
      force_.resize(force_.size() + static_cast<std::size_t>(without_force_), 0.0);
      force_.back() = force;
      without_force_ = 0;
    }
    if (receivers_) listen(stepper, passed);
    if (force > 0) {
      if (!touched_) energy_ = before_;
      touched_ = true;
      touch_ = open_ > std::max<std::int64_t>(2, touch_ / 10) ? 1 : touch_ + open_ + 1;
      open_ = 0;
      longest_ = std::max(longest_, static_cast<double>(touch_) * step_);
      linearity_.observe(stepper, stepper.modal()->v, false);
      end_ = motions(model_, moving_, stepper.modal()->v);
      end_energy_ = stepper.modal()->energy();
      for (Eigen::Index i = 0; i < stepper.points(); ++i)
        if (stepper.force()[i] > 0) pressed_[static_cast<std::size_t>(i)] = true;
      return;
    }
    open_ += passed;
    if (touched_) return;
    Eigen::Index nearest = 0;
    const double distance = (model_.gap - stepper.displacement().head(stepper.points())).minCoeff(&nearest);
    if (distance < missed_by_) {
      missed_by_ = distance;
      spacing_there_ = std::sqrt(model_.area[nearest]);
    }
    start_ = end_ = motions(model_, moving_, stepper.modal()->v);
    before_ = stepper.modal()->energy();
  }

  Quantities quantities(const Stepper& stepper) const {
    Quantities out;
    double impulse = 0, peak = 0, contact = 0;
    for (const double force : force_) {
      impulse += force * step_;
      peak = std::max(peak, force);
      contact += force > 0 ? step_ : 0;
    }
    const auto relative_to_itself = [](double value) { return Figure{Vector::Constant(1, value), value}; };
    out.figures[Quantity::impulse] = relative_to_itself(impulse);
    out.figures[Quantity::peak_force] = relative_to_itself(peak);
    out.figures[Quantity::duration] = relative_to_itself(contact);
    add_motion(out);
    add_energy(out, stepper);
    if (receivers_) add_receivers(out);
    out.longest_touch = longest_;
    out.force = force_;
    out.pressed = pressed_;
    out.nearer = linearity_.nearer();
    if (!touched_) {
      out.missed_by = missed_by_;
      out.spacing_there = spacing_there_;
    }
    return out;
  }

 private:
  void listen(const Stepper& stepper, std::int64_t passed) {
    receivers_->observe(stepper);
    for (std::size_t k = 0; k < receivers_->size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        heard_[3 * k + axis].resize(heard_[3 * k + axis].size() + static_cast<std::size_t>(passed),
                                    (*receivers_)[k].velocity[static_cast<Eigen::Index>(axis)]);
  }

  void add_motion(Quantities& out) const {
    double speed = approach(model_, start_);
    for (const Mover& mover : moving_)
      speed = std::max(speed, (end_[mover.body].velocity - start_[mover.body].velocity).norm() / 2);
    Figure rebound{Vector(3 * moving_.size()), speed}, spin{Vector::Zero(3 * moving_.size()), speed};
    for (std::size_t k = 0; k < moving_.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(3 * k);
      const Model::BodyBlock& body = model_.bodies[moving_[k].body];
      rebound.value.segment<3>(row) = end_[moving_[k].body].velocity;
      // The spin times the radius of gyration is a speed.
      if (turns(moving_[k]))
        spin.value.segment<3>(row) =
            std::sqrt(body.inertia.trace() / (2 * body.mass)) * end_[moving_[k].body].spin;
    }
    out.figures[Quantity::rebound] = rebound;
    if (std::ranges::any_of(moving_, turns)) out.figures[Quantity::spin] = spin;
  }

  void add_energy(Quantities& out, const Stepper& stepper) const {
    const Energy& end = touched_ ? end_energy_ : stepper.modal()->energy();
    double rigid = 0;
    for (const Mover& mover : moving_) {
      const Model::BodyBlock& body = model_.bodies[mover.body];
      const RigidVelocity& motion = end_[mover.body];
      rigid += (body.mass * motion.velocity.squaredNorm() + motion.spin.dot(body.inertia * motion.spin)) / 2;
    }
    Figure energy{Vector(2), energy_.kinetic + energy_.strain};
    energy.value << end.kinetic + end.strain + end.residual - rigid, end.damping + end.contact;
    // Bodies that are pressed together from rest have no energy at the start.
    if (!(energy.scale > 0)) energy.scale = energy.value.cwiseAbs().maxCoeff();
    out.figures[Quantity::energy] = energy;
  }

  void add_receivers(Quantities& out) const {
    Figure bands;
    for (const std::vector<double>& velocity : heard_) {
      const Vector one = third_octaves(velocity, step_);
      bands.value.conservativeResize(bands.value.size() + one.size());
      bands.value.tail(one.size()) = one;
    }
    bands.scale = bands.value.norm();
    out.figures[Quantity::receivers] = bands;
  }

  const Model& model_;
  double step_;
  std::vector<Mover> moving_;
  std::vector<RigidVelocity> start_, end_;  ///< when contact began, when it last ended
  Energy before_{}, energy_{}, end_energy_{};
  std::vector<bool> pressed_;
  LinearityCheck linearity_;
  std::vector<double> force_;
  std::int64_t without_force_ = 0;  ///< steps since the last force
  std::optional<Receivers> receivers_;
  std::vector<std::vector<double>> heard_;  ///< velocity of each axis of each receiver [m/s]
  double longest_ = 0, missed_by_ = std::numeric_limits<double>::infinity(), spacing_there_ = 0;
  std::int64_t last_ = 0, touch_ = 0, open_ = 0;  ///< steps made, of the last touch, and since it opened
  bool touched_ = false;
};

}  // namespace

bool Quantities::touched() const {
  const auto push = figures.find(figures.contains(Quantity::impulse) ? Quantity::impulse : Quantity::force);
  return push != figures.end() && push->second.value.maxCoeff() > 0;
}

Errors distances(const Quantities& a, const Quantities& b) {
  Errors out;
  for (const auto& [quantity, one] : a.figures) {
    const double apart = (one.value - b.figures.at(quantity).value).norm();
    out[quantity] = apart == 0      ? 0
                    : one.scale > 0 ? apart / one.scale
                                    : std::numeric_limits<double>::infinity();
  }
  return out;
}

std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, bool receivers,
                                            const std::function<void()>& poll) {
  const std::shared_ptr<const Model> folded = fold(borrowed(model), options);
  const std::unique_ptr<Stepper> stepper = make_stepper(folded, options);
  Follower follower(*folded, options, receivers);
  const auto observe = [&](std::int64_t) {
    if (poll) poll();
    follower.observe(*stepper);
  };
  if (run_steps(*stepper, steps, observe).status != StepStatus::ok) return std::nullopt;
  return follower.quantities(*stepper);
}

Quantities rest_quantities(const Model& model) {
  const EquilibriumSummary found = summarise(model, find_equilibrium(model));
  Figure force, approach;
  const auto pairs = static_cast<Eigen::Index>(found.pairs.size());
  force.value.resize(pairs);
  approach.value.resize(pairs);
  for (Eigen::Index p = 0; p < pairs; ++p) {
    force.value[p] = found.pairs[static_cast<std::size_t>(p)].force_n;
    approach.value[p] = found.pairs[static_cast<std::size_t>(p)].approach_m;
  }
  force.scale = force.value.norm();
  approach.scale = approach.value.norm();
  return {.figures = {{Quantity::force, force}, {Quantity::approach, approach}}};
}

}  // namespace ricochet::contact
