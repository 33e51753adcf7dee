// SPDX-License-Identifier: BSD-2-Clause
// Bodies that come to rest fall asleep, island by island, and are woken by what reaches them.
#include <algorithm>
#include <cmath>

#include "contact/stepping/floating_stepper.hpp"

namespace ricochet::contact {
namespace {

/// A body rests once it has been slower than this share of the speed of a fall by its own size, -120 dB, for
/// the time of this fall. What swings is slow at its turning point, but not for so long.
constexpr double resting = 1e-6;

}  // namespace

bool FloatingStepper::any_moves() const noexcept {
  return std::ranges::any_of(bodies_, &FloatingBody::moves);
}

/// A step in which no body moves.
StepStatus FloatingStepper::rest() noexcept {
  contact_.persistency = 0;
  ++steps_;
  return StepStatus::ok;
}

/// Finds out since when each body has been slow, and lets islands of bodies at rest fall asleep.
void FloatingStepper::look_for_rest() noexcept {
  const Model& model = *state_.system->model;
  const double g = model.gravity.norm();
  const double epoch = search_.every * options_.step;
  const bool may_rest =
      model.belts.empty() && is_steady(epoch) && !points_.obstacles_move(time(), time() + epoch);
  islands_.separate();
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    if (contact_.mean.pairs()[p].carries) islands_.join(static_cast<int>(p));
  std::ranges::fill(rests_, true);
  const auto rests = [&](std::size_t k) -> char& {
    return rests_[static_cast<std::size_t>(islands_.of_body(static_cast<int>(k)))];
  };
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const FloatingBody& body = bodies_[k];
    if (!body.moves()) continue;
    const double size = points_.radius(static_cast<int>(k)),
                 kinetic = body.kinetic() +
                           0.5 * state_.v.segment(body.first_elastic(), body.elastic()).squaredNorm();
    if (!may_rest || !body.torque.isZero(0) || loads_.pushes(static_cast<int>(k)) ||
        !(kinetic <= resting * resting * body.mass * g * size))
      slow_since_[k] = time();
    rests(k) = rests(k) && time() - slow_since_[k] >= std::sqrt(2 * size / g);
  }
  bool falls_asleep = false;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!bodies_[k].moves() || !rests(k)) continue;
    let_sleep(static_cast<int>(k));
    falls_asleep = true;
  }
  if (falls_asleep) let_pairs_sleep();
}

void FloatingStepper::let_sleep(int number) noexcept {
  FloatingBody& body = bodies_[static_cast<std::size_t>(number)];
  body.asleep = true;
  body.velocity.setZero();
  body.momentum.setZero();
  for (Vector* rates : {&state_.v, &state_.next_v, &turning_.rates})
    rates->segment(body.first_mode, body.modes).setZero();
  state_.next_q.segment(body.first_mode, body.modes) = state_.q.segment(body.first_mode, body.modes);
  turning_.poses[static_cast<std::size_t>(number)] = body.pose();
}

/// Lets the pairs sleep of which no body moves, and takes their rows out of those that steps write.
void FloatingStepper::let_pairs_sleep() noexcept {
  const Model& model = *state_.system->model;
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    if (MovingPoints::are_there(model.pairs[p], bodies_) && !MovingPoints::is_live(model.pairs[p], bodies_))
      contact_.mean.let_sleep(static_cast<int>(p), true);
  const auto sleeps = [&](int row) {
    return contact_.mean
        .pairs()[static_cast<std::size_t>(contact_.mean.pair_of_row()[static_cast<std::size_t>(row)])]
        .asleep;
  };
  for (const int row : forced_.before)
    if (sleeps(row)) next_force_(row) = 0;
  for (const int row : forced_.now) {
    if (!sleeps(row)) continue;
    forced_.asleep.push_back(row);
    next_force_(row) = contact_.force(row);
    if (row < points())
      forced_.active_asleep += end_force()(row) > 0 ? 1 : 0;
    else if ((row - points()) % 2 == 0)
      contact_.slip.let_sleep((row - points()) / 2);
  }
  std::erase_if(forced_.now, sleeps);
  std::erase_if(forced_.before, sleeps);
}

/// Wakes a body, and all that touch it, directly or through others.
void FloatingStepper::wake(int number) noexcept {
  if (!bodies_[static_cast<std::size_t>(number)].asleep) return;
  const Model& model = *state_.system->model;
  const auto rouse = [&](int k) {
    bodies_[static_cast<std::size_t>(k)].asleep = false;
    slow_since_[static_cast<std::size_t>(k)] = time();
  };
  rouse(number);
  for (bool spreads = true; spreads;) {
    spreads = false;
    for (std::size_t p = 0; p < model.pairs.size(); ++p) {
      const Model::PairBlock& pair = model.pairs[p];
      const MeanForce::Pair& state = contact_.mean.pairs()[p];
      if (!state.asleep || !MovingPoints::is_live(pair, bodies_)) continue;
      contact_.mean.let_sleep(static_cast<int>(p), false);
      spreads = true;
      if (!state.carries) continue;
      for (const int k : {pair.a, pair.b})
        if (k >= 0) rouse(k);
    }
  }
  std::erase_if(forced_.asleep, [&](int row) {
    const int pair = contact_.mean.pair_of_row()[static_cast<std::size_t>(row)];
    if (contact_.mean.pairs()[static_cast<std::size_t>(pair)].asleep) return false;
    forced_.now.push_back(row);
    forced_.before.push_back(row);
    if (row < points())
      forced_.active_asleep -= end_force()(row) > 0 ? 1 : 0;
    else if ((row - points()) % 2 == 0)
      contact_.slip.wake((row - points()) / 2);
    return true;
  });
  search_.next = search_.clear_until = steps_;
}

void FloatingStepper::wake_all() noexcept {
  for (int k = 0; k < static_cast<int>(bodies_.size()); ++k) wake(k);
}

/// Energy in R and in springs of pairs asleep [J].
double FloatingStepper::asleep_residual() const noexcept {
  double out = 0;
  for (std::size_t p = 0; p < stored_.size(); ++p)
    if (contact_.mean.pairs()[p].asleep) out += stored_[p];
  return out;
}

}  // namespace ricochet::contact
