// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/floating_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/archive.hpp"
#include "base/format.hpp"
#include "contact/simd/dense.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Largest angle by which a body may turn in a contact step at the start [rad]. The geometry of a step is
/// that of its middle.
constexpr double largest_turn = 1;

/// Steps between two searches: long enough that a search costs little, short enough that few points are
/// watched.
constexpr int search_every = 16;

void check(const StepOptions& options) {
  if (options.contact.scheme != Scheme::compliant)
    throw InputError(
        "motion.rotation = \"finite\": needs contact.scheme = \"compliant\". Choose it, or set \"linear\".");
}

std::vector<Islands::Sides> sides_of(const Model& model) {
  std::vector<Islands::Sides> out;
  for (const Model::PairBlock& pair : model.pairs) out.push_back({pair.a, pair.b});
  return out;
}

}  // namespace

FloatingStepper::FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options,
                                 const MovingPoints* earlier)
    : Stepper(options, *model),
      state_((check(options), model), options),
      bodies_(floating_bodies(*model)),
      start_{.bodies = bodies_, .q = {}, .v = {}, .end = {}, .pairs = contact_.mean.pairs()},
      coriolis_(coriolis_of(*state_.system->model)),
      mixes_(!std::ranges::all_of(coriolis_, &Coriolis::empty)),
      turning_(*initial_turning(*model, options)),
      points_(*model, *state_.system, earlier),
      loads_(*state_.system->model, bodies_, state_.forcing, points_),
      travels_(bodies_.size()),
      islands_(static_cast<int>(bodies_.size()), sides_of(*model)),
      // A moving obstacle may speed a body up; without it, the energy of a body bounds its motion.
      search_{.every = model->belts.empty() ? search_every : 1},
      carries_(bodies_.size()),
      energy_of_(bodies_.size()),
      thrown_(bodies_.size()),
      stored_(model->pairs.size(), 0),
      flight_{.over = ModeConstants(*state_.system), .turned = std::vector<Eigen::Vector3d>(bodies_.size())} {
  for (Vector* x : {&dq_, &modal_force_, &displaced_, &start_.q, &start_.v}) x->setZero(model->omega.size());
  for (Vector* x : {&rest_, &start_.end}) x->setZero(capacity_of(*model));
  for (std::vector<int>* x : {&forced_.now, &forced_.before, &forced_.asleep})
    x->reserve(static_cast<std::size_t>(model->rows()));
  slow_since_.resize(bodies_.size());
  rests_.resize(bodies_.size());
}

FloatingStepper::FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : FloatingStepper(model, options, nullptr) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    check_spin(model->bodies[k].name, turning_.poses[k].spin);
    travels_[k].distance = std::numeric_limits<double>::infinity();  // the first call finds all feet
  }
  points_.watch(bodies_, travels_, contact_.mean);
  place(0);
  points_.write_frames(bodies_, turning_.frames);
}

void FloatingStepper::check_spin(const std::string& name, const Vector3d& spin) const {
  const double turn = spin.norm() * options_.step;
  if (!(turn <= largest_turn))
    throw InputError(
        base::format("bodies.{}.angular_velocity: turns the body by {:.3g} rad in a contact step, above {}. "
                     "Raise time.contact_rate_hz, or lower it.",
                     name, turn, largest_turn));
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
  double at_rest = 0;
  const Vector &load = state_.forcing.piece().load, &stiffness = state_.system->stiffness;
  for (Index n = body.first_elastic(); n < body.first_elastic() + body.elastic(); ++n)
    if (load(n) != 0 && stiffness(n) > 0) at_rest += 0.5 * load(n) * load(n) / stiffness(n);
  const double root = std::sqrt(energy) + 2 * std::sqrt(at_rest);
  return root * root;
}

/// Whether no load and no support changes within a time from now.
bool FloatingStepper::is_steady(double time_left) noexcept {
  const ForcedResponse::Piece& piece = state_.forcing.piece(time());
  return piece.steady && piece.to > time() + time_left;
}

