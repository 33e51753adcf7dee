// SPDX-License-Identifier: BSD-2-Clause
// Sampled responses: the closed form for two rods compared with the wave solution, responses from modes
// compared with modal stepping, and refusals of the stepper.
#include "contact/table/table.hpp"
#include "contact/table/modal_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "contact/table/table_stepper.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/rod_tables.hpp"
#include "tests/support.hpp"

namespace table_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// u(t) of d'Alembert's wave solution: contact starts at t = g/v and lasts 2L/c.
double exact_displacement(double gap, double t) {
  const double start = gap / speed, end = start + 20;
  return t < start ? speed * t : t < end ? gap : gap - speed * (t - end);
}

struct Named {
  const char* name;
  StepOptions options;
};
const std::vector<Named> laws = {
    {"compliant", {.contact = {.scheme = Scheme::compliant}, .step = step}},
    {"jump", {.contact = {.scheme = Scheme::impulse, .admittance = Admittance::jump}, .step = step}},
    {"difference",
     {.contact = {.scheme = Scheme::impulse, .admittance = Admittance::difference}, .step = step}}};

// 1e-11: round-off of sums of 2000 terms, for lengths up to 30.
TEST(AnalyticRods, move_as_the_waves_do_under_either_scheme) {
  const double gap = 1;
  for (const auto& [name, options] : laws) {
    SCOPED_TRACE(name);
    TableStepper rod(rods(gap, 3002), options);
    // λ of `compliant` acts over the step before its instant; P of `impulse` represents the step after it.
    const double shift = options.contact.scheme == Scheme::impulse ? 0.5 : -0.5;
    for (std::int64_t k = 1; k <= 3000; ++k) {
      ASSERT_EQ(rod.step(), StepStatus::ok);
      ASSERT_NEAR(rod.displacement()(0), exact_displacement(gap, rod.time()), 1e-11) << k;
      const double when = rod.time() + shift * step;
      ASSERT_NEAR(rod.force()(0), when > 1 && when < 21 ? 0.5 : 0, 1e-11) << k;
    }
    EXPECT_NEAR((*rod.body_velocities())(0, 0), 0, 1e-12);
    EXPECT_NEAR((*rod.body_velocities())(0, 1), speed, 1e-12);
  }
}

// The impulse scheme stops rods that touch at t = 0 only at t_1. All later motion is
// one step late, with a penetration of vΔ.
TEST(AnalyticRods, that_touch_at_the_start_are_late_by_a_step_under_impulse_alone) {
  for (const auto& [name, options] : laws) {
    SCOPED_TRACE(name);
    const double late = options.contact.scheme == Scheme::impulse ? step : 0;
    TableStepper rod(rods(0, 3002), options);
    for (std::int64_t k = 1; k <= 3000; ++k) {
      ASSERT_EQ(rod.step(), StepStatus::ok);
      ASSERT_NEAR(rod.displacement()(0), late * speed + exact_displacement(0, rod.time() - late), 1e-11) << k;
    }
    EXPECT_NEAR((*rod.body_velocities())(0, 1), speed, 1e-12);
  }
}

TEST(AnalyticRods, may_be_given_their_free_motion_by_samples) {
  for (const auto& [name, options] : laws) {
    SCOPED_TRACE(name);
    Table sampled = rods(1, 3002);
    for (int k = 0; k < 3002; ++k) sampled.free.push_back(speed * k * step);
    sampled.bodies.clear();
    validate(sampled, "rods");
    TableStepper rod(sampled, options), reference(rods(1, 3002), options);
    // a rate is the difference of two samples and uses up one of them
    EXPECT_EQ(rod.available(), options.contact.scheme == Scheme::impulse ? 3000 : 3001);
    while (rod.step() == StepStatus::ok) {
      ASSERT_EQ(reference.step(), StepStatus::ok);
      ASSERT_NEAR(rod.displacement()(0), reference.displacement()(0), 1e-11);
      ASSERT_NEAR(rod.force()(0), reference.force()(0), 1e-10);
    }
    EXPECT_EQ(rod.steps(), rod.available());
  }
}

// The closed form is the sum over the modes of the rods: steps of 1/Z, 2/Z, 2/Z, …
// at 0, 2L/c, 4L/c, …, and on average the rigid motion t/(ρAL). In the formula printed in the
// paper, the second Heaviside function is outside the sum.
TEST(AnalyticRods, have_the_response_that_their_modes_add_up_to) {
  const double length = 10;
  const auto by_modes = [&](double t) {
    double sum = t / length;
    const int count = 200000;
    for (int n = count; n >= 1; --n) {
      const double omega = n * std::numbers::pi / length, x = n * std::numbers::pi / (count + 1);
      sum += 2 / length * std::sin(omega * t) / omega * std::sin(x) / x;  // Lanczos factors suppress ringing
    }
    return sum;
  };
  const Table table = rods(0, 10001);
  for (const double t : {3.0, 12.5, 19.0, 21.0, 33.0, 39.0, 41.0, 72.0})
    EXPECT_NEAR(table.displacement[std::lround(t / step)], 2 * by_modes(t), 1e-4) << t;
}

