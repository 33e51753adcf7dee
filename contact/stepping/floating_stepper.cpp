// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/floating_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Bodies rest if their speeds are below this share of the speed of a fall by their own size, and if their
/// forces have changed by less than this share since the last search, for some searches in a row. A bounce is
/// slow at its turning point, but then its forces change.
constexpr double resting = 1e-9;
constexpr int searches_at_rest = 8;

/// Largest angle by which a body may turn in a contact step at the start [rad]. The geometry of a step is
/// that of its middle.
constexpr double largest_turn = 1;

/// Steps between two searches: long enough that a search costs little, short enough that few points are
/// watched.
constexpr int search_every = 16;

void check(const Model& model, const StepOptions& options) {
  if (options.scheme != Scheme::compliant)
    throw InputError(
        "motion.rotation = \"finite\": needs contact.scheme = \"compliant\". Choose it, or set \"linear\".");
  for (const Model::Forcing& one : model.forcing)
    throw InputError(base::format(
        "loads: \"{}\": motion.rotation = \"finite\" allows gravity alone. Leave the load out, or set "
        "\"linear\".",
        one.name));
}

std::vector<Islands::Sides> sides_of(const Model& model) {
  std::vector<Islands::Sides> out;
  for (const Model::PairBlock& pair : model.pairs) out.push_back({pair.a, pair.b});
  return out;
}

}  // namespace

FloatingStepper::FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : Stepper(options, *model),
      state_((check(*model, options), model), options),
      bodies_(floating_bodies(*model)),
      kept_(bodies_),
      turning_(*initial_turning(*model, options)),
      points_(*model, *state_.system),
      travels_(bodies_.size()),
      islands_(static_cast<int>(bodies_.size()), sides_of(*model)),
      // A moving obstacle may speed a body up; without it, the energy of a body bounds its motion.
      epoch_(model->belts.empty() ? search_every : 1),
      stored_(model->pairs.size(), 0),
      before_(contact_.mean),
      over_(*state_.system) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const double turn = turning_.poses[k].spin.norm() * options.step;
    if (!(turn <= largest_turn))
      throw InputError(
          base::format("bodies.{}.angular_velocity: turns the body by {:.3g} rad in a contact step, above "
                       "{}. Raise time.contact_rate_hz, or lower it.",
                       model->bodies[k].name, turn, largest_turn));
  }
  for (Vector* x : {&dq_, &modal_force_}) x->setZero(model->omega.size());
  for (Vector* x : {&rest_, &rest_force_}) x->setZero(model->rows());
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    travels_[k].distance = std::numeric_limits<double>::infinity();  // the first call finds all feet
  points_.watch(bodies_, travels_, contact_.mean);
  points_.place(bodies_, state_.q);
  points_.write_frames(bodies_, turning_.frames);
  u_ = points_.all();
}

/// ½q̇² + ½ω²q² of the elastic modes of a body [J].
double FloatingStepper::elastic_energy(const FloatingBody& body) const noexcept {
  const auto of = [&](const Vector& x) { return x.segment(body.first_elastic(), body.elastic()).array(); };
  return 0.5 * (of(state_.v).square() + of(state_.system->stiffness) * of(state_.q).square()).sum();
}

/// Largest elastic energy that a body may reach with the energy E [J]. Under constant loads, the state swings
/// about the static one. In the norm of the energy, it is now at most √E + √E_0 from there, and there at √E_0
/// from 0.
double FloatingStepper::swing_energy(const FloatingBody& body, double energy) const noexcept {
  const auto of = [&](const Vector& x) { return x.segment(body.first_elastic(), body.elastic()).array(); };
  const double at_rest = 0.5 * (of(state_.system->stiffness) * of(state_.system->q0).square()).sum(),
               root = std::sqrt(energy) + 2 * std::sqrt(at_rest);
  return root * root;
}

