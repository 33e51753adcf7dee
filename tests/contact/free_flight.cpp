// SPDX-License-Identifier: BSD-2-Clause
// Free flight from output sample to output sample, compared with contact steps all the way.
#include "contact/stepping/free_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/falling_body.hpp"
#include "tests/contact/heap_counter.hpp"

namespace free_flight_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double sample = 1 / 44100.0;

struct Course {
  std::int64_t calls = 0, touches = 0;
  Vector q, v;
  double impulse = 0;
  Energy energy;
};

Course run(const Model& model, const StepOptions& options, std::int64_t samples) {
  const auto stepper = make_stepper(model, options);
  Course out;
  while (stepper->steps() < samples * options.steps_per_sample) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    ++out.calls;
    out.touches += stepper->active() > 0 ? 1 : 0;
    out.impulse += stepper->force().sum() * options.step;
  }
  EXPECT_EQ(stepper->steps(), samples * options.steps_per_sample);
  EXPECT_TRUE(stepper->at_sample());
  EXPECT_EQ(stepper->catch_up(), StepStatus::ok);
  out.q = stepper->modal()->q;
  out.v = stepper->modal()->v;
  out.energy = stepper->modal()->energy();
  return out;
}

/// A body that falls, touches and flies, with damping.
Model thrown() {
  Model model = dropped(12, 3, 2e-4);
  model.decay = 0.01 * model.omega;
  model.decay(0) = 3;
  return model;
}

// Both runs make the same contact steps. 1e-9: one contact amplifies the round-off of the flight before it.
TEST(FreeFlight, gives_the_motion_of_contact_steps_in_fewer_steps) {
  const Model model = thrown();
  const int per_sample = 50;
  const std::int64_t samples = 1500;
  for (const int block : {1, 8})
    for (const bool every_state : {true, false}) {
      StepOptions options{.step = sample / per_sample, .block = block, .every_state = every_state};
      const Course plain = run(model, options, samples * per_sample);
      options.steps_per_sample = per_sample;
      const Course jumped = run(model, options, samples);
      EXPECT_GT(plain.touches, 10);
      EXPECT_EQ(jumped.touches, plain.touches);
      EXPECT_LT(jumped.calls - jumped.touches, (plain.calls - plain.touches) / 5);
      EXPECT_GT(jumped.calls, samples);
      EXPECT_LT((jumped.q - plain.q).norm(), 1e-9 * plain.q.norm());
      EXPECT_LT((jumped.v - plain.v).norm(), 1e-9 * plain.v.norm());
      EXPECT_NEAR(jumped.impulse, plain.impulse, 1e-9 * plain.impulse);
      EXPECT_NEAR(jumped.energy.damping, plain.energy.damping, 1e-9 * plain.energy.kinetic);
      EXPECT_NEAR(jumped.energy.ledger(), plain.energy.ledger(),
                  1e-11 * plain.energy.kinetic);  // round-off of 75 000 steps
    }
}

/// Adds a load that lifts the body and bends it, or a support that moves its points and its modes.
void drive(Model& model, bool support, ricochet::contact::History history) {
  const Eigen::Index N = model.omega.size(), m = model.points();
  model.bodies.resize(1);
  model.bodies[0].modes = static_cast<int>(N);
  Model::Forcing& one = model.forcing.emplace_back();
  one.support = support;
  one.history = std::move(history);
  one.force.setZero(N);
  one.lift = one.force;
  if (support)
    one.lift.setLinSpaced(1e-4, -2e-4);
  else
    one.force.setLinSpaced(-8, 40);
  one.displacement.setLinSpaced(m, -1e-6, 2e-6);
}