// A mass lies on the floor under its weight. Under "compliant" it does not move. Under "difference"
// it is stopped one step late and then kept there. Under "jump" its velocity is cancelled at each
// instant, and it creeps by ½gΔ² in each step.
TEST(RigidTable, rests_under_its_weight) {
  const double mass = 2, g = 9.81;
  Table table;
  table.step = step;
  for (int l = 0; l < 100; ++l) {
    table.displacement.push_back(l * step / mass);
    table.velocity.push_back(1 / mass);
  }
  table.tail = Tail::linear;
  table.gap = Vector::Zero(1);
  Matrix push(1, 3);
  push << 0, 0, 1;
  table.bodies = {{"mass", mass, Vector3d::Zero(), {0, 0, -g}, push}};
  validate(table, "mass");
  for (const auto& [name, options] : laws) {
    SCOPED_TRACE(name);
    TableStepper stepper(table, options);
    const bool creeps = std::string(name) == "jump", late = options.contact.scheme == Scheme::impulse;
    for (int k = 1; k <= 500; ++k) {
      ASSERT_EQ(stepper.step(), StepStatus::ok);
      const double fall = 0.5 * g * step * step, place = creeps ? k * fall : late ? fall : 0;
      ASSERT_NEAR(stepper.displacement()(0), place, 1e-10);  // it would have fallen 122 m
      const double first = std::string(name) == "difference" && k == 1 ? 1.5 : 1;  // from v̂ = g (t_1 + Δ/2)
      ASSERT_NEAR(stepper.force()(0), first * mass * g, 1e-6);  // accumulated round-off of u, divided by Δ²
    }
  }
}

// ---- Kernels from modes ----

/// One rigid mode and elastic modes, with damping, weight and R. Its points open and close repeatedly.
Model lively(unsigned seed, double ratio) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  const Eigen::Index N = 14, m = 4;
  Model model;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(N);
  model.B = Matrix::NullaryExpr(m, N, [&] { return 0.3 * spread(random); });
  model.B.col(0).setConstant(1);
  for (Eigen::Index n = 1; n < N; ++n) model.omega(n) = 350.0 * static_cast<double>(n);
  model.decay = ratio * model.omega;
  model.load(0) = 9.81;
  model.load(3) = -2;
  model.v0(0) = 1;
  model.R = 1e-6 * Matrix::Identity(m, m);
  model.has_residual = true;
  model.gap = Vector::LinSpaced(m, 1e-3, 1.2e-3);
  model.static_displacement = Vector::Constant(m, 1e-6);
  model.area = Vector::Ones(m);
  return model;
}

// 1e-9 of the largest value: modal sums and convolutions round 4000 steps differently, and
// each contact propagates the differences.
TEST(ModalTable, gives_what_modal_stepping_gives_under_both_schemes) {
  for (const double ratio : {0.0, 0.02})
    for (const double dt : {1e-4, 1e-3})  // the coarse step moves modes above 3142 rad/s into R
      for (const auto& [name, law] : laws) {
        StepOptions options = law;
        options.step = dt;
        if (options.contact.admittance == Admittance::difference && dt > 5e-4)
          continue;  // both refuse this step
        SCOPED_TRACE(testing::Message() << name << " ratio " << ratio << " step " << dt);
        const Model model = lively(2, ratio);
        // Without damping by backward Euler, contact by coarse steps soon amplifies round-off.
        const std::int64_t steps = options.contact.scheme == Scheme::compliant && dt > 5e-4 ? 400 : 4000;
        const auto modal = make_stepper(model, options);
        TableStepper table(table_from_modes(model, options, steps), options);
        EXPECT_EQ(table.available(), steps);
        double force = 0, place = 0, force_error = 0, place_error = 0, power = 0, power_error = 0;
        int touches = 0;
        for (std::int64_t k = 1; k <= steps; ++k) {
          ASSERT_EQ(modal->step(), StepStatus::ok);
          ASSERT_EQ(table.step(), StepStatus::ok) << k;
          force = std::max(force, modal->force().maxCoeff());
          place = std::max(place, modal->displacement().cwiseAbs().maxCoeff());
          power = std::max(power, std::abs(modal->persistency()));
          force_error = std::max(force_error, (modal->force() - table.force()).cwiseAbs().maxCoeff());
          place_error =
              std::max(place_error, (modal->displacement() - table.displacement()).cwiseAbs().maxCoeff());
          power_error = std::max(power_error, std::abs(modal->persistency() - table.persistency()));
          touches += modal->active() > 0;
        }
        EXPECT_GT(touches, 5);
        EXPECT_LT(touches, steps - 10);
        EXPECT_LT(force_error, 1e-9 * force);
        EXPECT_LT(place_error, 1e-9 * place);
        if (options.contact.scheme == Scheme::compliant) {
          EXPECT_LT(power_error, 1e-8 * power);
        }
        EXPECT_EQ(table.step(), StepStatus::table_ended);
        EXPECT_EQ(table.steps(), steps);
      }
}

