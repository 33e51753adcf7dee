// SPDX-License-Identifier: BSD-2-Clause
// Look-ahead blocks compared with single steps: the same forces and motion to
// round-off, whichever points are screened out.
#include "contact/stepping/look_ahead_block.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "benchmarks/plates.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/heap_counter.hpp"

namespace look_ahead_block_test {

namespace benchmarks = ricochet::benchmarks;
using namespace ricochet::contact;
using ricochet::ContactStep;
using ricochet::Precision;
using ricochet::StepOptions;
using ricochet::StepStatus;

constexpr double step = 1 / 44100.0;

/// A damped body with one rigid and `modes` − 1 elastic modes that falls on a rigid floor under its weight.
/// Its points lie up to `spread` above the lowest.
Model dropped(Eigen::Index modes, Eigen::Index points, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Model model;
  for (Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->setZero(modes);
  model.B.setZero(points, modes);
  model.R.setZero(points, points);
  model.static_displacement.setZero(points);
  model.area.setOnes(points);
  model.gap.setZero(points);
  model.B.col(0).setConstant(0.7);
  model.load(0) = 14;
  model.v0(0) = 0.1;
  for (Eigen::Index i = 0; i < points; ++i)
    model.gap(i) = 1e-5 + spread * static_cast<double>(i) / static_cast<double>(points);
  for (Eigen::Index n = 1; n < modes; ++n) {
    // The highest modes lie above half the rate and move into R.
    model.omega(n) = 2e5 * std::pow(static_cast<double>(n) / static_cast<double>(modes), 2) + 500;
    model.decay(n) = 5 + 1e-4 * model.omega(n);
    for (Eigen::Index i = 0; i < points; ++i) model.B(i, n) = uniform(random);
  }
  model.R.diagonal().setConstant(1e-9);
  model.has_residual = true;
  return model;
}

struct Difference {
  double force = 0, motion = 0, displacement = 0;  ///< largest relative differences
  int touches = 0;
};

/// Compares `steps` steps of both: after each step if every state is kept, otherwise after each block.
Difference compare(const Model& model, StepOptions options, int steps) {
  StepOptions plain = options;
  plain.block = 1;
  plain.every_state = true;
  const auto expected = make_stepper(model, plain);
  const auto found = make_stepper(model, options);
  double force = 0, motion = 0, displacement = 0;
  Difference worst;
  for (int k = 1; k <= steps; ++k) {
    EXPECT_EQ(expected->step(), StepStatus::ok);
    EXPECT_EQ(found->step(), StepStatus::ok);
    force = std::max(force, expected->force().maxCoeff());
    worst.force = std::max(worst.force, (expected->force() - found->force()).cwiseAbs().maxCoeff());
    worst.touches += expected->active() > 0 ? 1 : 0;
    if (!options.every_state && k % options.block != 0) continue;
    motion = std::max(motion, expected->modal()->v.norm());
    worst.motion = std::max(worst.motion, (expected->modal()->v - found->modal()->v).norm());
    displacement = std::max(displacement, expected->displacement().cwiseAbs().maxCoeff());
    worst.displacement = std::max(worst.displacement,
                                  (expected->displacement() - found->displacement()).cwiseAbs().maxCoeff());
  }
  worst.force /= force;
  worst.motion /= motion;
  worst.displacement /= displacement;
  return worst;
}

// 1e-8: impacts amplify round-off by about 1e5 over these steps.
TEST(Blocks, give_the_forces_and_motion_of_plain_steps) {
  for (const int block : {2, 3, 8, 16, 21, 64})
    for (const bool every_state : {true, false})
      for (const double spread : {0.0, 1e-4, 1e-1}) {
        const Model model = dropped(60, 12, spread, 3);
        const Difference difference =
            compare(model, {.step = step, .block = block, .every_state = every_state}, 480);
        EXPECT_LT(difference.force, 1e-8) << block << ' ' << spread;
        EXPECT_LT(difference.motion, 1e-8) << block << ' ' << spread;
        EXPECT_LT(difference.displacement, 1e-8) << block << ' ' << spread;
        EXPECT_GT(difference.touches, 3) << block << ' ' << spread;
      }
}

// The weak force at point 0 does not make point 1 a candidate of the screening, but the strong force at point
// 2 does. Both turn point 1 into the floor before the block ends.
TEST(Blocks, make_up_for_earlier_forces_at_points_that_come_into_sight) {
  Model model = dropped(3, 3, 0, 1);
  model.omega.setZero();
  model.decay.setZero();
  model.load.setZero();
  model.B << 0, 0, 1, 1, -1.5, -0.5, 1, 1, 0;
  model.v0 << 0.26, 0, 0.01;
  model.gap << 5e-7, 4.3e-4, 4.7e-5;
  const StepOptions options{.step = step, .block = 64};
  const auto stepper = make_stepper(model, options);
  for (int k = 0; k < 64; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    if (stepper->force()(1) > 0) break;
  }
  EXPECT_GT(stepper->force()(1), 0);
  EXPECT_GT(stepper->steps(), 30);
  // 1e-8: R p is twenty times M p here, so that its round-off in M p is, too.
  const Difference difference = compare(model, options, 64);
  EXPECT_LT(difference.force, 1e-8);
  EXPECT_LT(difference.motion, 1e-8);
}

// Knots lie within steps and within blocks. The load repeatedly throws the
// body up, and the support moves its points.
TEST(Blocks, give_those_of_plain_steps_under_loads_with_histories_and_supports_that_move) {
  Model model = dropped(60, 12, 1e-4, 3);
  model.bodies.resize(1);
  model.bodies[0].modes = 60;
  Model::Forcing one;
  one.force = 1e-1 * Vector::Random(60);
  one.force(0) = -30;
  one.lift.setZero(60);
  one.displacement = 1e-8 * Vector::Random(12);
  one.history = {{0, 0.0013, 0.0031, 0.0044, 0.0071}, {0, 1, -1.5, 2, -1}};
  model.forcing.push_back(one);
  one.support = true;
  one.force.setZero();
  one.lift = 1e-2 * Vector::Random(60);
  one.displacement = 1e-5 * Vector::Random(12);
  model.forcing.push_back(one);
  for (const int block : {3, 8, 24}) {
    const Difference difference = compare(model, {.step = step, .block = block}, 480);
    EXPECT_LT(difference.force, 1e-8) << block;  // each contact amplifies round-off
    EXPECT_LT(difference.motion, 1e-9) << block;
    EXPECT_LT(difference.displacement, 1e-9) << block;
    EXPECT_GT(difference.touches, 3) << block;
  }
}

// Blocks without knots skip candidates although a load grows and a support moves: the rest position of the
// modes moves with them. Later, both are constant.
TEST(Blocks, give_those_of_plain_steps_under_loads_that_change_steadily) {
  for (const bool support : {false, true}) {
    Model model = dropped(60, 12, 1e-4, 3);
    model.decay = 0.02 * model.omega;
    model.bodies.resize(1);
    model.bodies[0].modes = 60;
    Model::Forcing one;
    one.support = support;
    one.force.setZero(60);
    one.lift = one.force;
    (support ? one.lift : one.force) = (support ? 1e-2 : 5.0) * Vector::Random(60);
    if (!support) one.force(0) = -30;
    one.displacement = (support ? 1e-4 : 1e-7) * Vector::Random(12);
    one.history = {{-0.001, 0.0043}, {0, 1}};
    model.forcing.push_back(one);
    for (const int block : {8, 24}) {
      const Difference difference = compare(model, {.step = step, .block = block, .every_state = false}, 480);
      EXPECT_LT(difference.force, 1e-8) << block;  // each contact amplifies round-off
      EXPECT_LT(difference.motion, 1e-9) << block;
      EXPECT_LT(difference.displacement, 1e-9) << block;
      EXPECT_GT(difference.touches, 3) << block;
    }
  }
}

// Conserving contact that chatters doubles round-off within some twenty steps, backward Euler damps it.
TEST(Blocks, give_those_of_two_plates_that_stay_in_contact) {
  const Model model = benchmarks::plates(6, 5, 80);
  for (const auto& [law, steps] :
       {std::pair{ContactStep::conserving, 512}, {ContactStep::backward_euler, 4096}}) {
    const Difference difference = compare(
        model, {.contact = {.integration = law}, .step = step, .block = 16, .every_state = false}, steps);
    EXPECT_LT(difference.force, 1e-7);
    EXPECT_LT(difference.motion, 1e-7);
    EXPECT_GT(difference.touches, steps / 3);
  }
}

// The forces of a chattering contact depend on the entire history, so only the
// impulse of the first 500 steps is compared.
TEST(Blocks, in_single_precision_give_the_impulse_to_1e_4) {
  const Model model = benchmarks::plates(6, 5, 80);
  double impulse[2] = {0, 0};
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    const auto stepper = make_stepper(model, {.step = step, .precision = precision, .every_state = false});
    for (int k = 0; k < 512; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      impulse[precision == Precision::float32] += stepper->force().sum() * step;
    }
  }
  EXPECT_GT(impulse[0], 0);
  EXPECT_NEAR(impulse[1] / impulse[0], 1, 1e-4);
}

TEST(Blocks, take_no_memory) {
  const Model model = dropped(60, 12, 1e-4, 5);
  for (const bool every_state : {true, false}) {
    const auto stepper = make_stepper(model, {.step = step, .every_state = every_state});
    const auto before = heap_counter::calls.load();
    for (int k = 0; k < 5000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_EQ(heap_counter::calls.load(), before);
  }
}

TEST(Blocks, are_not_taken_beyond_a_step_that_fails) {
  Model model = dropped(5, 2, 0, 1);
  model.v0(0) = std::numeric_limits<double>::quiet_NaN();
  for (const bool every_state : {true, false}) {
    const auto stepper = make_stepper(model, {.step = step, .every_state = every_state});
    StepStatus status = StepStatus::ok;
    for (int k = 0; k < 16 && status == StepStatus::ok; ++k) status = stepper->step();
    EXPECT_EQ(status, StepStatus::not_finite);
  }
}

// The body flies off with an energy beyond double precision. If states are kept only at the ends of blocks,
// the whole block fails at its last step.
TEST(Blocks, leave_the_state_before_them_when_they_fail_and_fail_again) {
  Model model = dropped(5, 2, 0, 1);
  model.v0(0) = -1e200;
  for (const bool every_state : {true, false}) {
    const auto stepper = make_stepper(model, {.step = step, .block = 4, .every_state = every_state});
    for (int attempt = 0; attempt < 3; ++attempt) {
      for (int k = 1; k < 4 && !every_state; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
      EXPECT_EQ(stepper->step(), StepStatus::not_finite);
      EXPECT_EQ(stepper->steps(), 0);
      EXPECT_EQ(stepper->pending(), 0);
      EXPECT_EQ(stepper->force(), Vector::Zero(2));
      EXPECT_EQ(stepper->active(), 0);
      EXPECT_EQ(stepper->modal()->v, model.v0);
    }
  }
}

// A mode that moves no point gains speed until its energy exceeds double precision, in the sixth step: the
// second block fails. Forces, states and counts are then those after the first.
TEST(Blocks, that_fail_after_others_leave_the_last_known_step) {
  Model model = dropped(6, 2, 0, 1);
  model.gap.setZero();
  model.B.col(5).setZero();
  model.omega(5) = model.decay(5) = 0;
  model.load(5) = 3.2e153 / step;
  const auto stepper = make_stepper(model, {.step = step, .block = 4, .every_state = false});
  for (int k = 0; k < 4; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  ASSERT_EQ(stepper->pending(), 0);
  const Vector force = stepper->force(), displacement = stepper->displacement(), speed = stepper->modal()->v;
  const int active = stepper->active();
  const double persistency = stepper->persistency();
  EXPECT_GT(force.sum(), 0);
  for (int attempt = 0; attempt < 2; ++attempt) {
    bool differs = false;
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      differs |= stepper->force() != force;
    }
    EXPECT_TRUE(differs);
    EXPECT_EQ(stepper->step(), StepStatus::not_finite);
    EXPECT_EQ(stepper->steps(), 4);
    EXPECT_EQ(stepper->pending(), 0);
    EXPECT_EQ(stepper->force(), force);
    EXPECT_EQ(stepper->active(), active);
    EXPECT_EQ(stepper->persistency(), persistency);
    EXPECT_EQ(stepper->modal()->v, speed);
    EXPECT_EQ(stepper->displacement(), displacement);
  }
}

/// Makes `steps` steps of a block from the state of a stepper. `force` is that of the last step.
template <class T>
void run(LookAheadBlock<T>& block, ContactLaw law, const Stepper& from, int steps, Vector& force) {
  MeanForce mean(force.size(), true);
  Vector end = from.end_force();
  mean.advance(end, {MeanForce::Pair{}});
  block.forcing().set(from.modal()->forcing.piece(), std::numeric_limits<double>::max(),
                      from.modal()->system->load, from.modal()->s);
  block.start(from.modal()->q, from.modal()->v, from.force(), law, mean);
  for (int k = 0; k < steps; ++k) {
    ASSERT_EQ(block.step(law, mean, nullptr, force, end).status, SolveStatus::solved);
    law.accept(mean, end);
  }
}

// A block that is taken back must not keep anything of its steps: neither forces nor displacements.
TEST(Blocks, that_are_taken_back_start_again_as_new_ones) {
  const Model model = dropped(60, 12, 1e-5, 3);
  const StepOptions options{.step = step, .block = 1};
  const auto stepper = make_stepper(model, options);
  while (stepper->active() == 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const auto system = std::make_shared<const BlockSystem<double>>(make_step_system(borrowed(model), options),
                                                                  8, options.step);
  for (const int steps : {1, 3, 8}) {
    LookAheadBlock<double> block(system, false), fresh(system, false);
    const ContactLaw law(model, options);
    Vector force = Vector::Zero(12), expected = force;
    run(block, law, *stepper, steps, force);
    block.take_back();
    EXPECT_TRUE(block.over());
    EXPECT_EQ(block.kept(), 0);
    run(block, law, *stepper, 1, force);
    run(fresh, law, *stepper, 1, expected);
    EXPECT_GT(expected.maxCoeff(), 0);
    // 1e-9: the matrices of the two problems may contain other points.
    EXPECT_LT((force - expected).norm(), 1e-9 * expected.norm());
    EXPECT_NEAR(block.work(), fresh.work(), 1e-9 * std::abs(fresh.work()));
    const simd::Sums found = block.advance(false), exact = fresh.advance(false);
    EXPECT_NEAR(found.contact, exact.contact, 1e-9 * std::abs(exact.contact));
    EXPECT_NEAR(found.kinetic, exact.kinetic, 1e-9 * exact.kinetic);
  }
}

// Contact that has become smaller leaves points in the matrices that no block needs. They are dropped after
// some blocks, so that a block which once kept many points keeps as few as one that never did.
TEST(Blocks, drop_points_that_have_gone_away) {
  constexpr int points = 40, length = 8, blocks = 40;
  const Model model = dropped(60, points, 0, 3);
  const StepOptions options{.step = step, .block = 1};
  const auto stepper = make_stepper(model, options);
  const auto system = std::make_shared<const BlockSystem<double>>(make_step_system(borrowed(model), options),
                                                                  length, options.step);
  const ContactLaw law(model, options);
  Vector force = Vector::Zero(points);
  const auto run_blocks = [&](LookAheadBlock<double>& block, int count) {
    for (int k = 0; k < count; ++k) run(block, law, *stepper, length, force);
    return block.kept();
  };
  while (stepper->active() == 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
  LookAheadBlock<double> ahead(system, false);
  const int many = run_blocks(ahead, 2);
  int few = points;
  // More than half: with fewer, a block chooses its points anew at once.
  for (int k = 0; k < 400 && !(few < many * 3 / 4 && few > many * 3 / 5); ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    LookAheadBlock<double> fresh(system, false);
    few = run_blocks(fresh, 3);
  }
  LookAheadBlock<double> fresh(system, false);
  few = run_blocks(fresh, blocks);
  ASSERT_GT(few, many / 2);
  ASSERT_LT(few, many * 3 / 4);
  EXPECT_EQ(run_blocks(ahead, 2), many);
  EXPECT_LE(run_blocks(ahead, blocks), few + few / 16);
  EXPECT_GE(ahead.kept(), few);
}

// Many points far apart: their matrices are computed when points come into sight, within a step, which must
// not allocate. 1e-8: impacts amplify round-off by 1e4 to 1e5 over these steps; the sums of a processor with
// AVX2 lead to 2.5e-9, and those of others to less.
TEST(Blocks, of_many_points_compute_the_matrices_of_those_that_may_touch) {
  constexpr int points = 300, block = 64;
  const Model model = dropped(60, points, 1e-1, 3);
  const Difference difference = compare(model, {.step = step, .block = block}, 480);
  EXPECT_LT(difference.force, 1e-8);
  EXPECT_LT(difference.motion, 1e-8);
  EXPECT_GT(difference.touches, 3);

  const auto counted = make_stepper(model, {.step = step, .block = block});
  const long before = heap_counter::calls;
  for (int k = 0; k < 480; ++k) ASSERT_EQ(counted->step(), StepStatus::ok);
  EXPECT_EQ(heap_counter::calls, before);

  const StepOptions options{.step = step, .block = 1};
  const auto stepper = make_stepper(model, options);
  while (stepper->active() == 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const auto system = std::make_shared<const BlockSystem<double>>(make_step_system(borrowed(model), options),
                                                                  block, options.step);
  LookAheadBlock<double> ahead(system, false);
  Vector force = Vector::Zero(points);
  run(ahead, ContactLaw(model, options), *stepper, 8, force);
  int computed = 0;
  for (int i = 0; i < points; ++i) computed += system->matrices->place(i) >= 0 ? 1 : 0;
  EXPECT_GT(force.maxCoeff(), 0);
  EXPECT_GT(computed, 0);
  EXPECT_LT(computed, points / 4);
}

/// Random numbers; entries of the padding are 0.
template <class T>
std::vector<T> noise(std::size_t rows, std::size_t columns, std::size_t used, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<T> uniform(-1, 1);
  std::vector<T> out(rows * columns, T(0));
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < used; ++j) out[i * columns + j] = uniform(random);
  return out;
}

/// Compares all loops of one precision with sequential sums in long double.
template <class T>
void check_loops(const simd::InstructionSet& set) {
  SCOPED_TRACE(set.name);
  const simd::Loops<T>& loops = simd::loops_of<T>(set);
  const T tolerance = 100 * std::numeric_limits<T>::epsilon();
  constexpr std::size_t modes = 64, used = 41, points = 7, steps = 5, lags = 8, width = 48;
  const auto B = noise<T>(points, modes, used, 1), x = noise<T>(steps, modes, used, 2);
  const std::vector<int> rows{5, 0, 3, 6, 2};

  std::vector<double> u(steps * width, 1.0);
  loops.displacement(modes, B.data(), rows.data(), rows.size(), x.data(), steps, u.data(), width);
  std::vector<long double> exact(u.size(), 1.0L);
  for (int i : rows)
    for (std::size_t l = 0; l < steps; ++l)
      for (std::size_t n = 0; n < modes; ++n)
        exact[l * width + i] += static_cast<long double>(B[i * modes + n]) * x[l * modes + n];
  for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], static_cast<double>(exact[k]), tolerance) << k;

  const auto A = noise<T>(points, width, width, 7);
  const std::vector<T> strength{T(0.5), T(2), T(-1), T(3), T(0.25)};
  std::vector<T> mixed(width, T(9));
  loops.combine(width, A.data(), width, rows.data(), rows.size(), strength.data(), mixed.data());
  for (std::size_t k = 0; k < width; ++k) {
    long double sum = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      sum += static_cast<long double>(strength[i]) * A[rows[i] * width + k];
    EXPECT_NEAR(mixed[k], static_cast<double>(sum), tolerance);
  }

  const auto lag = noise<T>(points * lags, width, width, 4);
  std::fill(u.begin(), u.end(), 1.0);
  loops.near(width, lag.data(), lags, rows.data(), rows.size(), strength.data(), steps, u.data(), width);
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t l = 0; l < steps; ++l) {
      double sum = 1;
      for (std::size_t i = 0; i < rows.size(); ++i)
        sum -= static_cast<double>(strength[i]) * lag[(rows[i] * lags + l) * width + k];
      EXPECT_NEAR(u[l * width + k], sum, tolerance);
    }

  const auto c = noise<double>(14, modes, used, 5);
  const auto row = [&](std::size_t k) { return c.data() + k * modes; };
  const simd::Modes system{modes,  row(0), row(1),  row(2),  row(3),  row(4), row(5),
                           row(8), row(9), row(10), row(11), row(12), row(13)};
  const std::vector<double> q(row(6), row(7)), v(row(7), row(8));
  const auto more = noise<double>(2 * steps, modes, used, 8);
  const auto force = noise<T>(points, lags, steps, 3);
  for (const double* driven : {static_cast<const double*>(nullptr), more.data()}) {
    std::vector<T> free(steps * modes);
    loops.free_motion(system, steps, q.data(), v.data(), driven, free.data());
    for (std::size_t n = 0; n < used; ++n) {
      long double y = q[n], w = v[n];
      for (std::size_t l = 0; l < steps; ++l) {
        const long double g = system.load[n] - system.stiffness[n] * y;
        y += system.b[n] * w + system.c[n] * g;
        w = system.e[n] * w + system.h[n] * g;
        if (driven) y += driven[2 * l * modes + n];
        if (driven) w += driven[(2 * l + 1) * modes + n];
        EXPECT_NEAR(free[l * modes + n], static_cast<double>(y), 10 * tolerance);
      }
    }
  }

  std::vector<double> moved = q, rate = v, rates(steps * modes, 9.0);
  simd::Sums sums;
  loops.pushed_motion(system, {B.data(), rows.data(), rows.size(), force.data(), lags}, steps, moved.data(),
                      rate.data(), rates.data(), sums);
  long double kinetic = 0, strain = 0, loads = 0, damping = 0, contact = 0;
  for (std::size_t n = 0; n < modes; ++n) {
    long double y = q[n], w = v[n];
    for (std::size_t l = 0; l < steps; ++l) {
      long double push = 0;
      for (int i : rows) push += static_cast<long double>(force[i * lags + l]) * B[i * modes + n];
      const long double g = system.load[n] - push - system.stiffness[n] * y;
      const long double dq = system.b[n] * w + system.c[n] * g;
      damping += system.damp_ss[n] * g * g + system.damp_sr[n] * g * w + system.damp_rr[n] * w * w;
      contact += (system.held[n] + push) * dq;
      y += dq;
      w = system.e[n] * w + system.h[n] * g;
      EXPECT_NEAR(rates[l * modes + n], static_cast<double>(w), 10 * tolerance);
    }
    EXPECT_NEAR(moved[n], static_cast<double>(y), 10 * tolerance);
    EXPECT_NEAR(rate[n], static_cast<double>(w), 10 * tolerance);
    kinetic += w * w / 2;
    strain += system.stiffness[n] * y * y / 2;
    loads += system.force[n] * (y - system.origin[n]);
  }
  const double scale = 1000 * tolerance;
  EXPECT_NEAR(sums.kinetic, static_cast<double>(kinetic), scale);
  EXPECT_NEAR(sums.strain, static_cast<double>(strain), scale);
  EXPECT_NEAR(sums.loads, static_cast<double>(loads), scale);
  EXPECT_NEAR(sums.damping, static_cast<double>(damping), scale);
  EXPECT_NEAR(sums.contact, static_cast<double>(contact), scale);
}

TEST(Loops, of_every_instruction_set_here_give_the_sums_they_stand_for) {
  for (const simd::InstructionSet* set : simd::available()) {
    check_loops<double>(*set);
    check_loops<float>(*set);
  }
}

}  // namespace look_ahead_block_test