StepStatus FloatingStepper::step() noexcept {
  if (at_rest_ >= searches_at_rest) {
    contact_.persistency = 0;
    ++steps_;
    return StepStatus::ok;
  }
  if (contact_.mean.begins())
    if (const int crossed = cross(); crossed > 0) {
      land(crossed);
      u_ = points_.all();
      return StepStatus::ok;
    }
  const StepSystem& system = *state_.system;
  Slip* const slip = contact_.slip.any() ? &contact_.slip : nullptr;
  if (steps_ >= search_at_) search();
  kept_ = bodies_;
  before_ = contact_.mean;
  const auto undo = [&](StepStatus status) {
    bodies_ = kept_;
    contact_.mean = before_;
    points_.place(bodies_, state_.q);
    return status;
  };
  for (FloatingBody& body : bodies_) body.drift(0.5 * options_.step);
  contact_.slip.begin(system.model->belts, steps_ + 1);
  dq_.array() = system.b.array() * state_.v.array() +
                system.c.array() * (system.load.array() - system.stiffness.array() * state_.q.array());
  points_.advance(bodies_, dq_, options_.step, contact_.mean);
  law_.hold(points_.rows());
  law_.change_matrices();
  if (!state_.system->springs.empty())
    for (std::size_t j = 0; j < points_.rows().size(); ++j)
      if (const auto spring = points_.spring(j)) law_.spring(points_.rows()[j]) = *spring;
  const StepMatrices matrices =
      points_.matrices(bodies_, options_.step, contact_.mean.is_conserving() ? conserving_mean.end : 0);
  carry_forces(matrices);
  const auto k = std::ssize(points_.rows());
  law_.start.head(k) = points_.at_start().head(k) - rest_.head(k);
  law_.free.head(k) = points_.free().head(k);
  const StepTrial trial = law_.solve(matrices, contact_.mean, slip);
  if (!has_forces(trial.status)) return undo(failure(trial.status));
  const Work work = kick(trial);
  for (FloatingBody& body : bodies_) body.drift(0.5 * options_.step);
  if (!commit(work, trial.in_residual)) return undo(StepStatus::not_finite);
  return end(trial);
}

/// Counts searches that find all bodies at rest.
void FloatingStepper::look_for_rest() noexcept {
  bool rests = contact_.active > 0 && state_.system->model->belts.empty() &&
               (contact_.force - rest_force_).norm() <= resting * contact_.force.norm();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const FloatingBody& body = bodies_[k];
    const double fall =
                     body.mass * state_.system->model->gravity.norm() * points_.radius(static_cast<int>(k)),
                 kinetic = body.kinetic() +
                           0.5 * state_.v.segment(body.first_elastic(), body.elastic()).squaredNorm();
    rests = rests && body.torque.isZero(0) && kinetic <= resting * resting * fall;
  }
  at_rest_ = rests ? at_rest_ + 1 : 0;
  rest_force_ = contact_.force;
}

/// Finds the points that may touch before the next search.
void FloatingStepper::search() noexcept {
  look_for_rest();
  set_travels(epoch_ * options_.step);
  points_.watch(bodies_, travels_, contact_.mean);
  points_.place(bodies_, state_.q);
  search_at_ = steps_ + epoch_;
}

/// Bounds what each body may do in a time. Contact passes energy on but does not add any, so that a body has
/// at most the energy of all bodies that may reach each other in this time, directly or through others.
void FloatingStepper::set_travels(double time) noexcept {
  const Model& model = *state_.system->model;
  islands_.separate();
  for (bool joined = true; joined;) {
    joined = false;
    for (int k = 0; k < static_cast<int>(bodies_.size()); ++k) {
      double energy = state_.energy().residual, mass = 0, g = 0;
      for (int j = 0; j < static_cast<int>(bodies_.size()); ++j) {
        if (!islands_.same(k, j)) continue;
        const FloatingBody& body = bodies_[static_cast<std::size_t>(j)];
        // A torque from outside may speed a body up beyond its energy, as moving obstacles may.
        energy +=
            (body.torque.isZero(0) && model.belts.empty() ? 1 : 2) * (body.kinetic() + elastic_energy(body));
        mass += body.mass;
        g = std::max(g, body.acceleration().norm());
      }
      energy += g * time * (std::sqrt(2 * energy * mass) + 0.5 * mass * g * time);  // the work of gravity
      const FloatingBody& body = bodies_[static_cast<std::size_t>(k)];
      const double speed = std::sqrt(2 * energy * body.inverse_mass) +
                           points_.radius(k) * std::sqrt(2 * energy * body.inertia.largest_inverse);
      travels_[static_cast<std::size_t>(k)] = {swing_energy(body, energy),
                                               time * speed + 0.5 * time * time * body.acceleration().norm()};
    }
    for (int pair = 0; pair < islands_.pairs(); ++pair)
      if (!islands_.joins(pair) &&
          points_.may_meet(model.pairs[static_cast<std::size_t>(pair)], bodies_, travels_)) {
        islands_.join(pair);
        joined = true;
      }
  }
}

/// Of a row in this step; without a bulge, it yields nothing.
PatchSpring FloatingStepper::spring_of(int row) noexcept {
  return row < points() && !state_.system->springs.empty() ? law_.spring(row) : PatchSpring{};
}

