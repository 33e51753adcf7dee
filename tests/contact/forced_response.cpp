// SPDX-License-Identifier: BSD-2-Clause
// Loads with histories and moving supports. Modes and energy are compared with Runge–Kutta steps of the
// equation of motion, and bars with waves and statics.
#include "contact/stepping/forced_response.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/heap_counter.hpp"

namespace forced_response_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// A history with knots that no step is aligned with. Some steps contain several knots, others none.
History ragged(double duration, unsigned seed, double start = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  History h{{start}, {start > 0 ? 0.7 : 0.0}};
  while (h.time.back() < 0.8 * duration) {
    h.time.push_back(h.time.back() + duration * (unit(random) < 0.5 ? 0.002 : 0.05) * (0.1 + unit(random)));
    h.value.push_back(2 * unit(random) - 1);
  }
  return h;
}

/// Absolute motion of one mode, by Runge–Kutta in extended precision, in increments of at most `pace` between
/// knots: p̈ = force h − 2δ (ṗ − lift h') − ω² (p − lift h).
struct Mode {
  long double omega, decay, force, lift;
  long double p = 0, rate = 0;

  void run(const History& h, double from, double to, double pace) {
    while (from < to) {
      const std::size_t knot = h.passed(from);
      const double end = knot < h.time.size() ? std::min(to, h.time[knot]) : to;
      const int pieces = static_cast<int>(std::ceil((end - from) / pace));
      const long double dt = (static_cast<long double>(end) - from) / pieces;
      const long double slope = h.slope(from);
      long double value = h.at(from);
      for (int k = 0; k < pieces; ++k, value += slope * dt) {
        const auto acceleration = [&](long double x, long double v, long double t) {
          const long double factor = value + slope * t;
          return force * factor - 2 * decay * (v - lift * slope) - omega * omega * (x - lift * factor);
        };
        const long double a1 = acceleration(p, rate, 0), v2 = rate + a1 * dt / 2;
        const long double a2 = acceleration(p + rate * dt / 2, v2, dt / 2), v3 = rate + a2 * dt / 2;
        const long double a3 = acceleration(p + v2 * dt / 2, v3, dt / 2), v4 = rate + a3 * dt;
        const long double a4 = acceleration(p + v3 * dt, v4, dt);
        p += dt * (rate + 2 * v2 + 2 * v3 + v4) / 6;
        rate += dt * (a1 + 2 * a2 + 2 * a3 + a4) / 6;
      }
      from = end;
    }
  }
};

/// Modes of one body without contact: rigid modes with and without decay, and
/// modes below, at and above critical damping.
Model loose(const History& history, bool support, double step) {
  Model model;
  const std::vector<double> omega = {0, 0, 3, 30, 30, 30, 30, 250}, decay = {0, 5, 0, 0.1, 30, 33.5, 400, 25};
  const Eigen::Index N = static_cast<Eigen::Index>(omega.size());
  model.omega = Eigen::Map<const Vector>(omega.data(), N) * (0.01 / step);
  model.decay = Eigen::Map<const Vector>(decay.data(), N) * (0.01 / step);
  model.load = model.q0 = model.v0 = Vector::Zero(N);
  model.B = Matrix::Zero(0, N);
  model.R = Matrix::Zero(0, 0);
  model.gap = model.static_displacement = model.area = Vector::Zero(0);
  model.bodies.resize(1);
  model.bodies[0].modes = static_cast<int>(N);
  Model::Forcing one;
  one.support = support;
  one.history = history;
  one.force = one.lift = one.displacement = Vector::Zero(0);
  one.force.setConstant(N, support ? 0 : 1.5);
  one.lift.setConstant(N, support ? 0.8 : 0);
  model.forcing = {one};
  return model;
}