/// Places the points as the bodies are, with the static displacements at a time.
void FloatingStepper::place(double time) noexcept {
  points_.move_obstacles(time);
  displaced_ = state_.q + loads_.place(bodies_, time, points_);
  points_.place(bodies_, displaced_);
}

/// Sets what gravity, loads and supports do in the step, in the middle of which the bodies are.
void FloatingStepper::drive() noexcept {
  const double then = static_cast<double>(steps_ + 1) * options_.step;
  points_.drive_obstacles(time(), then);
  loads_.act(bodies_, time(), then, state_.forcing, points_);
  state_.forcing.step(steps_ + 1, state_.now);
  set_free_motion();
  dq_ += loads_.change();
}

/// Sets dq_ to that of the elastic modes without contact.
void FloatingStepper::set_free_motion() noexcept {
  if (state_.now.forced) {
    dq_ = state_.free_motion(state_.q, state_.v, state_.now);
    return;
  }
  for (const FloatingBody& body : bodies_)
    simd::dense().free_motion(static_cast<std::size_t>(body.elastic()), oscillators(body, *state_.system),
                              state_.q.data() + body.first_elastic(), state_.v.data() + body.first_elastic(),
                              dq_.data() + body.first_elastic());
}

/// The elastic modes of a body in a step that is not forced.
simd::Oscillators FloatingStepper::oscillators(const FloatingBody& body, const ModeConstants& over) noexcept {
  const auto of = [&](const Vector& x) { return x.data() + body.first_elastic(); };
  const ForcedResponse::Piece& piece = state_.forcing.piece();
  return {.b = of(over.b),
          .c = of(over.c),
          .e = of(over.e),
          .h = of(over.h),
          .stiffness = of(state_.system->stiffness),
          .damp_ss = of(over.damp_ss),
          .damp_sr = of(over.damp_sr),
          .damp_rr = of(over.damp_rr),
          .load = of(piece.load),
          .applied = of(piece.applied)};
}

StepStatus FloatingStepper::step() noexcept {
  if (!is_steady(options_.step) || points_.obstacles_move(time(), time() + options_.step)) wake_all();
  if (!any_moves()) return rest();
  if (contact_.mean.begins())
    if (const int crossed = cross(); crossed > 0) {
      fly(crossed);
      return StepStatus::ok;
    }
  const StepSystem& system = *state_.system;
  Slip* const slip = contact_.slip.any() ? &contact_.slip : nullptr;
  if (steps_ >= search_.next) search();
  if (!any_moves()) return rest();
  keep_start();
  const auto undo = [&](StepStatus status) {
    restore();
    contact_.mean.restore(points_.rows(), start_.end, start_.pairs);
    place(time());
    return status;
  };
  drift(Coriolis::Half::before, state_.q, state_.v);
  contact_.slip.begin(system.model->belts, steps_ + 1);
  drive();
  if (!points_.advance(bodies_, dq_, options_.step, contact_.mean)) {
    restore();
    place(time());
    return StepStatus::crowded;
  }
  law_.hold(points_.rows());
  law_.change_matrices();
  if (!state_.system->springs.empty())
    for (std::size_t j = 0; j < points_.rows().size(); ++j)
      if (const auto spring = points_.spring(j)) law_.spring(points_.rows()[j]) = *spring;
  const StepMatrices matrices =
      points_.matrices(bodies_, options_.step, contact_.mean.is_conserving() ? conserving_mean.end : 1);
  const auto k = std::ssize(points_.rows());
  start_.end.head(k) = end_force()(points_.rows());
  std::copy(contact_.mean.pairs().begin(), contact_.mean.pairs().end(), start_.pairs.begin());
  carry_forces(matrices);
  law_.start.head(k) = points_.at_start().head(k) - rest_.head(k);
  law_.free.head(k) = points_.free().head(k);
  let_in();
  const StepTrial trial = law_.solve(matrices, contact_.mean, slip);
  if (!has_forces(trial.status)) return undo(failure(trial.status));
  const Work work = kick(trial);
  drift(Coriolis::Half::after, state_.next_q, state_.next_v);
  if (!commit(work, trial.in_residual, static_cast<double>(steps_ + 1) * options_.step))
    return undo(StepStatus::not_finite);
  return end(trial);
}

