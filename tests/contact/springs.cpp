// SPDX-License-Identifier: BSD-2-Clause
// Springs of contact points, which carry the bulges of patches: Hertz's contact at a single point, and
// steps and solves with any number of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "contact/complementarity/contact_solver.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/falling_body.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/sliding.hpp"
#include "tests/contact/sphere_on_patches.hpp"

namespace springs_test {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double pi = std::numbers::pi;

// 4 %: what the law is off for this patch at any force below 2b/R_ii, because R_ii and the bulge are means
// with the weight of the hat, whereas Hertz's pressure is an ellipse. The force then errs by 1.5 times that.
TEST(Spring, of_a_single_point_gives_the_approach_of_Hertz) {
  const SphereOnPatch sphere;
  const double R = SphereOnPatch::flexibility();
  const std::vector springs{PatchSpring::of(sphere.bulge(), R)};
  ContactSolver solver(1, {}, false, true);
  double previous = 0;
  for (const double share : {1e-6, 1e-4, 0.01, 0.1, 0.3, 0.99}) {
    const double approach = share * sphere.filled();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(1);
    ASSERT_EQ(solver.solve(Eigen::MatrixXd::Constant(1, 1, R), Eigen::VectorXd::Constant(1, approach),
                           springs, {}, force),
              SolveStatus::solved);
    EXPECT_GT(force(0), previous);
    EXPECT_LT(force(0), springs[0].limit);
    previous = force(0);
    const double hertz = std::pow(force(0) / sphere.force(1), 2.0 / 3);
    EXPECT_NEAR(approach / hertz, 1, 0.04) << share;
    EXPECT_GT(std::abs(approach / hertz - 1), 1e-3) << "the law is not Hertz's own";
  }
}

// Once the contact has grown beyond the patch, the displacement of its mean is that of a flat punch.
TEST(Spring, that_is_full_adds_the_bulge_to_the_gap) {
  const PatchSpring spring = PatchSpring::of(3, 0.5);
  EXPECT_EQ(spring.limit, 12);
  for (const double force : {12.0, 13.0, 1e9}) {
    EXPECT_EQ(spring.displacement(force), 3);
    EXPECT_EQ(spring.slope(force), 0);
    EXPECT_EQ(spring.energy(force), spring.energy(12));
  }
}

// 1e-6: quadrature and differences.
TEST(Spring, stores_what_it_takes_and_stiffens_without_a_jump) {
  const PatchSpring spring = PatchSpring::of(3, 0.5);
  double stored = 0, before = 0;
  const int steps = 400'000;
  const double top = 15;
  for (int k = 1; k <= steps; ++k) {
    const double force = top * k / steps, s = spring.displacement(force);
    ASSERT_GE(s, before);
    stored += (force - 0.5 * top / steps) * (s - before);  // ∫ λ ds
    before = s;
    if (k % 20'000 != 0) continue;
    EXPECT_NEAR(spring.energy(force), stored, 1e-6 * stored);
    const double d = 1e-5 * force;
    const double slope = (spring.displacement(force + d) - spring.displacement(force - d)) / (2 * d);
    EXPECT_NEAR(spring.slope(force), slope, 1e-6 * spring.slope(1));
  }
  EXPECT_EQ(spring.displacement(0), 0);
  EXPECT_EQ(spring.energy(0), 0);
}

struct Problem {
  Eigen::MatrixXd S;
  std::vector<PatchSpring> springs;
  std::vector<FrictionContact> contacts;
};

/// @param rubs  whether points have friction
Problem random_problem(int points, bool rubs, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const int n = rubs ? 3 * points : points;
  const auto matrix = [&](int columns) {
    return Eigen::MatrixXd::NullaryExpr(n, columns, [&] { return normal(random); });
  };
  const Eigen::MatrixXd A = matrix(n), B = matrix(6);
  const Eigen::MatrixXd R = 0.3 * uniform(random) * A * A.transpose() / n + Eigen::MatrixXd::Identity(n, n);
  Problem out{R + std::pow(10, 2 * uniform(random) - 1) * B * B.transpose(), {}, {}};
  out.springs.resize(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) {
    if (uniform(random) < 0.9)
      out.springs[i] = PatchSpring::of(std::pow(10, 3 * uniform(random) - 2), R(i, i));
    if (rubs) out.contacts.push_back({i, points + 2 * i, 0.3});
  }
  return out;
}

// Residuals are relative to |r|_∞ + ‖S‖_∞ |p|_∞. 1e-11: s(λ) is met to 1e-12, friction to 1e-12 of that
// scale.
TEST(SpringProblem, is_solved_to_round_off_from_any_guess) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const bool rubs : {false, true})
    for (const int points : {1, 2, 5, 12, 40}) {
      if (rubs && points > 12) continue;
      int pressed = 0, partial = 0;
      std::int64_t problems = 0, linear = 0;
      for (int trial = 0; trial < 30; ++trial) {
        const Problem problem = random_problem(points, rubs, random);
        const auto& S = problem.S;
        ContactSolver solver(static_cast<int>(S.rows()), {.same_matrix = true}, rubs, true);
        Eigen::VectorXd p = Eigen::VectorXd::Zero(S.rows());
        for (int k = 0; k < 6; ++k, ++problems) {
          const double size = std::pow(10, normal(random));
          const Eigen::VectorXd r =
              Eigen::VectorXd::NullaryExpr(S.rows(), [&] { return size * normal(random); });
          ASSERT_EQ(solver.solve(S, r, problem.springs, problem.contacts, p), SolveStatus::solved);
          const double scale =
              r.cwiseAbs().maxCoeff() + S.cwiseAbs().rowwise().sum().maxCoeff() * p.cwiseAbs().maxCoeff();
          const Eigen::VectorXd w = S * p - r;
          for (int i = 0; i < points; ++i) {
            ASSERT_GE(p(i), 0);
            const PatchSpring& spring = problem.springs[i];
            if (p(i) == 0) {
              EXPECT_GE(w(i), -1e-12 * scale);
              continue;
            }
            ++pressed;
            partial += p(i) < spring.limit ? 1 : 0;
            EXPECT_NEAR(w(i) + (spring.bulge > 0 ? spring.displacement(p(i)) : 0), 0, 1e-11 * scale);
            if (!rubs) continue;
            const Eigen::Vector2d t = p.segment<2>(points + 2 * i), slip = w.segment<2>(points + 2 * i);
            EXPECT_LE(t.norm(), 0.3 * p(i) * (1 + 1e-12));
            if (slip.norm() > 1e-9 * scale) {
              EXPECT_NEAR((t / (0.3 * p(i)) + slip.normalized()).norm(), 0,
                          1e-3 * scale / slip.norm() * 1e-6);
            }
          }
        }
        linear += solver.statistics().problems;
        EXPECT_EQ(solver.statistics().limited, 0);
      }
      EXPECT_GT(pressed, problems / 4) << points;
      EXPECT_GT(partial, points / 2) << points;
      EXPECT_LT(linear, 14 * problems) << points;
    }
}