/// Sets rest_ to R p + s(λ) of the forces at the start, whose energy R has changed by its turn.
void FloatingStepper::carry_forces(const StepMatrices& matrices) noexcept {
  const auto rows = points_.rows();
  const Model& model = *state_.system->model;
  const auto product = [&] {
    rest_.head(std::ssize(rows)).setZero();
    for (std::size_t j = 0; j < rows.size(); ++j)
      if (const double p = end_force()(rows[j]); p != 0)
        rest_.head(std::ssize(rows)) += p * matrices.R.col(static_cast<Index>(j));
  };
  product();
  const auto pairs = static_cast<int>(model.pairs.size());
  const bool springs = !state_.system->springs.empty();
  islands_.separate();
  for (int pair = 0; pair < pairs; ++pair)
    if (contact_.mean.pairs()[static_cast<std::size_t>(pair)].carries) islands_.join(pair);
  islands_.assign();
  bool reduced = false;
  for (int island = 0; island < islands_.count(); ++island) {
    double now = 0, missing = 0;
    for (std::size_t j = 0; j < rows.size(); ++j)
      if (islands_.of(points_.pair_of(j)) == island) {
        const double p = end_force()(rows[j]);
        now += 0.5 * p * rest_(static_cast<Index>(j));
        if (const PatchSpring spring = spring_of(rows[j]); spring.bulge > 0) now += spring.energy(p);
      }
    missing = now;
    for (int pair = 0; pair < pairs; ++pair)
      if (islands_.of(pair) == island) missing -= stored_[static_cast<std::size_t>(pair)];
    for (int pair = 0; pair < pairs; ++pair)
      if (islands_.of(pair) == island) missing = contact_.mean.draw(pair, missing);
    if (!(missing > 0)) continue;
    // The energy of forces x p is at most x² of the present one in R, and x of that in springs.
    const double left = std::max(0.0, 1 - missing / now), share = springs ? left : std::sqrt(left);
    for (int pair = 0; pair < pairs; ++pair)
      if (islands_.of(pair) == island) contact_.mean.reduce(pair, share);
    reduced = true;
  }
  if (reduced) product();
  for (std::size_t j = 0; j < rows.size(); ++j)
    if (const PatchSpring spring = spring_of(rows[j]); spring.bulge > 0)
      rest_(static_cast<Index>(j)) += spring.displacement(end_force()(rows[j]));
}

/// Changes velocities, angular momenta and modes by the mean forces of the step.
Work FloatingStepper::kick(const StepTrial& trial) noexcept {
  const StepSystem& system = *state_.system;
  const double step = options_.step;
  double pushed = 0;
  modal_force_.setZero();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    FloatingBody& body = bodies_[k];
    const MovingPoints::Load load = points_.load(static_cast<int>(k), law_.force(), modal_force_);
    pushed += body.kick(load.force, load.torque, step);
  }
  Work work = work_of(trial, trial.at_start);
  work.damping = move_modes(system);
  work.forcing = pushed;
  return work;
}

/// Moves the elastic modes under constant forces. Returns what their damping dissipates [J].
double FloatingStepper::move_modes(const ModeConstants& over) noexcept {
  double dissipated = 0;
  for (const FloatingBody& body : bodies_)
    for (Index n = body.first_elastic(); n < body.first_elastic() + body.elastic(); ++n) {
      const double q = state_.q(n), v = state_.v(n),
                   g = state_.system->load(n) + modal_force_(n) - state_.system->stiffness(n) * q;
      dissipated += over.damp_ss(n) * g * g + over.damp_sr(n) * g * v + over.damp_rr(n) * v * v;
      state_.next_q(n) = q + over.b(n) * v + over.c(n) * g;
      state_.next_v(n) = over.e(n) * v + over.h(n) * g;
    }
  return dissipated;
}

/// Makes next_q and next_v the state, with the rigid rates of the frames.
bool FloatingStepper::commit(const Work& work, double residual) noexcept {
  Energy now{.residual = residual};
  for (const FloatingBody& body : bodies_) {
    state_.next_q.segment(body.first_mode, body.frame_modes).setZero();
    body.write_rates(state_.next_v);
    const auto of = [&](const Vector& x) { return x.segment(body.first_elastic(), body.elastic()).array(); };
    now.kinetic += body.kinetic() + 0.5 * of(state_.next_v).square().sum();
    now.strain += 0.5 * (of(state_.system->stiffness) * of(state_.next_q).square()).sum();
    now.loads += body.work_of_gravity() +
                 (of(state_.system->load) * (of(state_.next_q) - of(state_.system->q0))).sum();
  }
  if (!state_.ledger.close(now, work)) return false;
  state_.q.swap(state_.next_q);
  state_.v.swap(state_.next_v);
  for (std::size_t k = 0; k < bodies_.size(); ++k) turning_.poses[k] = bodies_[k].pose();
  points_.place(bodies_, state_.q);
  points_.write_frames(bodies_, turning_.frames);
  return true;
}