/// Moves the frames for half a step, and mixes nearly equal modes.
void FloatingStepper::drift(Coriolis::Half half, Vector& q, Vector& v) noexcept {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!bodies_[k].moves()) continue;
    const Vector3d angle = bodies_[k].drift(0.5 * options_.step);
    coriolis_[k].turn(angle, options_.step, half, q, v);
  }
}

/// Keeps what drifts change.
void FloatingStepper::keep_start() noexcept {
  start_.bodies = bodies_;
  if (!mixes_) return;
  start_.q = state_.q;
  start_.v = state_.v;
}

void FloatingStepper::restore() noexcept {
  bodies_ = start_.bodies;
  if (!mixes_) return;
  state_.q = start_.q;
  state_.v = start_.v;
}

/// Finds the points that may touch before the next search.
void FloatingStepper::search() noexcept {
  points_.move_obstacles(time());
  look_for_rest();
  int epoch = 0;
  for (int woken = 0; woken >= 0;) {
    // A moving support may speed a body up, as a moving obstacle may.
    const double end = time() + search_.every * options_.step;
    epoch = loads_.move(time(), end) || points_.obstacles_move(time(), end) ? 1 : search_.every;
    set_travels(epoch * options_.step);
    points_.watch(bodies_, travels_, contact_.mean);
    woken = points_.reached(bodies_);
    if (woken >= 0) wake(woken);
  }
  place(time());
  search_.next = steps_ + epoch;
}

