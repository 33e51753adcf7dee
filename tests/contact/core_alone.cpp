// SPDX-License-Identifier: BSD-2-Clause
// The core of contact, linked without HDF5, fmt and any library of a higher layer.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {
namespace {

/// A mass of 2 kg, 5 mm above the floor.
Model drop() {
  Model model;
  model.omega = model.decay = model.q0 = model.v0 = Vector::Zero(1);
  model.load = Vector::Constant(1, std::sqrt(2.0) * 9.81);
  model.B = Matrix::Constant(1, 1, 1 / std::sqrt(2.0));
  model.R = model.R_a = Matrix::Zero(1, 1);
  model.gap = Vector::Constant(1, 5e-3);
  model.area = Vector::Ones(1);
  model.static_displacement = model.static_a = Vector::Zero(1);
  model.point_a = model.point_b = model.normal = Matrix::Zero(1, 3);
  return model;
}

TEST(Core, steps_a_drop_by_every_scheme_without_the_libraries_above_it) {
  const Model model = drop();
  constexpr double step = 1e-4;
  const int fall = static_cast<int>(std::ceil(std::sqrt(2 * 5e-3 / 9.81) / step));  // √(2h/g)
  for (const StepOptions& options :
       {StepOptions{.step = step}, StepOptions{.step = step, .block = 1},
        StepOptions{.step = step, .precision = Precision::float32},
        StepOptions{.contact = {.scheme = Scheme::impulse}, .step = step},
        StepOptions{.contact = {.scheme = Scheme::impulse, .instant = Instant::exact}, .step = step}}) {
    const std::unique_ptr<Stepper> stepper = make_stepper(model, options);
    for (int k = 1; k < fall; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      ASSERT_EQ(stepper->active(), 0) << k;
    }
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_EQ(stepper->active(), 1);
    // 1e-12: round-off of some hundred steps at an energy of 0.1 J
    EXPECT_NEAR(stepper->modal()->energy().ledger(), 0, 1e-12);
  }
}

}  // namespace
}  // namespace ricochet::contact