// Flights are crossed unless a history has a knot meanwhile: of a dead load, of a load that grows steadily,
// of one that begins and ends, and of a support that moves steadily. 1e-8: contact amplifies round-off.
TEST(FreeFlight, is_crossed_between_the_knots_of_loads_and_supports) {
  const int per_sample = 50;
  const std::int64_t samples = 1500;
  const double end = samples * sample;
  const std::vector<std::pair<bool, History>> forcings{
      {false, {{-1}, {1e-3}}},
      {false, {{0}, {0.3}}},
      {false, {{-1, 2 * end}, {0, 0.5}}},
      {false, {{0.21 * end, 0.3 * end, 0.4 * end}, {0, 0.6, 0}}},
      {true, {{0.1 * end, 2 * end}, {0, 1}}},
  };
  for (std::size_t which = 0; which < forcings.size(); ++which)
    for (const int block : {1, 8}) {
      SCOPED_TRACE(testing::Message() << which << " " << block);
      Model model = thrown();
      drive(model, forcings[which].first, forcings[which].second);
      StepOptions options{.step = sample / per_sample, .block = block, .every_state = false};
      const Course plain = run(model, options, samples * per_sample);
      options.steps_per_sample = per_sample;
      const Course jumped = run(model, options, samples);
      EXPECT_GT(plain.touches, 10);
      EXPECT_NEAR(jumped.touches, plain.touches, 1);
      EXPECT_LT(jumped.calls - jumped.touches, (plain.calls - plain.touches) / 5);
      EXPECT_LT((jumped.q - plain.q).norm(), 1e-8 * plain.q.norm());
      EXPECT_LT((jumped.v - plain.v).norm(), 1e-8 * plain.v.norm());
      EXPECT_NEAR(jumped.energy.damping, plain.energy.damping, 1e-8 * plain.energy.kinetic);
      EXPECT_NEAR(jumped.energy.loads, plain.energy.loads, 1e-8 * plain.energy.kinetic);
      EXPECT_NEAR(jumped.energy.ledger(), plain.energy.ledger(), 1e-10 * plain.energy.kinetic);
    }
}

// A support carries the point to the floor at a steady speed while the modes rest, between two samples or
// within a look-ahead block. Neither a flight nor a skipped candidate may miss the instant.
TEST(FreeFlight, does_not_carry_a_point_through_a_floor) {
  constexpr double speed = 0.1;
  for (const auto& [per_sample, block, at] : {std::tuple{1000, 1, 1.5}, {1000, 8, 1.5}, {1, 8, 4.5}}) {
    Model model = dropped(2, 1, at * sample * speed);
    model.load.setZero();
    drive(model, true, {{0, 1}, {0, speed}});
    model.forcing[0].lift.setZero();
    model.forcing[0].displacement.setOnes();
    const StepOptions options{.step = sample / per_sample, .steps_per_sample = per_sample, .block = block};
    const auto stepper = make_stepper(model, options);
    while (stepper->active() == 0 && stepper->time() < 20 * sample)
      ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_GE(stepper->time(), at * sample);
    EXPECT_LE(stepper->time(), at * sample + 1.01 * options.step) << per_sample << " " << block;
  }
}

// A mode turns the point into the floor and back again between two samples. The ends of the jump show
// nothing of this.
TEST(FreeFlight, does_not_pass_through_a_floor_between_samples) {
  Model model = dropped(2, 1, 0);
  model.load.setZero();
  model.omega << 0, 2 * std::numbers::pi / sample;  // a whole period in a sample
  model.decay.setZero();
  model.B << 0, 1;
  model.v0 << 0, 1;
  model.q0.setZero();
  const double amplitude = 1 / model.omega(1);
  for (const double share : {0.999, 1.001}) {
    model.gap << share * amplitude;
    const StepOptions options{.step = sample / 1000, .steps_per_sample = 1000};
    const Course found = run(model, options, 1);
    EXPECT_EQ(found.touches > 0, share < 1) << share;
    EXPECT_EQ(found.calls == 1, share > 1) << share;
  }
}

TEST(FreeFlight, takes_no_memory) {
  for (const int block : {1, 8}) {
    const Model model = thrown();
    const auto stepper = make_stepper(
        model, {.step = sample / 50, .steps_per_sample = 50, .block = block, .every_state = false});
    const auto before = heap_counter::calls.load();
    for (int k = 0; k < 3000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_EQ(heap_counter::calls.load(), before);
  }
}

}  // namespace free_flight_test