/// Steps `model` and compares each mode with Runge–Kutta steps. 1e-10: their error with 1000 increments per
/// step, with the highest mode at ωΔ = 2.5, and round-off of 60 steps.
void expect_motion_of_modes(const Model& model, const StepOptions& options, int steps) {
  const Model::Forcing& forcing = model.forcing[0];
  const History& history = forcing.history;
  const double step = options.step;
  const auto stepper = make_stepper(model, options);
  std::vector<Mode> modes;
  for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
    modes.push_back({model.omega(n), model.decay(n), forcing.force(n), forcing.lift(n)});
    modes.back().p = modes.back().lift * history.at(0);
  }
  for (int k = 1; k <= steps; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
      Mode& mode = modes[n];
      mode.run(history, (k - 1) * step, k * step, step / 1000);
      const double lift = forcing.lift(n), size = forcing.support ? 1 : 1e-2;
      EXPECT_NEAR(stepper->modal()->q(n) + lift * history.at(k * step), static_cast<double>(mode.p),
                  1e-9 * size)
          << n << " " << k;
      EXPECT_NEAR(stepper->modal()->v(n) + lift * history.slope(k * step), static_cast<double>(mode.rate),
                  1e-7 * size)
          << n << " " << k;
    }
  }
}

std::vector<StepOptions> all_schemes(double step) {
  return {{.contact = {.scheme = Scheme::compliant}, .step = step},
          {.contact = {.scheme = Scheme::impulse}, .step = step},
          {.contact = {.scheme = Scheme::impulse, .instant = Instant::exact}, .step = step}};
}

TEST(Forcing, moves_modes_of_any_damping_exactly_for_any_knots) {
  const double step = 0.01;
  constexpr int steps = 60;
  for (const bool support : {false, true})
    for (const double start : {-0.0123, 0.0, 0.0437}) {
      if (support && start > 0) continue;  // supports do not jump
      SCOPED_TRACE(testing::Message() << (support ? "support" : "load") << " from " << start);
      const Model model = loose(ragged(steps * step, 3, start), support, step);
      for (const StepOptions& options : all_schemes(step)) expect_motion_of_modes(model, options, steps);
    }
}

// A support that changes its speed at t_k gives the modes their velocity jump in step k, neither in the next
// one nor in both.
TEST(Forcing, moves_modes_exactly_for_knots_at_the_ends_of_steps) {
  const double step = 0.01;
  const History history{{0, 3 * step, 4 * step, 7 * step}, {0, 0.7, -0.4, 0.2}};
  for (const bool support : {false, true})
    for (const StepOptions& options : all_schemes(step)) {
      SCOPED_TRACE(support ? "support" : "load");
      const Model model = loose(history, support, step);
      expect_motion_of_modes(model, options, 10);
      const auto stepper = make_stepper(model, options);
      for (int k = 0; k < 10; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        const Energy& energy = stepper->modal()->energy();
        // The body starts at rest, so that the ledger is 0 up to round-off.
        EXPECT_NEAR(energy.ledger(), 0, 1e-12 * (std::abs(energy.loads) + energy.kinetic)) << k;
      }
    }
}