/// Bounds what each body may do in a time. Contact passes energy on but does not add any, so that a body has
/// at most the energy of all bodies that may reach each other in this time, directly or through others, with
/// the work of what acts on them: d(2E)^½/dt ≤ (Σ pull²)^½.
void FloatingStepper::set_travels(double time) noexcept {
  const Model& model = *state_.system->model;
  const double now = this->time(), then = now + time;
  // A moving obstacle or support may speed a body up beyond its energy.
  const double share = model.belts.empty() && !loads_.move(now, then) ? 1 : 2;
  points_.set_obstacle_travels(now, then);
  // An obstacle may throw a body back at twice its speed.
  std::fill(thrown_.begin(), thrown_.end(), 0.0);
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    double& most = thrown_[static_cast<std::size_t>(model.pairs[p].a)];
    most = std::max(most, 2 * points_.obstacle_speed(p, now, then));
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    energy_of_[k] = bodies_[k].kinetic() + elastic_energy(bodies_[k]);
  const auto is_asleep = [&](int k) { return bodies_[static_cast<std::size_t>(k)].asleep; };
  islands_.separate();
  for (bool joined = true; joined;) {
    joined = false;
    for (int k = 0; k < static_cast<int>(bodies_.size()); ++k) {
      double energy = state_.energy().residual, pull = 0, driven = 0, thrown = 0;
      for (int j = 0; j < static_cast<int>(bodies_.size()); ++j) {
        if (!islands_.same(k, j)) continue;
        const FloatingBody& body = bodies_[static_cast<std::size_t>(j)];
        const double of_body = body.pull() + loads_.pull(j, now, then);
        energy += share * energy_of_[static_cast<std::size_t>(j)];
        thrown += std::sqrt(body.mass) * thrown_[static_cast<std::size_t>(j)];
        pull += of_body * of_body;
        driven += 2 * loads_.speed(j, now, then);
      }
      const double root = std::sqrt(2 * energy) + time * std::sqrt(pull) + thrown;
      energy = 0.5 * root * root;
      const FloatingBody& body = bodies_[static_cast<std::size_t>(k)];
      const double speed =
          root * (std::sqrt(body.inverse_mass) + points_.radius(k) * std::sqrt(body.inertia.largest_inverse));
      travels_[static_cast<std::size_t>(k)] = {
          swing_energy(body, energy),
          is_asleep(k) ? 0 : time * (speed + driven) + loads_.reach(k, now, then)};
    }
    for (int pair = 0; pair < islands_.pairs(); ++pair) {
      const Model::PairBlock& bodies = model.pairs[static_cast<std::size_t>(pair)];
      // A body asleep that may be reached is woken, and then joins.
      if (islands_.joins(pair) || is_asleep(bodies.a) || is_asleep(bodies.b)) continue;
      if (!points_.may_meet(bodies, bodies_, travels_)) continue;
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
  law_.know_products(matrices, contact_.mean);
  const auto pairs = static_cast<int>(model.pairs.size());
  const bool springs = !state_.system->springs.empty();
  const auto carries = [&](int pair) {
    const MeanForce::Pair& state = contact_.mean.pairs()[static_cast<std::size_t>(pair)];
    return state.carries && !state.asleep;
  };
  islands_.separate();
  for (int pair = 0; pair < pairs; ++pair)
    if (carries(pair)) islands_.join(pair);
  islands_.assign();
  std::fill(carries_.begin(), carries_.end(), false);
  for (int pair = 0; pair < pairs; ++pair)
    if (carries(pair)) carries_[static_cast<std::size_t>(islands_.of_a(pair))] = true;
  bool reduced = false;
  for (int island = 0; island < islands_.count(); ++island) {
    if (!carries_[static_cast<std::size_t>(island)]) continue;
    double now = 0, missing = 0;
    for (std::size_t j = 0; j < rows.size(); ++j)
      if (islands_.of(points_.pair_of(j)) == island) {
        const double p = end_force()(rows[j]);
        now += 0.5 * p * law_.rest()(static_cast<Index>(j));
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
  if (reduced) {
    law_.change_matrices();
    law_.know_products(matrices, contact_.mean);
  }
  rest_.head(std::ssize(rows)) = law_.rest().head(std::ssize(rows));
  for (std::size_t j = 0; j < rows.size(); ++j)
    if (const PatchSpring spring = spring_of(rows[j]); spring.bulge > 0)
      rest_(static_cast<Index>(j)) += spring.displacement(end_force()(rows[j]));
}

/// Of pairs with summits, points that are inside at the start without a force, or because they have jumped,
/// may stay as deep as they are, until they rise.
void FloatingStepper::let_in() noexcept {
  const auto rows = points_.rows();
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const int row = rows[j];
    if (row >= points()) continue;
    if (state_.system->model->pairs[static_cast<std::size_t>(points_.pair_of(j))].summits == 0) continue;
    const double begin = state_.system->gap(row), u = std::max(begin, law_.start(static_cast<Index>(j)));
    const bool jumped = points_.has_jumped(j),
               stays = !jumped && (end_force()(row) != 0 || contact_.mean.before()(row) != 0);
    law_.gap(row) = stays ? std::min(law_.gap(row), u) : u;
  }
}

/// Changes velocities, angular momenta and modes by the mean forces of the step.
Work FloatingStepper::kick(const StepTrial& trial) noexcept {
  const StepSystem& system = *state_.system;
  const double step = options_.step;
  Work work = work_of(trial, trial.at_start);
  const auto rows = std::ssize(points_.rows());
  const double by_obstacles = law_.force().head(rows).dot(points_.driven().head(rows));
  work.contact += by_obstacles;
  work.belts += by_obstacles;
  modal_force_.setZero();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    FloatingBody& body = bodies_[k];
    if (!body.moves()) continue;
    const MovingPoints::Load load = points_.load(static_cast<int>(k), law_.force(), modal_force_);
    work.forcing += body.kick(load.force, load.torque, step) - load.on_static;
  }
  work.forcing -= modal_force_.dot(loads_.change());
  const Work of_modes = move_modes(system);
  work.damping = of_modes.damping;
  work.forcing += of_modes.forcing;
  return work;
}

/// Moves the elastic modes under constant forces of contact and under loads. Returns the work of both and of
/// damping.
Work FloatingStepper::move_modes(const ModeConstants& over) noexcept {
  if (state_.now.forced) {
    state_.next_q = state_.q;
    state_.next_v = state_.v;
    dq_ = state_.system->load + modal_force_;
    for (const int n : state_.system->model->folded.modes) dq_(n) = 0;
    return state_.forcing.advance(state_.now, dq_, state_.next_q, state_.next_v);
  }
  double work[2] = {0, 0};
  for (const FloatingBody& body : bodies_) {
    if (!body.moves()) continue;
    const Index first = body.first_elastic();
    simd::dense().move_modes(static_cast<std::size_t>(body.elastic()), oscillators(body, over),
                             modal_force_.data() + first, state_.q.data() + first, state_.v.data() + first,
                             state_.next_q.data() + first, state_.next_v.data() + first, work);
  }
  return {.damping = work[0], .forcing = work[1]};
}

/// Of the frames, with elastic modes (N), and the work of constant loads [J].
Energy FloatingStepper::energy_of(const Vector& q, const Vector& v, double residual) const noexcept {
  const StepSystem& system = *state_.system;
  double of_modes[3] = {0, 0, 0};
  Energy now{.residual = residual};
  for (const FloatingBody& body : bodies_) {
    const auto of = [&](const Vector& x) { return x.data() + body.first_elastic(); };
    simd::dense().add_energy(static_cast<std::size_t>(body.elastic()), of(system.stiffness), of(system.load),
                             of(system.q0), of(state_.now.lift), of(q), of(v), of_modes);
    now.kinetic += body.kinetic();
    now.loads += body.work_of_gravity();
  }
  now.kinetic += of_modes[0];
  now.strain += of_modes[1];
  now.loads += of_modes[2];
  return now;
}

/// Makes next_q and next_v the state, with the rigid rates of the frames.
bool FloatingStepper::commit(const Work& work, double residual, double time) noexcept {
  for (const FloatingBody& body : bodies_) {
    if (!body.moves()) continue;
    state_.next_q.segment(body.first_mode, body.frame_modes).setZero();
    body.write_rates(state_.next_v);
  }
  if (!state_.ledger.close(energy_of(state_.next_q, state_.next_v, residual + asleep_residual()), work))
    return false;
  state_.q.swap(state_.next_q);
  state_.v.swap(state_.next_v);
  turning_.rates = state_.v;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!bodies_[k].moves()) continue;
    turning_.poses[k] = bodies_[k].pose();
    const Vector3d spin = bodies_[k].own_spin();
    coriolis_[k].add_turn(spin, spin.norm(), true, state_.q, turning_.rates);
  }
  if (!state_.now.forced && !mixes_ && points_.should_expect()) {
    set_free_motion();
    points_.expect(dq_);
  }
  place(time);
  points_.write_frames(bodies_, turning_.frames);
  return true;
}

