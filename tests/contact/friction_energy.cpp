// SPDX-License-Identifier: BSD-2-Clause
// Contact and friction never add energy: random bodies, steps over 12 decades, coefficients up to 10.
// RICOCHET_RANDOM_STEPS sets the number of steps; scripts/verify --friction makes a million.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/sliding.hpp"

namespace friction_energy_test {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;

std::int64_t steps_wanted() {
  const char* const text = std::getenv("RICOCHET_RANDOM_STEPS");
  return text != nullptr ? std::atoll(text) : 10'000;
}

struct Found {
  double gain = 0;   ///< largest E − E₀ relative to E₀
  double cold = 0;   ///< most negative heat of a step by backward Euler, relative to E₀
  double drift = 0;  ///< of the ledger, relative to E₀
  double heat = 0;   ///< largest share of E₀ that friction took
  std::int64_t steps = 0, touching = 0, slipping = 0, sticking = 0, limited = 0, ambiguous = 0;
};

/// 40 steps of a random body.
void run(std::mt19937_64& random, Found& found) {
  std::uniform_real_distribution<double> uniform;
  const auto decades = [&](double from, double to) {
    return std::pow(10.0, from + (to - from) * uniform(random));
  };
  const double step = decades(-12, 0);
  const double friction = uniform(random) < 0.1   ? 0.0
                          : uniform(random) < 0.5 ? uniform(random)
                                                  : 10 * uniform(random);
  Model model = random_body({.points = static_cast<int>(decades(0, std::log10(201))),
                             .modes = static_cast<int>(decades(0, std::log10(401))),
                             .friction = friction,
                             .flexibility = uniform(random) < 0.1 ? 0 : step * step * decades(-4, 4),
                             .frequency = decades(-3, 1) / step,
                             .damping = uniform(random) < 0.3 ? decades(-3, 1) : 0},
                            random);
  for (double& gap : model.gap) gap = 10 * step * uniform(random);
  if (uniform(random) < 0.3)
    for (Model::FrictionPoint& point : model.friction)
      point.law = {friction, friction * uniform(random), decades(-2, 1)};
  const ContactStep kind = uniform(random) < 0.5 ? ContactStep::conserving : ContactStep::backward_euler;
  const auto stepper = make_stepper(
      model, {.contact = {.integration = kind}, .step = step, .block = uniform(random) < 0.5 ? 1 : 0});
  const double start = 0.5 * model.v0.squaredNorm();
  double before = 0;
  for (int k = 0; k < 40; ++k, ++found.steps) {
    const StepStatus status = stepper->step();
    if (status == StepStatus::no_solution && model.R.isZero(0)) return;  // more points than modes
    ASSERT_EQ(status, StepStatus::ok) << found.steps;
    const Energy& e = stepper->modal()->energy();
    found.gain = std::max(found.gain, (e.total() - start) / start);
    found.drift = std::max(found.drift, std::abs(e.ledger() - start) / start);
    found.heat = std::max(found.heat, e.friction / start);
    if (kind == ContactStep::backward_euler) found.cold = std::max(found.cold, (before - e.friction) / start);
    before = e.friction;
    found.touching += stepper->active();
    for (const ContactState state : stepper->slip().states()) {
      found.slipping += state == ContactState::slip;
      found.sticking += state == ContactState::stick;
    }
  }
  found.limited += stepper->solver().limited;
  found.ambiguous += stepper->ambiguous_steps();
}

TEST(Energy, is_never_added_by_contact_and_friction) {
  std::mt19937_64 random(1);
  Found found;
  const std::int64_t wanted = steps_wanted();
  while (found.steps < wanted && !testing::Test::HasFatalFailure()) run(random, found);
  RecordProperty("steps", std::to_string(found.steps));
  std::printf(
      "%lld steps: gain %.1e, negative heat of a step %.1e, drift of the ledger %.1e, heat up to %.3f; "
      "%lld sliding, %lld sticking of %lld pressed; %lld limited, %lld with several solutions\n",
      static_cast<long long>(found.steps), found.gain, found.cold, found.drift, found.heat,
      static_cast<long long>(found.slipping), static_cast<long long>(found.sticking),
      static_cast<long long>(found.touching), static_cast<long long>(found.limited),
      static_cast<long long>(found.ambiguous));
  EXPECT_LE(found.gain, 1e-13);
  EXPECT_LE(found.cold, 1e-12);  // round-off of displacements, times forces; a million steps reach 7e-14
  EXPECT_LE(found.drift, 1e-9);  // displacements are large beside the slip of a step
  EXPECT_GT(found.heat, 0.1);
  EXPECT_GT(found.slipping, found.steps / 10);
  EXPECT_GT(found.sticking, found.steps / 10);
}

}  // namespace friction_energy_test