// Under a load that grows steadily, a damped mode settles at its rest position, which lags f/ω². The
// points follow it. 1e-12: round-off, after the motion has decayed by e^−40.
TEST(Forcing, moves_rest_positions_to_where_a_damped_body_settles) {
  Model model = loose({{0, 200}, {0, 80}}, false, 0.01);
  const Eigen::Index N = model.omega.size();
  for (Eigen::Index n = 0; n < N; ++n) model.omega(n) = 1 + 0.7 * static_cast<double>(n);
  model.decay = 0.4 * model.omega;
  model.load.setLinSpaced(0.3, -0.2);
  model.B = Matrix::Random(2, N);
  model.R = Matrix::Zero(2, 2);
  model.gap = Vector::Constant(2, 1e3);
  model.area = Vector::Ones(2);
  model.static_displacement = Vector{{0.01, -0.02}};
  model.forcing[0].displacement = Vector{{0.1, 0.3}};
  const auto stepper = make_stepper(model, {.step = 0.1});
  while (stepper->time() < 100) ASSERT_EQ(stepper->step(), StepStatus::ok);
  ForcedResponse forcing(model, 0.1);
  const double t = stepper->time();
  const ForcedResponse::Piece& piece = forcing.piece(t);
  EXPECT_FALSE(piece.steady);
  EXPECT_EQ(piece.to, 200);
  const Vector y = stepper->modal()->q - piece.rest_q - model.load.cwiseQuotient(model.omega.cwiseAbs2());
  EXPECT_LT(y.norm(), 1e-12 * stepper->modal()->q.norm());
  EXPECT_LT((stepper->modal()->v - piece.rest_v).norm(), 1e-12 * piece.rest_v.norm());
  const Vector u = stepper->displacement();
  EXPECT_LT((u - piece.rest).norm(), 1e-12 * u.norm());
  ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_LT((stepper->displacement() - u - 0.1 * piece.drift).norm(), 1e-12 * u.norm());
}

/// A body above a floor with a load and a moving support, both with ragged histories.
Model busy(double step, double gap, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  Model model = loose(ragged(300 * step, seed), false, step);
  const Eigen::Index N = model.omega.size(), m = 3;
  model.load.setConstant(0.4);
  model.B = Matrix::NullaryExpr(m, N, [&] { return spread(random); });
  model.R = 1e-4 * step * step * Matrix::Identity(m, m) + Matrix::Constant(m, m, 2e-5 * step * step);
  model.has_residual = true;
  model.gap = Vector::Constant(m, gap);
  model.static_displacement = Vector::Zero(m);
  model.area = Vector::Ones(m);
  model.forcing[0].displacement = Vector::Constant(m, 1e-4 * gap);
  Model::Forcing support = loose(ragged(300 * step, seed + 1), true, step).forcing[0];
  support.lift = 0.05 * gap * Vector::NullaryExpr(N, [&] { return spread(random); });
  support.displacement = model.B * support.lift + 0.3 * gap * Vector::Ones(m);
  model.forcing.push_back(support);
  return model;
}

// Tolerances are the round-off of 400 steps. The compliant scheme must not gain
// energy although the forcing does work.
TEST(Ledger, closes_with_loads_and_supports_that_change_within_steps) {
  const double step = 0.01;
  int touching = 0;
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const StepOptions& options :
         {StepOptions{.contact = {.scheme = Scheme::compliant}, .step = step},
          StepOptions{.contact = {.scheme = Scheme::impulse, .restitution = 0.3}, .step = step},
          StepOptions{.contact = {.scheme = Scheme::impulse, .admittance = Admittance::difference},
          .step = step}}) {
      const auto stepper = make_stepper(busy(step, 1e-3, seed), options);
      const double start = stepper->modal()->energy().ledger();
      double size = 0, worst = 0, gain = 0;
      for (int k = 0; k < 400; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        const Energy& e = stepper->modal()->energy();
        size = std::max({size, e.kinetic + e.strain, std::abs(e.loads)});
        worst = std::max(worst, std::abs(e.ledger() - start));
        gain = std::max(gain, -e.contact);
        touching += stepper->active() > 0;
      }
      EXPECT_LT(worst, 1e-12 * size) << seed;
      if (options.contact.admittance == Admittance::jump) {
        EXPECT_LT(gain, 1e-12 * size) << seed;
      }
    }
  EXPECT_GT(touching, 200);
}