// The factor of S stays: a full spring only moves the right side.
TEST(SpringProblem, with_full_springs_is_that_of_larger_gaps_to_the_last_bit) {
  std::mt19937_64 random(2);
  Problem problem = random_problem(20, false, random);
  for (PatchSpring& spring : problem.springs) spring = PatchSpring::of(1e-3, 1e3);
  const Eigen::VectorXd bulge = Eigen::VectorXd::Constant(20, 1e-3);
  ContactSolver with(20, {.same_matrix = true}, false, true), without(20, {.same_matrix = true});
  Eigen::VectorXd p = Eigen::VectorXd::Constant(20, 1), expected = p;
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd r = problem.S * Eigen::VectorXd::Constant(20, 1 + 0.1 * k);
    ASSERT_EQ(with.solve(problem.S, r, problem.springs, {}, p), SolveStatus::solved);
    ASSERT_EQ(without.solve(problem.S, r - bulge, expected), SolveStatus::solved);
    EXPECT_EQ(p, expected);
  }
  EXPECT_EQ(with.statistics().renewals, without.statistics().renewals);
  EXPECT_EQ(with.statistics().problems, without.statistics().problems);
}

// pᵀ(r − S p) − λᵀs(λ) is what contact takes in a step that begins with closed gaps.
TEST(SpringProblem, gives_no_energy_if_it_is_stopped) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  int limited = 0, pressed = 0;
  for (const bool rubs : {false, true})
    for (int trial = 0; trial < 60; ++trial) {
      const Problem problem = random_problem(rubs ? 6 : 15, rubs, random);
      const auto& S = problem.S;
      ContactSolver solver(static_cast<int>(S.rows()), {.same_matrix = true, .max_pivots = 1 + trial % 3},
                           rubs, true);
      Eigen::VectorXd p = Eigen::VectorXd::Zero(S.rows());
      for (int k = 0; k < 10; ++k) {
        const Eigen::VectorXd r = Eigen::VectorXd::NullaryExpr(S.rows(), [&] { return normal(random); });
        const SolveStatus status = solver.solve(S, r, problem.springs, problem.contacts, p);
        limited += status == SolveStatus::limited ? 1 : 0;
        ASSERT_TRUE(status == SolveStatus::limited || status == SolveStatus::solved);
        double taken = p.dot(r - S * p);
        for (std::size_t i = 0; i < problem.springs.size(); ++i) {
          const double force = p(static_cast<Eigen::Index>(i));
          ASSERT_GE(force, 0);
          pressed += force > 0 ? 1 : 0;
          if (force > 0 && problem.springs[i].bulge > 0)
            taken -= force * problem.springs[i].displacement(force);
        }
        EXPECT_GE(taken, -1e-11 * (std::abs(p.dot(r)) + p.dot(S * p)));
      }
    }
  EXPECT_GT(limited, 300);
  EXPECT_GT(pressed, 300);
}