/// Completes a step that is committed.
StepStatus FloatingStepper::end(const StepTrial& trial) noexcept {
  next_force_.setZero();
  next_end_.setZero();
  next_u_ = points_.all();
  double power = 0;
  std::fill(stored_.begin(), stored_.end(), 0.0);
  const auto rows = points_.rows();
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto at = static_cast<Index>(j);
    const int row = rows[j];
    next_force_(row) = law_.force()(at);
    const double p = next_end_(row) = law_.end()(at);
    double yielded = law_.yielded()(at), stored = 0;
    const double moved = law_.u()(at) - law_.start(at);
    // Where points slide, tangential displacements add up from step to step.
    next_u_(row) = row >= points() && points_.slides(j) ? u_(row) + moved : next_u_(row) - yielded;
    if (row < points()) power -= next_force_(row) * moved / options_.step;
    if (const PatchSpring spring = spring_of(row); spring.bulge > 0 && p > 0) {
      yielded -= spring.displacement(p);
      stored = spring.energy(p);
    }
    stored_[static_cast<std::size_t>(points_.pair_of(j))] += stored + 0.5 * p * yielded;
  }
  if (trial.several) ++contact_.ambiguous;
  points_.write_forces(law_.end(), turning_.candidate_force);
  return complete(static_cast<int>((next_end_.head(points()).array() > 0).count()), power, trial.violation);
}

bool FloatingStepper::push(int number, const Vector3d& force, const Vector3d& torque) noexcept {
  FloatingBody& body = bodies_[static_cast<std::size_t>(number)];
  body.push = force;
  body.torque = torque;
  search_at_ = clear_until_ = steps_;  // what was known of its motion no longer holds
  at_rest_ = 0;
  return true;
}

/// Flies to the next output sample, if nothing can touch before it. Returns the number of steps crossed.
int FloatingStepper::cross() noexcept {
  for (const FloatingBody& body : bodies_)
    if (!body.torque.isZero(0)) return 0;
  const auto steps = static_cast<int>(options_.steps_per_sample - steps_ % options_.steps_per_sample);
  if (steps_ + steps > clear_until_) {
    double clear = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      travels_[k].energy = swing_energy(bodies_[k], elastic_energy(bodies_[k]));
    for (const Model::PairBlock& pair : state_.system->model->pairs) {
      const double way = points_.clearance(pair, bodies_, travels_);
      Vector3d acceleration = Vector3d::Zero();
      double speed = 0;
      for (const int k : {pair.a, pair.b}) {
        if (k < 0) continue;
        const FloatingBody& body = bodies_[static_cast<std::size_t>(k)];
        speed +=
            body.velocity.norm() + body.momentum.norm() * body.inertia.largest_inverse * points_.radius(k);
        acceleration += (k == pair.a ? 1 : -1) * body.acceleration();
      }
      const double g = acceleration.norm();
      // The time in which speed · t + g t²/2 reaches `way`.
      const double time = way > 0 ? 2 * way / (speed + std::sqrt(speed * speed + 2 * g * way)) : 0;
      clear = std::min(clear, time);
    }
    constexpr double longest = 1e9;  // steps, so that the sum fits
    clear_until_ = steps_ + static_cast<std::int64_t>(std::min(clear / options_.step, longest));
  }
  if (steps_ + steps > clear_until_) return 0;
  set_flight(steps);
  kept_ = bodies_;
  for (FloatingBody& body : bodies_) body.fly(steps * options_.step);
  modal_force_.setZero();
  Work work{.damping = move_modes(over_)};
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    work.forcing += bodies_[k].push.dot(bodies_[k].position - kept_[k].position);
  if (!commit(work, 0)) {
    bodies_ = kept_;
    return 0;
  }
  search_at_ = steps_ + steps;
  return steps;
}

/// Sets the constants of modes over a flight of some steps.
void FloatingStepper::set_flight(int steps) noexcept {
  if (steps == constants_of_) return;
  constants_of_ = steps;
  const Model& model = *state_.system->model;
  for (Index n = 0; n < model.omega.size(); ++n)
    if (state_.system->h(n) != 0) over_.set_step(n, model.omega(n), model.decay(n), steps * options_.step);
}

}  // namespace ricochet::contact