// Work ∫ f q̇ dt and damping losses by quadrature of the Runge–Kutta solution.
TEST(Ledger, counts_the_work_of_a_load_as_its_integral) {
  const double step = 0.01;
  const History history = ragged(20 * step, 8);
  const Model model = loose(history, false, step);
  const auto stepper = make_stepper(model, {.step = step});
  for (int k = 0; k < 20; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  long double work = 0, lost = 0;
  for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
    Mode mode{model.omega(n), model.decay(n), 1.5L, 0};
    for (double t = 0; t < 20 * step - 1e-9;) {  // midpoint rule, with intervals that end at knots
      const std::size_t knot = history.passed(t);
      const double end =
          std::min({t + step / 2000, 20 * step, knot < history.time.size() ? history.time[knot] : 1.0});
      const double middle = 0.5 * (t + end);
      mode.run(history, t, middle, step);
      work += (end - t) * 1.5L * history.at(middle) * mode.rate;
      lost += (end - t) * 2 * mode.decay * mode.rate * mode.rate;
      mode.run(history, middle, end, step);
      t = end;
    }
  }
  // 1e-7: error of the midpoint rule with 2000 intervals per step and the highest mode at ωΔ = 2.5.
  EXPECT_NEAR(stepper->modal()->energy().loads, static_cast<double>(work),
              1e-6 * std::abs(static_cast<double>(work)));
  EXPECT_NEAR(stepper->modal()->energy().damping, static_cast<double>(lost),
              1e-6 * static_cast<double>(lost));
}

// A support lifts a unit mass at speed 2 from t = 0 on. The lift is rigid. The mass vibrates relative to it
// until the damper stops it, and the work must include the final kinetic energy ½ m v².
TEST(Ledger, counts_the_work_of_a_support_that_gets_a_body_moving) {
  Model model = loose({{0, 100}, {0, 200}}, true, 0.01);
  for (Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->conservativeResize(1);
  model.omega << 50;
  model.decay << 20;
  model.B.resize(0, 1);
  model.bodies[0].modes = 1;
  model.forcing[0].force = Vector::Zero(1);
  model.forcing[0].lift = Vector::Ones(1);
  const auto stepper = make_stepper(model, {.step = 0.01});
  EXPECT_EQ(stepper->modal()->energy().kinetic, 0);
  for (int k = 0; k < 500; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->modal()->energy().kinetic, 2, 1e-12);
  EXPECT_NEAR(stepper->modal()->energy().strain, 0, 1e-12);
  // The support does 2 J of work on the mass and 2 J on the damper: relative to the
  // support, the mass starts at speed −2.
  EXPECT_NEAR(stepper->modal()->energy().damping, 2, 1e-12);
  EXPECT_NEAR(stepper->modal()->energy().loads, 4, 1e-12);
}

constexpr double length = 10;

/// The bar under `forcing`, with its tip in front of a wall at the distance `gap`.
Model bar_at_wall(const Kernel& bar, double gap, const std::vector<ForcingRequest>& forcing,
                  double gravity = 0) {
  return build_model({{"bar", &bar}}, {{"wall", Vector3d(length + gap, 0, 0), Vector3d(-1, 0, 0)}},
                     {{"bar", "wall", {}, {}, 20 * length}}, {gravity, 0, 0}, forcing);
}

// The foot starts to move at speed V. The wave reaches the tip at t = L, is doubled there, and returns from
// the foot with the opposite sign: the tip moves at 2V from L to 3L, at 0 from 3L to 5L, and so on. 200 modes
// blur each front over 2L/200, which gives an error of 1e-3 V L.
TEST(Bar, whose_foot_moves_follows_the_waves) {
  const Kernel bar = clamped_bar(200, length);
  const double speed = 0.3, step = 0.07;
  const Model model = bar_at_wall(bar, 50, {{"bar", "foot", true, {speed, 0, 0}, {{0, 1000}, {0, 1000}}}});
  const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::impulse}, .step = step});
  double largest = 0;
  for (int k = 1; k <= 1000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const double t = stepper->time();
    double tip = 0;
    for (double front = length; front < t; front += 4 * length)
      tip += 2 * speed * std::min(t - front, 2 * length);
    largest = std::max(largest, std::abs(stepper->displacement()(0) - tip));
    if (std::abs(std::fmod(t, 2 * length) - length) > 1) {
      const double rate = model.B.row(0).dot(stepper->modal()->v) + speed;  // Ψ = 1
      EXPECT_NEAR(rate, std::fmod(t + length, 4 * length) > 2 * length ? 2 * speed : 0, 0.15 * speed) << t;
    }
  }
  EXPECT_LT(largest, 2e-3 * speed * length);
  EXPECT_LT(stepper->modal()->energy().ledger(), 1e-10);
}