TEST(SpringProblem, refuses_what_is_not_a_number_and_goes_on) {
  std::mt19937_64 random(3);
  const Problem problem = random_problem(5, false, random);
  ContactSolver solver(5, {.same_matrix = true}, false, true);
  Eigen::VectorXd r = Eigen::VectorXd::Ones(5), p = Eigen::VectorXd::Zero(5), again = p;
  ASSERT_EQ(solver.solve(problem.S, r, problem.springs, {}, p), SolveStatus::solved);
  r(2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solver.solve(problem.S, r, problem.springs, {}, again), SolveStatus::not_finite);
  r(2) = 1;
  ASSERT_EQ(solver.solve(problem.S, r, problem.springs, {}, again), SolveStatus::solved);
  EXPECT_LT((again - p).norm(), 1e-11 * p.norm());
}

/// A rigid sphere of unit mass that falls on the half-space.
Model falling_sphere(double speed) {
  const SphereOnPatch sphere;
  Model model = blank(1, 1);
  model.B(0, 0) = 1;
  model.v0(0) = speed;
  model.R(0, 0) = SphereOnPatch::flexibility();
  model.bulge = Vector::Constant(1, sphere.bulge());
  model.has_residual = true;
  return model;
}

// The peak force of a single patch errs like the force of its law to the power 2/5, by 2.1 %. With fewer than
// two candidates across the contact radius, the error of the peak depends on where the contact is; it is at
// most 6 % about a candidate. Between candidates, a contact below a patch starts late, because it is closer
// than any point at which gaps are known.
TEST(Springs, carry_a_blow_of_Hertz_on_any_number_of_patches) {
  struct Case {
    double across;
    bool aside;
    double least, most;  // of the peak force, relative to Hertz's
    int touched;
  };
  for (const Case& c : {Case{0.25, false, 1.01, 1.03, 1},
                        {0.5, false, 1.01, 1.03, 1},
                        {1, false, 0.93, 1.03, 5},
                        {1.5, false, 0.98, 1.03, 9},
                        {2, false, 0.98, 1.02, 13},
                        {4, false, 0.99, 1.01, 45},
                        {1, true, 1, 1.14, 4},
                        {1.5, true, 0.95, 1, 4},
                        {2, true, 0.99, 1.03, 12}}) {
    SCOPED_TRACE(c.across);
    const SphereOnPatches blow(c.across, c.aside);
    const auto stepper = make_stepper(blow.model, {.step = blow.duration / 50});
    double largest = 0;
    int touched = 0;
    for (int k = 0; k < 70; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      largest = std::max(largest, stepper->end_force().sum());
      touched = std::max(touched, stepper->active());
    }
    EXPECT_GT(largest / blow.peak, c.least);
    EXPECT_LT(largest / blow.peak, c.most);
    EXPECT_EQ(stepper->active(), 0);
    EXPECT_GE(touched, c.touched);
    EXPECT_NEAR(stepper->modal()->v(0), -blow.speed, 3e-4 * blow.speed);
  }
}

/// A body with random modes and bulges.
Model bulging(const RandomBody& of, double largest, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform;
  Model model = random_body(of, random);
  if (of.friction < 0) {  // normal rows alone
    const Eigen::Index m = model.points();
    model.friction.clear();
    model.B = Matrix(model.B.topRows(m));
    model.R = Matrix(model.R.topLeftCorner(m, m));
    model.static_displacement = Vector(model.static_displacement.head(m));
  }
  model.bulge =
      Vector::NullaryExpr(model.points(), [&] { return largest * std::max(0.0, uniform(random) - 0.1); });
  return model;
}