/// Completes a step that is committed. Vectors of all rows change in few of them.
StepStatus FloatingStepper::end(const StepTrial& trial) noexcept {
  for (const int row : forced_.before) next_force_(row) = 0;
  for (const int row : forced_.now) next_end_(row) = 0;
  double power = 0;
  for (std::size_t pair = 0; pair < stored_.size(); ++pair)
    if (!contact_.mean.pairs()[pair].asleep) stored_[pair] = 0;
  const auto rows = points_.rows();
  int active = forced_.active_asleep;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto at = static_cast<Index>(j);
    const int row = rows[j];
    next_force_(row) = law_.force()(at);
    const double p = next_end_(row) = law_.end()(at);
    double yielded = law_.yielded()(at), stored = 0;
    const double moved = law_.u()(at) - law_.start(at);
    // Where points slide, tangential displacements add up from step to step.
    rest_(at) = row >= points() && points_.slides(j) ? next_u_(row) + moved : points_.u(row) - yielded;
    if (row < points()) {
      power -= next_force_(row) * moved / options_.step;
      active += p > 0 ? 1 : 0;
    }
    if (const PatchSpring spring = spring_of(row); spring.bulge > 0 && p > 0) {
      yielded -= spring.displacement(p);
      stored = spring.energy(p);
    }
    stored_[static_cast<std::size_t>(points_.pair_of(j))] += stored + 0.5 * p * yielded;
  }
  for (const int row : forced_.now) next_u_(row) = 0;
  next_u_(rows) = rest_.head(std::ssize(rows));
  if (trial.several) ++contact_.ambiguous;
  points_.write_forces(law_.end(), bodies_, turning_.candidate_force);
  end_contact(active, power, trial.violation);
  forced_.before.swap(forced_.now);
  forced_.now.assign(rows.begin(), rows.end());
  ++steps_;
  return StepStatus::ok;
}