// The foot presses the bar slowly against the wall; once at rest, the bar
// is a spring EA/L. 1e-6: residual motion.
TEST(Bar, pressed_by_its_foot_is_a_spring) {
  for (const int modes : {3, 40}) {
    Kernel bar = clamped_bar(modes, length);
    for (double& decay : bar.modes.decay_rate) decay = 0.5;
    const double travel = 0.03, gap = 0.01;
    const Model model = bar_at_wall(bar, gap, {{"bar", "foot", true, {travel, 0, 0}, {{3, 40}, {0, 1}}}});
    const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = 0.1});
    for (int k = 0; k < 2000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_NEAR(stepper->force()(0), (travel - gap) / length, 1e-6 * travel / length) << modes;
    EXPECT_NEAR(stepper->displacement()(0), gap, 1e-15);
    // Work of the foot: ½ k x² in the bar, plus the losses to damping and contact.
    const Energy& e = stepper->modal()->energy();
    EXPECT_NEAR(e.kinetic, 0, 1e-12);
    EXPECT_LT(std::abs(e.ledger()), 1e-15);
  }
}

// A load of 2 on the tip stretches the bar by 2 L once e^{−0.15 t} has decayed, no matter which modes are
// stepped and which are static because they lie above half the rate.
TEST(Bar, stretches_by_its_load_whichever_of_its_modes_are_static) {
  for (const double step : {0.01, 0.5, 5.0, 100.0}) {
    Kernel bar = clamped_bar(20, length);
    for (double& decay : bar.modes.decay_rate) decay = 0.15;
    const Model model =
        bar_at_wall(bar, 100, {{"bar", "tip", false, {2, 0, 0}, {{0, 30, 31.7}, {0, 0.5, 1}}}});
    const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = step});
    while (stepper->time() < 300) ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_NEAR(stepper->displacement()(0), 2 * length, 1e-9) << step;
    EXPECT_EQ(stepper->modal()->modes_in_residual() > 0, step > 0.5);
  }
}

// A foot that is displaced from the start on only changes the gap.
TEST(Bar, whose_foot_is_displaced_from_the_start_is_at_rest) {
  const Kernel bar = clamped_bar(20, length);
  const Model model = bar_at_wall(bar, 1, {{"bar", "foot", true, {0.25, 0, 0}, {}}});
  const auto stepper = make_stepper(model, {.step = 0.1});
  for (int k = 0; k < 100; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->displacement()(0), 0.25, 1e-14);
  EXPECT_EQ(stepper->modal()->v.norm(), 0);
  EXPECT_EQ(stepper->modal()->energy().total(), 0);
}