TEST(Springs, never_add_energy_at_any_step) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  const auto decades = [&](double from, double to) {
    return std::pow(10.0, from + (to - from) * uniform(random));
  };
  double gain = 0, drift = 0, stored = 0;
  std::int64_t touching = 0, partial = 0, limited = 0, stopped = 0;
  for (int run = 0; run < 300; ++run) {
    const double step = decades(-8, 0);
    const bool rubs = run % 3 == 0;
    const Model model = bulging({.points = static_cast<int>(decades(0, rubs ? 0.9 : 1.5)),
                                 .modes = static_cast<int>(decades(0, 2)),
                                 .friction = rubs ? uniform(random) : -1,
                                 .flexibility = step * step * decades(-4, 4),
                                 .frequency = decades(-3, 1) / step,
                                 .damping = uniform(random) < 0.3 ? decades(-3, 1) : 0},
                                step * decades(-3, 1), random);
    Model near = model;
    for (double& gap : near.gap) gap *= 1000 * step;
    const ContactStep kind = run % 2 == 0 ? ContactStep::conserving : ContactStep::backward_euler;
    StepOptions options{.contact = {.integration = kind}, .step = step, .block = run % 5 == 0 ? 1 : 0};
    const bool stops = run % 4 == 3;
    if (stops) options.contact.max_pivots = 1 + run % 3;
    const auto stepper = make_stepper(near, options);
    const double start = 0.5 * near.v0.squaredNorm();
    const auto springs = near.springs();
    for (int k = 0; k < 60; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Energy& e = stepper->modal()->energy();
      gain = std::max(gain, (e.total() - start) / start);
      drift = std::max(drift, std::abs(e.ledger() - start) / start);
      stored = std::max(stored, energy_of(springs, stepper->end_force()) / start);
      touching += stepper->active();
      for (std::size_t i = 0; i < springs.size(); ++i) {
        const double f = stepper->end_force()(static_cast<Eigen::Index>(i));
        partial += f > 0 && f < springs[i].limit ? 1 : 0;
      }
    }
    (stops ? stopped : limited) += stepper->solver().limited;
  }
  std::printf(
      "gain %.1e, drift %.1e, stored in springs up to %.2f, %lld of %lld pressed points partial, %lld "
      "limited\n",
      gain, drift, stored, static_cast<long long>(partial), static_cast<long long>(touching),
      static_cast<long long>(limited));
  EXPECT_LE(gain, 1e-12);
  EXPECT_LE(drift, 1e-9);
  EXPECT_GT(stored, 0.05);
  EXPECT_GT(partial, touching / 10);
  EXPECT_EQ(limited, 0);
  EXPECT_GT(stopped, 100) << "by max_pivots";
}

/// The largest difference of forces between two ways to make the same steps, relative to the largest force.
double difference(const Model& model, const Model& other, StepOptions options, StepOptions others,
                  int steps) {
  const auto one = make_stepper(model, options), two = make_stepper(other, others);
  double worst = 0, largest = 0;
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(one->step(), StepStatus::ok);
    EXPECT_EQ(two->step(), StepStatus::ok);
    largest = std::max(largest, one->force().cwiseAbs().maxCoeff());
    worst = std::max({worst, (one->force() - two->force()).cwiseAbs().maxCoeff(),
                      (one->end_force() - two->end_force()).cwiseAbs().maxCoeff()});
  }
  EXPECT_GT(largest, 0);
  return worst / largest;
}

// 1e-8: each impact amplifies round-off.
TEST(Springs, give_the_same_forces_in_blocks_and_in_single_steps) {
  std::mt19937_64 random(5);
  for (const bool rubs : {false, true})
    for (const int block : {2, 5, 16, 24}) {
      Model model =
          bulging({.points = 9, .modes = 25, .friction = rubs ? 0.3 : -1, .flexibility = 1e-5}, 3e-3, random);
      const StepOptions single{.step = 2e-3, .block = 1};
      StepOptions blocks = single;
      blocks.block = block;
      EXPECT_LT(difference(model, model, single, blocks, 150), 1e-8) << rubs << ' ' << block;
    }
}

