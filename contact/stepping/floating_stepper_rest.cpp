// SPDX-License-Identifier: BSD-2-Clause
// Bodies that come to rest fall asleep, island by island, and are woken by what reaches them.
#include <algorithm>
#include <cmath>

#include "contact/stepping/floating_stepper.hpp"

namespace ricochet::contact {
namespace {

/// An island rests if the speeds of its bodies are below this share of those of a fall by their own size,
/// -120 dB, and if its forces change by less than this share from one search to the next, for the time of the
/// longest of these falls. What swings is slow at its turning point, but not for so long.
constexpr double resting = 1e-6, steady = 1e-3;

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

/// Finds out since when each body rests, and lets islands fall asleep.
void FloatingStepper::look_for_rest() noexcept {
  const Model& model = *state_.system->model;
  const double g = model.gravity.norm();
  const bool may_rest = contact_.active > 0 && model.belts.empty() && is_steady(epoch_ * options_.step);
  islands_.separate();
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    if (contact_.mean.pairs()[p].carries) islands_.join(static_cast<int>(p));
  std::ranges::fill(rest_of_, IslandRest{.slow = may_rest});
  const auto island_of = [&](int body) -> IslandRest& {
    return rest_of_[static_cast<std::size_t>(islands_.of_body(body))];
  };
  const auto each = [&](auto&& use) {
    for (int k = 0; k < static_cast<int>(bodies_.size()); ++k)
      if (bodies_[static_cast<std::size_t>(k)].moves()) use(k, island_of(k));
  };
  bool any_slow = false;
  each([&](int k, IslandRest& island) {
    const FloatingBody& body = bodies_[static_cast<std::size_t>(k)];
    const double fall = body.mass * g * points_.radius(k),
                 kinetic = body.kinetic() +
                           0.5 * state_.v.segment(body.first_elastic(), body.elastic()).squaredNorm();
    island.slow = island.slow && body.torque.isZero(0) && kinetic <= resting * resting * fall;
    any_slow = any_slow || island.slow;
  });
  if (any_slow) add_forces_at_rest();
  each([&](int k, IslandRest& island) {
    Rest& own = rests_[static_cast<std::size_t>(k)];
    const bool rests = own.slow && island.slow && island.change <= steady * steady * island.force;
    if (!rests) own.since = time();
    own.slow = island.slow;
    island.long_enough =
        island.long_enough && island.force > 0 && time() - own.since >= std::sqrt(2 * points_.radius(k) / g);
  });
  bool falls_asleep = false;
  each([&](int k, IslandRest& island) {
    if (!island.long_enough) return;
    let_sleep(bodies_[static_cast<std::size_t>(k)]);
    falls_asleep = true;
  });
  if (falls_asleep) let_pairs_sleep();
}

/// Adds up the forces of islands, and their changes since the last search that found one of them slow.
void FloatingStepper::add_forces_at_rest() noexcept {
  const Model& model = *state_.system->model;
  for (Eigen::Index row = 0; row < rest_force_.size(); ++row) {
    const double now = contact_.force(row), change = now - rest_force_(row);
    if (now == 0 && change == 0) continue;
    const Model::PairBlock& pair =
        model.pairs[static_cast<std::size_t>(contact_.mean.pair_of_row()[static_cast<std::size_t>(row)])];
    for (const int k : {pair.a, pair.b}) {
      if (k < 0) continue;
      IslandRest& island = rest_of_[static_cast<std::size_t>(islands_.of_body(k))];
      island.force += now * now;
      island.change += change * change;
    }
  }
  rest_force_ = contact_.force;
}

void FloatingStepper::let_sleep(FloatingBody& body) noexcept {
  body.asleep = true;
  body.velocity.setZero();
  body.momentum.setZero();
  for (Vector* rates : {&state_.v, &state_.next_v, &turning_.rates})
    rates->segment(body.first_mode, body.modes).setZero();
  state_.next_q.segment(body.first_mode, body.modes) = state_.q.segment(body.first_mode, body.modes);
  turning_.poses[static_cast<std::size_t>(&body - bodies_.data())] = body.pose();
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
  for (const int row : next_written_)
    if (sleeps(row)) next_force_(row) = 0;
  for (const int row : written_) {
    if (!sleeps(row)) continue;
    sleeping_.push_back(row);
    next_force_(row) = contact_.force(row);
    if (row < points())
      sleeping_active_ += end_force()(row) > 0 ? 1 : 0;
    else if ((row - points()) % 2 == 0)
      contact_.slip.let_sleep((row - points()) / 2);
  }
  std::erase_if(written_, sleeps);
  std::erase_if(next_written_, sleeps);
}

/// Wakes a body, and all that touch it, directly or through others.
void FloatingStepper::wake(int number) noexcept {
  if (!bodies_[static_cast<std::size_t>(number)].asleep) return;
  const Model& model = *state_.system->model;
  const auto rouse = [&](int k) {
    bodies_[static_cast<std::size_t>(k)].asleep = false;
    rests_[static_cast<std::size_t>(k)] = {.since = time()};
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
  std::erase_if(sleeping_, [&](int row) {
    const int pair = contact_.mean.pair_of_row()[static_cast<std::size_t>(row)];
    if (contact_.mean.pairs()[static_cast<std::size_t>(pair)].asleep) return false;
    written_.push_back(row);
    next_written_.push_back(row);
    if (row < points())
      sleeping_active_ -= end_force()(row) > 0 ? 1 : 0;
    else if ((row - points()) % 2 == 0)
      contact_.slip.wake((row - points()) / 2);
    return true;
  });
  search_at_ = clear_until_ = steps_;
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