/// Ends a flight over some steps. If it goes on, there is nothing to clear.
void FloatingStepper::fly(int crossed) noexcept {
  steps_ += crossed;
  if (forced_.now.empty()) return;
  for (const int row : forced_.now) contact_.force(row) = next_end_(row) = next_u_(row) = 0;
  forced_.now.clear();
  contact_.active = forced_.active_asleep;
  contact_.persistency = 0;
  contact_.residual = {};
  contact_.slip.clear();
}

const Vector& FloatingStepper::displacement() const noexcept {
  points_.write_displacements(bodies_, u_);
  for (const std::vector<int>* rows : {&forced_.now, &forced_.asleep})
    for (const int row : *rows) u_(row) = next_u_(row);
  return u_;
}

bool FloatingStepper::push(int number, const Vector3d& force, const Vector3d& torque) noexcept {
  FloatingBody& body = bodies_[static_cast<std::size_t>(number)];
  body.push = force;
  body.torque = torque;
  turning_.pushed[static_cast<std::size_t>(number)] = {force, torque};
  wake(number);
  search_anew();
  return true;
}

bool FloatingStepper::push_at(int number, const BodyPlace& place, const Vector3d& force) noexcept {
  const PushStatus status = loads_.push_at(number, place, force);
  if (status == PushStatus::changed) {
    wake(number);
    search_anew();
  }
  return status != PushStatus::refused;
}

/// Without what each step computes before it is used, and without the constants of flights.
void FloatingStepper::archive(base::Archive& a) {
  archive_contact(a);
  a(state_, bodies_, turning_, points_, loads_, travels_, search_.next, search_.clear_until, search_.look_at,
    slow_since_);
  a(stored_, forced_.now, forced_.before, forced_.asleep, forced_.active_asleep);
  points_.move_obstacles(time());
}

/// What was known of the motion of the bodies no longer holds.
void FloatingStepper::search_anew() noexcept { search_.next = search_.clear_until = steps_; }

/// Steps to the next output sample, or an equal part of them if modes mix.
int FloatingStepper::steps_to_cross() const noexcept {
  if (!forced_.asleep.empty()) return 1;  // whose impulses are those of single steps
  const auto steps = static_cast<int>(options_.steps_per_sample - steps_ % options_.steps_per_sample);
  double longest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    longest = std::min(longest,
                       coriolis_[k].longest(bodies_[k].momentum.norm() * bodies_[k].inertia.largest_inverse));
  const double parts = std::ceil(std::min(1.0 * steps, steps * options_.step / longest));
  return parts > 1 ? static_cast<int>(std::ceil(steps / parts)) : steps;
}