TEST(Springs, in_single_precision_give_the_impulse_of_double_precision) {
  std::mt19937_64 random(6);
  const Model model = bulging({.points = 9, .modes = 25, .friction = -1, .flexibility = 1e-5}, 3e-3, random);
  double impulse[2] = {0, 0};
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    const auto stepper = make_stepper(model, {.step = 2e-3, .precision = precision});
    for (int k = 0; k < 60; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      impulse[precision == Precision::float32] += stepper->force().sum();
    }
  }
  EXPECT_GT(impulse[0], 0);
  EXPECT_NEAR(impulse[1] / impulse[0], 1, 1e-4);
}

// From the first contact on, all forces are far beyond 2b/R_ii, until the contact ends.
TEST(Springs, that_are_full_make_the_steps_of_mean_gaps) {
  Model model = dropped(20, 6, 1e-6);
  model.R.diagonal().setConstant(1e-6);
  model.v0(0) = 1;
  model.load.setZero();
  model.bulge = Vector::LinSpaced(6, 1e-9, 2e-9);
  Model mean = model;
  use_mean_gaps(mean);
  EXPECT_EQ(mean.gap(5), 1e-6 + 2e-9);
  EXPECT_EQ(mean.bulge(5), 0);
  const StepOptions options{.step = 1e-5, .block = 1};
  const auto one = make_stepper(model, options), two = make_stepper(mean, options);
  int full = 0;
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(one->step(), StepStatus::ok);
    ASSERT_EQ(two->step(), StepStatus::ok);
    if (!(two->end_force().minCoeff() > 0.1)) continue;
    ++full;
    EXPECT_LT((one->end_force() - two->end_force()).norm(), 1e-11 * two->end_force().norm());
  }
  EXPECT_GT(full, 5);
}

// Forces of impulses do not yield, and the bodies bounce where the means of their patches meet.
TEST(Springs, do_not_act_under_impulses_which_meet_at_the_mean_gap) {
  Model model = blank(1, 1);
  model.B(0, 0) = 1;
  model.v0(0) = 1;
  model.gap(0) = 0.4;
  model.R(0, 0) = 1;
  model.bulge = Vector::Constant(1, 0.2);
  const auto stepper =
      make_stepper(model, {.contact = {.scheme = Scheme::impulse, .restitution = 1}, .step = 1e-3});
  while (stepper->active() == 0 && stepper->time() < 1) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->time(), 0.6, 2e-3);
}

// The energy that the springs of a mass hold is the work of its weight: u − g is where the mass is.
TEST(Springs, belong_to_displacement_and_residual_energy) {
  const Model model = falling_sphere(1e-3);
  const auto springs = model.springs();
  for (const int block : {1, 0}) {
    const auto stepper = make_stepper(model, {.step = 1, .block = block});
    bool partial = false;
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const double force = stepper->end_force()(0), q = stepper->modal()->q(0);
      if (force == 0) continue;
      partial = partial || force < springs[0].limit;
      EXPECT_NEAR(stepper->displacement()(0), 0, 1e-12 * q) << "the gap stays closed";
      EXPECT_NEAR(stepper->modal()->energy().residual,
                  0.5 * model.R(0, 0) * force * force + springs[0].energy(force), 1e-12 * force * q);
    }
    EXPECT_TRUE(partial);
  }
}

TEST(Springs, take_no_memory) {
  std::mt19937_64 random(7);
  for (const bool rubs : {false, true})
    for (const int block : {0, 1}) {
      const Model model =
          bulging({.points = 7, .modes = 20, .friction = rubs ? 0.3 : -1, .flexibility = 1e-5}, 3e-3, random);
      const auto stepper = make_stepper(model, {.step = 2e-3, .block = block});
      const auto before = heap_counter::calls.load();
      int touching = 0;
      for (int k = 0; k < 200; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        touching += stepper->active();
      }
      EXPECT_EQ(heap_counter::calls.load(), before);
      EXPECT_GT(touching, 0);
    }
}

TEST(Springs, of_points_that_do_not_yield_are_none) {
  Model model = blank(1, 2);
  model.R(0, 0) = 1e-3;
  model.bulge = Vector::Constant(2, 1e-6);
  const auto springs = model.springs();
  ASSERT_EQ(springs.size(), 2U);
  EXPECT_GT(springs[0].bulge, 0);
  EXPECT_EQ(springs[1].bulge, 0);
  model.bulge(0) = 0;
  EXPECT_TRUE(model.springs().empty());
  model.bulge.resize(0);
  EXPECT_TRUE(model.springs().empty());
}

}  // namespace springs_test