// Two ends of one body touch two walls. No mode lies below half the rate, so
// λ = R⁻¹ (d h − g) with a full matrix R.
TEST(Pairs, of_one_body_are_coupled_through_its_residual_flexibility) {
  Kernel block;
  block.mass = 1;
  block.supported = true;
  add_candidate(block, {-1, 0, 0}, {-1, 0, 0}, 1);
  add_candidate(block, {1, 0, 0}, {1, 0, 0}, 1);
  block.surface.components = 1;
  block.surface.direction = ricochet::Vector3{1, 0, 0};
  block.surface.element_corners = 1;
  block.surface.element = {0, 1};
  block.modes.angular_frequency = {1e6};
  block.modes.decay_rate = {0};
  block.surface.shape = {0, 0};
  block.loads.body_force.assign(3, 0);
  block.loads.rotation.assign(3, 0);
  block.surface.residual_flexibility = {2, -0.5, -0.5, 3};
  block.applied = {{"swell",
                    "Pa",
                    {0, 0, 0},
                    std::vector<double>(9, 0),
                    std::vector<double>(9, 0),
                    {-0.4, 0, 0, 0.7, 0, 0}}};
  const Model model = build_model(
      {{"block", &block}},
      {{"left", Vector3d(-1.1, 0, 0), Vector3d(1, 0, 0)}, {"right", Vector3d(1.2, 0, 0), Vector3d(-1, 0, 0)}},
      {{"block", "left", {}, {}, 0.5}, {"block", "right", {}, {}, 0.5}}, Vector3d::Zero(),
      {{"block", "swell", false, {1, 0, 0}, {{0, 1}, {0, 1}}}});
  ASSERT_EQ(model.gap.size(), 2);
  const auto stepper = make_stepper(model, {.step = 0.05});
  for (int k = 1; k <= 30; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const double h = std::min(1.0, k * 0.05);
    // Along the normals, R is [2, 0.5; 0.5, 3]. Both ends are pressed, or only one.
    const double a = 0.4 * h - 0.1, b = 0.7 * h - 0.2, both = 2 * 3 - 0.25;
    double left = (3 * a - 0.5 * b) / both, right = (2 * b - 0.5 * a) / both;
    if (left < 0 || right < 0) {
      left = std::max(0.0, a / 2);
      right = left > 0 && b - 0.25 * a <= 0 ? 0 : std::max(0.0, b / 3);
      if (right > 0 && left > 0) left = 0;
    }
    EXPECT_NEAR(stepper->end_force()(0), left, 1e-14) << h;
    EXPECT_NEAR(stepper->end_force()(1), right, 1e-14) << h;
  }
  EXPECT_GT(stepper->force().minCoeff(), 0.1);
}

TEST(Forcing, is_refused_if_the_kernel_lacks_it_or_it_jumps_or_makes_bodies_overlap) {
  const Kernel bar = clamped_bar(3, length);
  EXPECT_THAT(complaint_of([&] {
                bar_at_wall(bar, 1, {{"bar", "top", false, {1, 0, 0}, {}}});
              }),
              HasSubstr("has no \"top\", only \"tip\""));
  EXPECT_THAT(complaint_of([&] {
                bar_at_wall(bar, 1, {{"bar", "tip", true, {1, 0, 0}, {}}});
              }),
              HasSubstr("\"foot\""));
  EXPECT_THAT(complaint_of([&] {
                bar_at_wall(bar, 1, {{"rod", "tip", false, {1, 0, 0}, {}}});
              }),
              HasSubstr("\"rod\""));
  EXPECT_THAT(complaint_of([&] {
                bar_at_wall(bar, 1, {{"bar", "foot", true, {1, 0, 0}, {{0.5, 1}, {0.1, 0}}}});
              }),
              HasSubstr("would jump"));
  bar_at_wall(bar, 1, {{"bar", "foot", true, {1, 0, 0}, {}}});
  EXPECT_THAT(complaint_of([&] {
                bar_at_wall(bar, 1, {{"bar", "foot", true, {1.25, 0, 0}, {}}});
              }),
              HasSubstr("press the bodies 0.25 m into each other"));
}

#if RICOCHET_HEAP_COUNTED
TEST(Forcing, does_not_allocate) {
  for (const Scheme scheme : {Scheme::compliant, Scheme::impulse}) {
    const auto stepper =
        make_stepper(busy(0.01, 1e-3, 4),
                     {.contact = {.scheme = scheme, .admittance = Admittance::difference}, .step = 0.01});
    const long before = heap_counter::calls;
    for (int k = 0; k < 300; ++k)
      if (stepper->step() != StepStatus::ok) break;
    EXPECT_EQ(heap_counter::calls, before);
    EXPECT_EQ(stepper->steps(), 300);
  }
}
#endif

}  // namespace forced_response_test