/// Mean velocities follow from the forces in the table and from the rigid modes in modal stepping.
TEST(ModalTable, knows_the_velocities_of_free_bodies) {
  const ricochet::kernels::Kernel kernel = rod(40, 10);
  const Model model = build_model({{"left", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                                   {"right", &kernel, Matrix3d::Identity(), {10.25, 0, 0}}},
                                  {}, {{"left", "right", Vector3d(1, 0, 0), {}, {}}}, {-0.01, 0, 0});
  for (const auto& [name, law] : laws) {
    StepOptions options = law;
    options.step = 0.05;
    const auto modal = make_stepper(model, options);
    const Table sampled = table_from_modes(model, options, 500);
    TableStepper table(sampled, options);
    ASSERT_EQ(sampled.bodies.size(), 2U);
    for (int k = 0; k < 500; ++k) {
      ASSERT_EQ(modal->step(), StepStatus::ok);
      ASSERT_EQ(table.step(), StepStatus::ok);
      for (int b = 0; b < 2; ++b)
        ASSERT_NEAR((*table.body_velocities())(0, b), modal->modal()->v(40 * b) / std::sqrt(10), 1e-10)
            << name << " " << k;
    }
  }
}

/// Without /table/flexibility, S follows from the trapezoidal rule, which is exact for rigid motion and
/// otherwise has an error of order Δ². A mass, alone or with a mode, bounces off in one step under λ; the
/// later motion u = vt − S_{k−1} λ shows S.
TEST(ModalTable, is_integrated_to_second_order_where_no_flexibility_is_given) {
  Model model = lively(4, 0.05);
  for (Vector* x : {&model.gap, &model.static_displacement, &model.load, &model.v0}) x->setZero();
  model.R.setZero();
  model.B.setZero();
  model.B(0, 0) = 1;
  model.v0(0) = 1;
  const auto flexibility = [&](double dt, bool sampled) {  // S/Δ over 3 ms
    const std::int64_t steps = std::lround(0.003 / dt);
    const StepOptions options{.step = dt}, impulse{.contact = {.scheme = Scheme::impulse}, .step = dt};
    TableStepper stepper(table_from_modes(model, sampled ? impulse : options, steps + sampled), options);
    EXPECT_EQ(stepper.available(), steps);
    Vector out(steps);
    double force = 0;
    for (std::int64_t k = 1; k <= steps; ++k) {
      EXPECT_EQ(stepper.step(), StepStatus::ok);
      EXPECT_EQ(stepper.active(), k == 1);
      if (k == 1) force = stepper.force()(0);
      out(k - 1) = (stepper.time() - stepper.displacement()(0)) / force / dt;
    }
    return out;
  };
  const auto error = [&](double dt) {
    return (flexibility(dt, true) - flexibility(dt, false)).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(error(1e-4), 1e-15);
  model.B(0, 1) = 0.7;
  EXPECT_NEAR(error(1e-4) / error(5e-5), 4, 0.1);
}

TEST(TableStepper, refuses_what_the_scheme_cannot_do_with_the_table) {
  const StepOptions compliant{.step = step}, impulse{.contact = {.scheme = Scheme::impulse}, .step = step};
  const auto said = [](const Table& table, const StepOptions& options) {
    return complaint_of([&] { TableStepper(table, options); });
  };
  EXPECT_THAT(said(rods(0, 40), {.step = 1 / 44100.0}), HasSubstr("time.rate_hz = 44100"));
  EXPECT_THAT(said(rods(0, 40), {.contact = {.scheme = Scheme::impulse, .restitution = 2}, .step = step}),
              HasSubstr("restitution = 2"));
  Table table = rods(0, 40);
  table.displacement.clear();
  table.velocity.clear();
  EXPECT_THAT(said(table, impulse), HasSubstr("no displacement and velocity"));
  table = rods(0, 40);
  for (double& x : table.velocity) x = -x;
  EXPECT_THAT(said(table, impulse), HasSubstr("the admittance at lag 0"));
  table = table_from_modes(lively(1, 0), {.step = 1e-4}, 10);
  table.flexibility[1] *= 1.1;
  EXPECT_THAT(said(table, {.step = 1e-4}), HasSubstr("not symmetric"));
  table = rods(0, 40);
  EXPECT_EQ(TableStepper(table, compliant).available(), 40);
  table.tail = Tail::linear;
  EXPECT_EQ(TableStepper(table, compliant).available(), TableStepper::endless);
}

#if RICOCHET_HEAP_COUNTED
TEST(TableStepper, takes_no_memory_in_its_steps) {
  for (const auto& [name, law] : laws) {
    StepOptions options = law;
    options.step = 1e-4;
    TableStepper table(table_from_modes(lively(2, 0), options, 4000), options);
    int touching = 0;
    const long before = heap_counter::calls;
    while (table.step() == StepStatus::ok) touching += table.active() > 0;
    EXPECT_EQ(heap_counter::calls, before) << name;
    EXPECT_EQ(table.steps(), 4000);
    EXPECT_GT(touching, 20);
  }
}
#endif

}  // namespace table_test
