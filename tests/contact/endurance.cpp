// SPDX-License-Identifier: BSD-2-Clause
// Errors that accumulate over a million steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/contact/plate.hpp"

namespace endurance_test {

using namespace ricochet;
using contact::test::falling;

struct Outcome {
  double drift = 0;    ///< largest deviation of the ledger, relative to the initial energy
  double damping = 0;  ///< energy lost to damping, relative to the initial energy
  int impacts = 0;     ///< periods of consecutive steps with a force
  int late = 0;        ///< impacts in the second half
};

Outcome endure(const Scene& scene) {
  constexpr int steps = 1'000'000;
  Simulation simulation(scene);
  const double initial = simulation.energy().total();
  Outcome out;
  bool touching = false;
  for (int k = 0; k < steps; ++k) {
    if (simulation.step() != StepStatus::ok) {
      ADD_FAILURE() << "step " << k;
      break;
    }
    const Energy e = simulation.energy();
    out.drift = std::max(out.drift, std::abs(e.ledger() - initial) / initial);
    out.damping = e.damping / initial;
    const bool before = std::exchange(touching, simulation.active() > 0);
    out.impacts += touching && !before;
    out.late += touching && !before && 2 * k >= steps;
  }
  return out;
}

/// A plate that bounces for the whole 23 s, lightly damped and pulled down by its weight.
Scene bouncing() { return falling({.ratio = 1e-5, .rigid_decay = 1e-3, .flexibility = 1e-5}, 1e-3, 1, 9.81); }

// 1e-10 of the initial energy: a million rounding errors of 2e-16 that may all have the same sign.
TEST(Ledger, of_compliant_steps_closes_over_a_million_steps_of_gravity_damping_and_impacts) {
  const Outcome out = endure(bouncing());
  EXPECT_LT(out.drift, 1e-10);
  EXPECT_GT(out.damping, 1e-3);
  EXPECT_GT(out.late, 100);
}

TEST(Ledger, of_impulses_closes_over_a_million_steps_of_gravity_damping_and_impacts) {
  for (const Admittance admittance : {Admittance::jump, Admittance::difference}) {
    Scene scene = bouncing();
    scene.scheme = Scheme::impulse;
    scene.admittance = admittance;
    scene.restitution = 1;
    const Outcome out = endure(scene);
    EXPECT_LT(out.drift, 1e-10);
    EXPECT_GT(out.damping, 1e-3);
    EXPECT_GT(out.late, 100);
  }
}

}  // namespace endurance_test