/// Flies towards the next output sample, if nothing can touch before it. Returns the number of steps crossed.
int FloatingStepper::cross() noexcept {
  for (const FloatingBody& body : bodies_)
    if (!body.torque.isZero(0)) return 0;
  const int steps = steps_to_cross();
  const double from = time(), to = static_cast<double>(steps_ + steps) * options_.step;
  if (!is_steady(to - from) || loads_.act_on_free(from, to)) return 0;
  TurningLoads::release(bodies_);
  if (steps_ + steps > search_.clear_until) {
    if (steps_ < search_.look_at) return 0;
    search_.clear_until = find_clear_until(to - from);
    if (steps_ + steps > search_.clear_until) {
      search_.look_at = steps_ + search_every;  // a look costs as much as some steps
      return 0;
    }
  }
  set_flight(steps);
  keep_start();
  points_.watch_none();
  search_.next = steps_;  // also if the flight fails
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    flight_.turned[k].setZero();
    if (!bodies_[k].moves()) continue;
    flight_.turned[k] = bodies_[k].fly(to - from);
    coriolis_[k].turn(0.5 * flight_.turned[k], to - from, Coriolis::Half::before, state_.q, state_.v);
  }
  modal_force_.setZero();
  state_.forcing.interval(from, to, state_.now);
  Work work = move_modes(flight_.over);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    coriolis_[k].turn(0.5 * flight_.turned[k], to - from, Coriolis::Half::after, state_.next_q,
                      state_.next_v);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    work.forcing += bodies_[k].push.dot(bodies_[k].position - start_.bodies[k].position);
  if (!commit(work, 0, to)) {
    restore();
    return 0;
  }
  search_.next = steps_ + steps;
  return steps;
}

/// The step before which nothing can touch if no load changes, or at which one does; an earlier one if that
/// is nearer than `enough` [s].
std::int64_t FloatingStepper::find_clear_until(double enough) noexcept {
  double clear = state_.forcing.piece(time()).to - time();
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    travels_[k].energy = swing_energy(bodies_[k], elastic_energy(bodies_[k]));
  for (const Model::PairBlock& pair : state_.system->model->pairs) {
    if (!MovingPoints::is_live(pair, bodies_)) continue;
    const auto number = static_cast<std::size_t>(&pair - state_.system->model->pairs.data());
    double way = points_.clearance(pair, bodies_, travels_),
           speed = points_.obstacle_speed(number, time(), time());
    if (pair.driven) clear = std::min(clear, pair.driven->next_knot(time()) - time());
    Vector3d acceleration = Vector3d::Zero();
    for (const int k : {pair.a, pair.b}) {
      if (k < 0) continue;
      const FloatingBody& body = bodies_[static_cast<std::size_t>(k)];
      speed += body.velocity.norm() + body.momentum.norm() * body.inertia.largest_inverse * points_.radius(k);
      if (body.moves()) acceleration += (k == pair.a ? 1 : -1) * body.acceleration();
      way -= loads_.reach(k, time(), time());
    }
    const double g = acceleration.norm();
    // The time in which speed · t + g t²/2 reaches `way`.
    const double left = way > 0 ? 2 * way / (speed + std::sqrt(speed * speed + 2 * g * way)) : 0;
    clear = std::min(clear, left);
    if (clear < enough) break;
  }
  constexpr double longest = 1e9;  // steps, so that the sum fits
  return steps_ + static_cast<std::int64_t>(std::min(clear / options_.step, longest));
}

/// Sets the constants of modes over a flight of some steps.
void FloatingStepper::set_flight(int steps) noexcept {
  if (steps == flight_.steps) return;
  flight_.steps = steps;
  const Model& model = *state_.system->model;
  for (Index n = 0; n < model.omega.size(); ++n)
    if (state_.system->h(n) != 0)
      flight_.over.set_step(n, model.omega(n), model.decay(n), steps * options_.step);
}

}  // namespace ricochet::contact
