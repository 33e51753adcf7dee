// SPDX-License-Identifier: BSD-2-Clause
// The solver of Coulomb friction compared with enumeration of all states, with projected Gauss-Seidel and
// with closed forms, and checked against the conditions in extended precision.
#include "contact/complementarity/friction_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/contact/heap_counter.hpp"
#include "tests/contact/lcp.hpp"

namespace friction_solver_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using lcp::Random;
using namespace ricochet::contact;

constexpr double infinity = std::numeric_limits<double>::infinity();

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

struct Problem {
  MatrixXd S;
  VectorXd r;
  std::vector<FrictionContact> contacts;
};

/// `points` with friction and others without, in the order normal rows, tangential rows. Eigenvalues of S are
/// those of a random matrix with twice as many columns as rows, plus `yield`.
Problem random_problem(Random& random, int points, int others, double coefficient, double yield = 0) {
  const int n = 3 * points + others;
  const MatrixXd B = lcp::normal_matrix(random, n, 2 * n);
  Problem out{B * B.transpose() / (2 * n), lcp::normal_vector(random, n), {}};
  out.S.diagonal().array() += yield;
  for (int k = 0; k < points; ++k) out.contacts.push_back({k, points + others + 2 * k, coefficient});
  return out;
}

/// Largest violation of Coulomb's conditions by p, relative to |r|_∞ + ‖S‖_∞ |p|_∞; infinite if p is outside
/// the cone by more than round-off, or if friction drives the slip. A force that would have to turn counts as
/// the motion across it, and slip below the tolerance 1e-12 as stick.
double violation(const Problem& problem, const VectorXd& p) {
  const lcp::LongVector w = lcp::slack(problem.S, problem.r, p);
  const double scale = lcp::scale(problem.S, problem.r, p);
  std::vector<char> is_normal(static_cast<std::size_t>(p.size()), 1);
  double worst = 0;
  for (const FrictionContact& c : problem.contacts) {
    is_normal[c.normal] = is_normal[c.tangential] = is_normal[c.tangential + 1] = 0;
    const Vector2d force = p.segment<2>(c.tangential), motion = w.segment<2>(c.tangential).cast<double>();
    const double most = c.coefficient * p(c.normal);
    if (!(p(c.normal) >= 0) || !(force.norm() <= most * (1 + 1e-15))) return infinity;
    const auto gap = static_cast<double>(w(c.normal));
    worst = std::max(worst, p(c.normal) > 0 ? std::abs(gap) : -gap);
    if (!(most > 0) || motion.norm() <= 1e-12 * scale) continue;
    if (force.dot(motion) > 0) return infinity;
    worst = std::max(worst, (force / most * motion.norm() + motion).norm());
  }
  for (Index i = 0; i < p.size(); ++i) {
    if (!is_normal[i]) continue;
    if (!(p(i) >= 0)) return infinity;
    worst = std::max(worst, static_cast<double>(p(i) > 0 ? std::abs(w(i)) : -w(i)));
  }
  return worst > 0 ? worst / scale : 0;
}

// ---- Enumeration of planar problems ----

/// Points with one tangent each: S (2m,2m), rows n_1 … n_m, t_1 … t_m.
struct Planar {
  MatrixXd S;
  VectorXd r;
  double coefficient;
};

/// The same as a problem of two tangents. The second ones are not coupled and nothing drives them: p_t2 ≠ 0
/// would move the point along p_t2, against Coulomb's law. So there are no other solutions.
Problem in_space(const Planar& planar) {
  const Index m = planar.r.size() / 2;
  Problem out{MatrixXd::Identity(3 * m, 3 * m), VectorXd::Zero(3 * m), {}};
  const auto row = [m](Index i) { return i < m ? i : m + 2 * (i - m); };
  for (Index i = 0; i < 2 * m; ++i) {
    out.r(row(i)) = planar.r(i);
    for (Index j = 0; j < 2 * m; ++j) out.S(row(i), row(j)) = planar.S(i, j);
  }
  for (int k = 0; k < m; ++k) out.contacts.push_back({k, static_cast<int>(m) + 2 * k, planar.coefficient});
  return out;
}

/// All solutions p (2m), by trying open, stick, slip forward and slip backward at each point. `decided` is
/// false if an inequality or a determinant is too close to 0.
std::vector<VectorXd> by_enumeration(const Planar& planar, bool& decided) {
  const Index m = planar.r.size() / 2;
  std::vector<VectorXd> found;
  decided = true;
  constexpr double margin = 1e-7;  // far above the round-off of the dense solves, of condition numbers to 1e6
  for (int code = 0; code < std::pow(4, m); ++code) {
    MatrixXd M = planar.S;
    VectorXd b = planar.r;
    std::vector<int> state(static_cast<std::size_t>(m));
    for (Index k = 0, rest = code; k < m; ++k, rest /= 4) {
      state[k] = static_cast<int>(rest % 4);
      const auto force = [&](Index row, double of_normal) {  // p_row + of_normal p_n = 0
        M.row(row).setZero();
        M(row, row) = 1;
        if (row != k) M(row, k) = of_normal;
        b(row) = 0;
      };
      if (state[k] == 0) force(k, 0);
      if (state[k] == 0) force(m + k, 0);
      if (state[k] == 2) force(m + k, planar.coefficient);
      if (state[k] == 3) force(m + k, -planar.coefficient);
    }
    const Eigen::FullPivLU<MatrixXd> lu(M);
    if (!lu.isInvertible()) {
      decided = false;
      continue;
    }
    const VectorXd p = lu.solve(b), w = planar.S * p - planar.r;
    double least = infinity;
    for (Index k = 0; k < m; ++k) {
      const double n = p(k), t = p(m + k);
      if (state[k] == 0) least = std::min(least, w(k));
      if (state[k] != 0) least = std::min(least, n);
      if (state[k] == 1) least = std::min(least, planar.coefficient * n - std::abs(t));
      if (state[k] == 2) least = std::min(least, w(m + k));
      if (state[k] == 3) least = std::min(least, -w(m + k));
    }
    if (std::abs(least) < margin) decided = false;
    if (least >= 0) found.push_back(p);
  }
  return found;
}

Planar random_planar(Random& random, int points, double coefficient) {
  const int n = 2 * points;
  const MatrixXd B = lcp::normal_matrix(random, n, n);
  MatrixXd S = B * B.transpose();
  S.diagonal().array() += 0.02;
  return {S, 3 * lcp::normal_vector(random, n), coefficient};
}

TEST(FrictionSolver, finds_one_of_the_solutions_that_enumeration_finds) {
  Random random(1);
  FrictionSolver solver(12);
  int unique = 0, ambiguous = 0, noticed = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int m = 1 + trial % 4;
    const Planar planar = random_planar(random, m, uniform(random, 0, trial % 3 == 0 ? 5 : 1));
    bool decided = true;
    const std::vector<VectorXd> all = by_enumeration(planar, decided);
    if (!decided) continue;
    const Problem problem = in_space(planar);
    VectorXd p = VectorXd::Zero(3 * m);
    solver.reset();
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved) << trial;
    double nearest = infinity;
    for (const VectorXd& other : all) {
      double distance = 0;
      for (int k = 0; k < m; ++k)
        distance = std::max({distance, std::abs(p(k) - other(k)), std::abs(p(m + 2 * k) - other(m + k)),
                             std::abs(p(m + 2 * k + 1))});
      nearest = std::min(nearest, distance);
    }
    // condition numbers of the solves up to 1e4
    EXPECT_LE(nearest, 1e-8 * (1 + p.cwiseAbs().maxCoeff())) << trial << " of " << all.size();
    EXPECT_EQ(all.size() % 2, 1u) << "the signs of the determinants add up to 1";
    if (m == 1) {
      EXPECT_EQ(solver.several(), all.size() > 1) << trial;
    }
    if (all.size() == 1) {
      EXPECT_FALSE(solver.several()) << trial;
    }
    ++(all.size() == 1 ? unique : ambiguous);
    noticed += solver.several();
  }
  EXPECT_GT(unique, 1000);
  EXPECT_GT(ambiguous, 40);
  EXPECT_GT(noticed, 8);  // several points are decided only if another solution is near
}

// ---- Space ----

TEST(FrictionSolver, satisfies_Coulombs_law_for_many_sizes_scales_and_coefficients) {
  Random random(2);
  FrictionSolver solver(200);
  int limited = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int points = 1 + trial % (trial % 50 == 0 ? 40 : 12), others = trial % 4;
    Problem problem = random_problem(random, points, others, std::pow(uniform(random, 0, 1), 2) * 10,
                                     trial % 3 == 0 ? 0.2 : 0);
    problem.S *= std::pow(10, uniform(random, -12, 12));
    problem.r *= std::pow(10, uniform(random, -6, 6));
    VectorXd p = VectorXd::Zero(problem.r.size());
    solver.reset();
    const SolveStatus status = solver.solve(problem.S, problem.r, problem.contacts, p);
    limited += status == SolveStatus::limited;
    if (status != SolveStatus::limited) {
      ASSERT_EQ(status, SolveStatus::solved) << trial;
    }
    if (status == SolveStatus::solved) {
      EXPECT_LE(violation(problem, p), 1e-12) << trial;
    }
  }
  EXPECT_EQ(limited, 0);
}

// Stiffness of a body of few modes, with a small yield of each point: condition numbers to 1e6.
TEST(FrictionSolver, satisfies_Coulombs_law_if_there_are_more_rows_than_modes) {
  Random random(3);
  FrictionSolver solver(60);
  for (int trial = 0; trial < 1000; ++trial) {
    const int points = 1 + trial % 15, n = 3 * points, modes = 1 + trial % n;
    Problem problem = random_problem(random, points, 0, uniform(random, 0, 1));
    const MatrixXd B = lcp::normal_matrix(random, n, modes);
    problem.S = B * B.transpose();
    problem.S.diagonal().array() += std::pow(10, uniform(random, -6, 0));
    VectorXd p = VectorXd::Zero(n);
    solver.reset();
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved) << trial;
    EXPECT_LE(violation(problem, p), 1e-12) << trial;
  }
}

// A ball is pressed into a half-space, sheared, and lifted again: Boussinesq's and Cerruti's point forces,
// with uniform patches where they act. Unlike between two equal bodies, normal forces also move the surface
// sideways.
TEST(FrictionSolver, satisfies_Coulombs_law_where_normal_and_tangential_motion_are_coupled) {
  constexpr int side = 11, points = side * side, steps = 40;
  constexpr double poisson = 0.3, own = 3.525;  // ∫ 1/r over a unit square about its centre: 4 ln(1 + √2)
  Problem problem{MatrixXd::Zero(3 * points, 3 * points), VectorXd::Zero(3 * points), {}};
  const auto place = [](int k) { return Vector2d(k % side - side / 2, k / side - side / 2); };
  for (int i = 0; i < points; ++i) {
    problem.contacts.push_back({i, points + 2 * i, 0.3});
    for (int j = 0; j < points; ++j) {
      const Vector2d x = place(i) - place(j);
      const double r = x.norm();
      problem.S(i, j) = (1 - poisson) * (i == j ? own : 1 / r);
      problem.S.block<2, 2>(points + 2 * i, points + 2 * j) =
          i == j ? Eigen::Matrix2d((1 - poisson / 2) * own * Eigen::Matrix2d::Identity())
                 : Eigen::Matrix2d((1 - poisson) / r * Eigen::Matrix2d::Identity() +
                                   poisson / (r * r * r) * x * x.transpose());
      if (i == j) continue;
      const Vector2d coupling = (1 - 2 * poisson) / (2 * r * r) * x;
      problem.S.block<1, 2>(i, points + 2 * j) = coupling.transpose();
      problem.S.block<2, 1>(points + 2 * j, i) = coupling;
    }
  }
  FrictionSolver solver(3 * points, {.same_matrix = true});
  VectorXd p = VectorXd::Zero(3 * points), before = p;
  int slipping = 0, sticking = 0;
  for (int step = 1; step <= steps; ++step) {
    const double depth = 15 * std::sin(step * M_PI / (steps + 1));
    problem.r = problem.S * before;  // so that tangential rows of w are those of the increment
    for (int i = 0; i < points; ++i) {
      problem.r(i) = depth - 0.5 * place(i).squaredNorm();
      problem.r(points + 2 * i) += 0.08;
    }
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved) << step;
    EXPECT_LE(violation(problem, p), 1e-12) << step;
    before = p;
    for (const ContactState state : solver.states()) {
      slipping += state == ContactState::slip;
      sticking += state == ContactState::stick;
    }
  }
  EXPECT_GT(std::min(slipping, sticking), 10 * steps);
  // Points change their state one after the other, about one in each step; 91 factors were needed.
  EXPECT_EQ(solver.statistics().fallbacks, 0);
  EXPECT_LE(solver.statistics().renewals, 4 * steps);
}

/// p after projected Gauss-Seidel: each row against the forces of the others, tangential forces shortened to
/// the cone. With the step 1/λ_max of the tangential block it converges for small μ.
VectorXd by_projection(const Problem& problem) {
  VectorXd p = VectorXd::Zero(problem.r.size());
  std::vector<char> is_normal(static_cast<std::size_t>(p.size()), 1);
  for (const FrictionContact& c : problem.contacts) is_normal[c.tangential] = is_normal[c.tangential + 1] = 0;
  for (int sweep = 0; sweep < 20000; ++sweep) {
    const VectorXd before = p;
    for (Index i = 0; i < p.size(); ++i)
      if (is_normal[i])
        p(i) = std::max(0.0, p(i) - (problem.S.row(i).dot(p) - problem.r(i)) / problem.S(i, i));
    for (const FrictionContact& c : problem.contacts) {
      const double step =
          1 / (problem.S(c.tangential, c.tangential) + problem.S(c.tangential + 1, c.tangential + 1));
      Vector2d t = p.segment<2>(c.tangential);
      t -= step * (problem.S.middleRows<2>(c.tangential) * p - problem.r.segment<2>(c.tangential));
      const double most = c.coefficient * p(c.normal);
      if (t.norm() > most) t *= most / t.norm();
      p.segment<2>(c.tangential) = t;
    }
    if ((p - before).cwiseAbs().maxCoeff() <= 1e-15 * p.cwiseAbs().maxCoeff()) break;
  }
  return p;
}

// With μ < 0.5 and these matrices, whose diagonal exceeds the influence of other points, the solution is
// unique.
TEST(FrictionSolver, agrees_with_projected_Gauss_Seidel) {
  Random random(5);
  FrictionSolver solver(40);
  int slipping = 0, sticking = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Problem problem = random_problem(random, 1 + trial % 8, trial % 3, uniform(random, 0, 0.5), 0.5);
    VectorXd p = VectorXd::Zero(problem.r.size());
    solver.reset();
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    const VectorXd other = by_projection(problem);
    // the reference stops at changes of 1e-15 and gains at least a tenth of a digit in a sweep
    EXPECT_LE((p - other).cwiseAbs().maxCoeff(), 1e-11 * (1 + other.cwiseAbs().maxCoeff())) << trial;
    EXPECT_FALSE(solver.several());
    for (const ContactState state : solver.states()) {
      slipping += state == ContactState::slip;
      sticking += state == ContactState::stick;
    }
  }
  EXPECT_GT(slipping, 100);
  EXPECT_GT(sticking, 10);
}

TEST(FrictionSolver, without_friction_is_a_complementarity_problem) {
  Random random(7);
  FrictionSolver solver(40);
  ComplementaritySolver frictionless(40);
  for (int trial = 0; trial < 300; ++trial) {
    const int points = 1 + trial % 8, others = trial % 5, normals = points + others;
    Problem problem = random_problem(random, points, others, 0, 0.1);
    VectorXd lambda(normals), p = VectorXd::Constant(problem.r.size(), 0.1);
    ASSERT_EQ(frictionless.solve(problem.S.topLeftCorner(normals, normals), problem.r.head(normals), lambda),
              SolveStatus::solved);
    solver.reset();
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    EXPECT_LE((p.head(normals) - lambda).cwiseAbs().maxCoeff(), 1e-10) << "tolerance times condition number";
    EXPECT_EQ(p.tail(2 * points), VectorXd::Zero(2 * points));
    EXPECT_FALSE(solver.several());
    for (int k = 0; k < points; ++k)
      EXPECT_EQ(solver.states()[k], lambda(k) > 0 ? ContactState::slip : ContactState::open);

    // without contacts, all rows are normal
    VectorXd all(problem.r.size()), same(problem.r.size());
    ASSERT_EQ(frictionless.solve(problem.S, problem.r, all), SolveStatus::solved);
    ASSERT_EQ(solver.solve(problem.S, problem.r, {}, same), SolveStatus::solved);
    EXPECT_LE((all - same).cwiseAbs().maxCoeff(), 1e-13 * all.maxCoeff()) << "they started from other sets";
  }
}

/// Points that are pressed together with a known sliding direction t each: w_t = slip · t, p_t = −μ p_n t.
struct Sliding {
  MatrixXd S;
  VectorXd along, force;  ///< unit slips in tangential rows; p for any slip that is large enough
  VectorXd push;          ///< S force
  std::vector<FrictionContact> contacts;
};

Sliding sliding_points(Random& random, int points, double coefficient) {
  Problem problem = random_problem(random, points, 0, coefficient, 0.1);
  Sliding out{problem.S, VectorXd::Zero(3 * points), VectorXd::Zero(3 * points), {}, problem.contacts};
  for (int k = 0; k < points; ++k) {
    const double angle = uniform(random, 0, 6);
    const Vector2d t(std::cos(angle), std::sin(angle));
    out.along.segment<2>(points + 2 * k) = t;
    out.force(k) = uniform(random, 0.1, 1);
    out.force.segment<2>(points + 2 * k) = -coefficient * out.force(k) * t;
  }
  out.push = out.S * out.force;
  return out;
}

// The forces are those for which the problem was made, whatever the slip and however small the coefficient.
TEST(FrictionSolver, finds_the_forces_of_sliding_points_at_any_speed_and_for_any_small_mu) {
  Random random(21);
  FrictionSolver solver(60);
  for (const double mu : {1e-30, 1e-12, 1e-6, 0.2})
    for (const double slip : {1e-3, 1.0, 1e9, 1e18, 1e30}) {
      const int points = 12;
      const Sliding made = sliding_points(random, points, mu);
      VectorXd p = VectorXd::Zero(3 * points);
      solver.reset();
      ASSERT_EQ(solver.solve(made.S, made.push - slip * made.along, made.contacts, p), SolveStatus::solved)
          << mu << " " << slip;
      // 1e-10: tolerance times condition number
      EXPECT_LE((p - made.force).head(points).cwiseAbs().maxCoeff(), 1e-10) << mu << " " << slip;
      if (slip >= 1) {
        EXPECT_LE((p - made.force).tail(2 * points).cwiseAbs().maxCoeff(), 1e-10 * mu) << mu << " " << slip;
      }
    }
}

TEST(FrictionSolver, has_nothing_to_do_where_points_touch_at_rest) {
  Random random(22);
  const Problem problem = random_problem(random, 5, 0, 0.3, 0.1);
  FrictionSolver solver(15);
  VectorXd p = VectorXd::Zero(15);
  ASSERT_EQ(solver.solve(problem.S, VectorXd::Zero(15), problem.contacts, p), SolveStatus::solved);
  EXPECT_EQ(p, VectorXd::Zero(15));
  EXPECT_EQ(solver.statistics().renewals, 0);
  EXPECT_EQ(solver.statistics().limited, 0);
}

// A block on an inclined plane, r = weight along its rows: it sticks up to tan = μ and slips downhill beyond
// it.
TEST(FrictionSolver, holds_a_block_up_to_the_angle_of_friction) {
  FrictionSolver solver(3);
  constexpr double mu = 0.3;
  const std::vector<FrictionContact> contacts = {{0, 1, mu}};
  for (const double tangent : {0.1, 0.29, 0.31, 1.0})
    for (const double azimuth : {0.0, 1.0, 2.5, 4.0}) {
      const Vector2d downhill(std::cos(azimuth), std::sin(azimuth));
      const Vector3d r(1, tangent * downhill.x(), tangent * downhill.y());
      VectorXd p = VectorXd::Zero(3);
      ASSERT_EQ(solver.solve(MatrixXd::Identity(3, 3), r, contacts, p), SolveStatus::solved);
      EXPECT_NEAR(p(0), 1, 1e-12);
      EXPECT_LE((p.tail<2>() - std::min(tangent, mu) * downhill).norm(), 1e-12) << tangent;
      EXPECT_EQ(solver.states()[0], tangent < mu ? ContactState::stick : ContactState::slip);
      EXPECT_FALSE(solver.several());
    }
}

// ---- Painlevé ----

// A uniform rod of unit mass leans on its end, 63.4° (tangent 2) above the ground: S_nn = 1 + 3 cos² = 1.6,
// S_nt = 3 sin cos = 1.2, S_tt = 1 + 3 sin² = 3.4. While it slips towards +t, p_n moves the end by
// S_nn − μ S_nt = −0.8 for μ = 2. With r = (−0.8, −10), the rod may lift off, slip with p = (1, −2), where
// w_t = −5.6 + 10, or jam with p = S⁻¹ r = (2.32, −3.76).
TEST(FrictionSolver, finds_three_solutions_of_Painlevés_rod) {
  Problem rod{MatrixXd::Identity(3, 3), Vector3d(-0.8, -10, 0), {{0, 1, 2}}};
  rod.S.topLeftCorner(2, 2) << 1.6, 1.2, 1.2, 3.4;
  const std::vector<std::pair<Vector3d, ContactState>> solutions = {{{0, 0, 0}, ContactState::open},
                                                                    {{1, -2, 0}, ContactState::slip},
                                                                    {{2.32, -3.76, 0}, ContactState::stick}};
  for (const auto& [expected, state] : solutions) {
    FrictionSolver solver(3);
    VectorXd p = expected * (1 + 1e-3);
    ASSERT_EQ(solver.solve(rod.S, rod.r, rod.contacts, p), SolveStatus::solved);
    EXPECT_LE((p - expected).norm(), 1e-11);
    EXPECT_EQ(solver.states()[0], state);
    EXPECT_TRUE(solver.several());
    rod.contacts[0].coefficient = 1.3;  // below S_nn / S_nt = 4/3
    ASSERT_EQ(solver.solve(rod.S, rod.r, rod.contacts, p), SolveStatus::solved);
    EXPECT_EQ(p, VectorXd::Zero(3));
    EXPECT_FALSE(solver.several());
    rod.contacts[0].coefficient = 2;
  }
}

// The determinants at all solutions are ±1 in sign and add up to 1, so that their number is odd. The solution
// that the solver finds is one of them.
TEST(FrictionPoint, has_an_odd_number_of_solutions_that_satisfy_the_law) {
  Random random(16);
  FrictionSolver solver(3);
  int slipping = 0, ambiguous = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double mu = uniform(random, 0.01, trial % 3 == 0 ? 5 : 1);
    const Problem problem = random_problem(random, 1, 0, mu, 0.01);
    FrictionPoint point;
    point.S = problem.S;
    point.r = problem.r;
    point.coefficient = mu;
    const FrictionPoint::Solutions all = point.solve(true);
    EXPECT_EQ(all.count % 2, 1) << trial;
    double nearest = infinity;
    VectorXd p = VectorXd::Zero(3);
    solver.reset();
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    for (int k = 0; k < all.count; ++k) {
      EXPECT_LE(violation(problem, all.at[k].p), 1e-12) << trial;
      nearest = std::min(nearest, (all.at[k].p - p).norm());
      slipping += all.at[k].state == ContactState::slip;
    }
    EXPECT_LE(nearest, 1e-9 * (1 + p.norm())) << trial << ": tolerance times condition number";
    ambiguous += all.count > 1;
  }
  EXPECT_GT(slipping, 500);
  EXPECT_GT(ambiguous, 10);
}

// ---- Refusals and limits ----

TEST(FrictionSolver, refuses_a_push_along_the_null_space) {
  FrictionSolver solver(6);
  MatrixXd S = MatrixXd::Identity(6, 6);
  S.topLeftCorner(2, 2) << 1, -1, -1, 1;  // two walls that face each other
  const std::vector<FrictionContact> contacts = {{0, 2, 0.3}, {1, 4, 0.3}};
  VectorXd r(6), p = VectorXd::Zero(6);
  r << 1, 1, 0.1, 0, 0, 0;
  EXPECT_EQ(solver.solve(S, r, contacts, p), SolveStatus::no_solution);
  EXPECT_EQ(p, VectorXd::Zero(6));
  r(1) = -1;
  EXPECT_EQ(solver.solve(S, r, contacts, p), SolveStatus::solved);
  EXPECT_LE(violation({S, r, contacts}, p), 1e-12);
  r << -1, 1e-3, 0, 0, 0, 0;
  p.setZero();
  EXPECT_EQ(solver.solve(MatrixXd::Zero(6, 6), r, contacts, p), SolveStatus::no_solution);
}

TEST(FrictionSolver, refuses_what_is_not_a_number) {
  FrictionSolver solver(3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const MatrixXd S = MatrixXd::Identity(3, 3);
  std::vector<FrictionContact> contacts = {{0, 1, 0.3}};
  VectorXd p = VectorXd::Zero(3);
  EXPECT_EQ(solver.solve(S, Vector3d(1, nan, 0), contacts, p), SolveStatus::not_finite);
  EXPECT_EQ(solver.solve(MatrixXd::Constant(3, 3, nan), Vector3d(1, 0, 0), contacts, p),
            SolveStatus::not_finite);
  MatrixXd coupled = S;
  coupled(0, 1) = coupled(1, 0) = infinity;
  EXPECT_EQ(solver.solve(coupled, Vector3d(1, 0, 0), contacts, p), SolveStatus::not_finite);
  contacts[0].coefficient = nan;
  EXPECT_EQ(solver.solve(S, Vector3d(1, 0, 0), contacts, p), SolveStatus::not_finite);
  EXPECT_EQ(p, VectorXd::Zero(3));
  contacts[0].coefficient = 0.3;
  p(0) = nan;  // as a guess, it is ignored
  EXPECT_EQ(solver.solve(S, Vector3d(1, 0, 0), contacts, p), SolveStatus::solved);
  EXPECT_LE((p - Vector3d(1, 0, 0)).norm(), 1e-12);
}

TEST(FrictionSolver, gives_no_energy_if_it_is_stopped_and_continues_from_there) {
  Random random(10);
  int stopped = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Problem problem = random_problem(random, 4 + trial % 10, 0, uniform(random, 0, 1), 0.1);
    FrictionSolver solver(60, {.max_iterations = trial % 3});
    VectorXd p = VectorXd::Zero(problem.r.size());
    int calls = 0;
    for (; solver.solve(problem.S, problem.r, problem.contacts, p) == SolveStatus::limited && calls < 40;
         ++calls) {
      const VectorXd w = problem.S * p - problem.r;
      EXPECT_LE(p.dot(w), 1e-14 * p.cwiseAbs().dot(problem.r.cwiseAbs()));
      EXPECT_NEAR(solver.residual().violation, std::max(0.0, -w.head(problem.contacts.size()).minCoeff()),
                  1e-12);
      EXPECT_GT(solver.residual().scale, 0);
      for (const FrictionContact& c : problem.contacts)
        EXPECT_LE(p.segment<2>(c.tangential).norm(), c.coefficient * p(c.normal) * (1 + 1e-15));
      ++stopped;
      if (trial % 3 == 0) break;  // no iteration, no progress
    }
    if (trial % 3 == 2) {
      EXPECT_LT(calls, 40);
    }
  }
  EXPECT_GT(stopped, 300);
}

// A single iteration for each step, as max_pivots = 1 asks for. All points are pressed and far from slipping.
TEST(FrictionSolver, presses_points_that_close_in_a_single_iteration) {
  Random random(23);
  const Problem problem = random_problem(random, 6, 0, 1e3, 0.1);
  VectorXd expected = VectorXd::Zero(18), p = expected;
  expected.head(6).setConstant(1);
  FrictionSolver solver(18, {.max_iterations = 1});
  const VectorXd r = problem.S * expected;
  int calls = 1;
  while (solver.solve(problem.S, r, problem.contacts, p) == SolveStatus::limited && calls < 10) ++calls;
  EXPECT_LT(calls, 10);
  EXPECT_LE((p - expected).cwiseAbs().maxCoeff(), 1e-10) << "tolerance times condition number";
}

// ---- Warm start ----

/// Points that press and slide along a direction that turns, with forces known in advance.
VectorXd sliding(const Problem& problem, double time) {
  const Index points = static_cast<Index>(problem.contacts.size());
  VectorXd force = VectorXd::Zero(problem.r.size()), motion = force;
  for (Index k = 0; k < points; ++k) {
    const FrictionContact& c = problem.contacts[static_cast<std::size_t>(k)];
    const double phase = time + 0.3 * static_cast<double>(k);
    const Vector2d t(std::cos(phase), std::sin(phase));
    const double normal = std::sin(3 * phase) + 0.5;
    if (normal > 0) {
      force(c.normal) = normal;
      const bool slips = std::sin(5 * phase) > 0;
      force.segment<2>(c.tangential) = -c.coefficient * normal * (slips ? 1 : 0.5) * t;
      if (slips) motion.segment<2>(c.tangential) = std::sin(5 * phase) * t;
    } else {
      motion(c.normal) = -normal;
    }
  }
  return problem.S * force - motion;
}

TEST(FrictionSolver, starts_from_the_forces_of_the_problem_before) {
  Random random(11);
  const Problem problem = random_problem(random, 12, 0, 0.3, 0.2);
  FrictionSolver solver(36, {.same_matrix = true});
  VectorXd p = VectorXd::Zero(36);
  constexpr int steps = 2000;
  for (int k = 0; k < steps; ++k) {
    const VectorXd r = sliding(problem, 1e-3 * k);
    ASSERT_EQ(solver.solve(problem.S, r, problem.contacts, p), SolveStatus::solved);
    ASSERT_LE(violation({problem.S, r, problem.contacts}, p), 1e-12);
  }
  // each of the 12 points passes through at most 16 changes of its state in these 2 radians
  EXPECT_GT(solver.statistics().warm_hits, steps - 12 * 16 - 1);
  EXPECT_LT(solver.statistics().renewals, steps) << "factors are kept";
  EXPECT_EQ(solver.statistics().problems, steps);
  EXPECT_EQ(solver.statistics().fallbacks, 0);
}

TEST(FrictionSolver, keeps_one_factor_while_all_points_stick) {
  Random random(12);
  const Problem problem = random_problem(random, 10, 2, 0.5, 0.2);
  FrictionSolver solver(32, {.same_matrix = true});
  VectorXd p = VectorXd::Zero(32), force = VectorXd::Zero(32);
  for (int k = 0; k < 100; ++k) {
    force.head(12).setConstant(2 + std::sin(0.1 * k));
    force.tail(20).setConstant(0.1 * std::cos(0.1 * k));
    ASSERT_EQ(solver.solve(problem.S, problem.S * force, problem.contacts, p), SolveStatus::solved);
    EXPECT_LE((p - force).cwiseAbs().maxCoeff(), 1e-10) << "tolerance times condition number";
    if (k == 0) solver = FrictionSolver(solver);  // copies keep it too
  }
  const auto renewals = solver.statistics().renewals;
  EXPECT_LE(renewals, 10) << "those of the first solve";
  solver.reset();
  ASSERT_EQ(solver.solve(problem.S, problem.S * force, problem.contacts, p), SolveStatus::solved);
  EXPECT_LE(solver.statistics().renewals, renewals + 1);
}

// Rows that follow one another are solved where they are, so the matrix may be elsewhere in the next solve.
TEST(FrictionSolver, follows_a_matrix_that_moves) {
  constexpr int points = 4;
  Random random(14);
  Problem problem = random_problem(random, points, 0, 0.5, 0.2);
  VectorXd force = VectorXd::Constant(3 * points, 0.1), p = VectorXd::Zero(3 * points);
  for (int k = 0; k < points; ++k) {
    problem.contacts[k].normal = 3 * k;
    problem.contacts[k].tangential = 3 * k + 1;
    force(3 * k) = 2;
  }
  FrictionSolver solver(3 * points, {.same_matrix = true});
  std::vector<MatrixXd> all(3, problem.S);  // each at a place of its own
  for (std::size_t k = 0; k < all.size(); ++k) {
    MatrixXd& moved = all[k];
    const double scale = 1 + 0.1 * static_cast<double>(k);
    ASSERT_EQ(solver.solve(moved, moved * (scale * force), problem.contacts, p), SolveStatus::solved);
    EXPECT_LE((p - scale * force).cwiseAbs().maxCoeff(), 1e-10) << "tolerance times condition number";
    moved.setConstant(NAN);
  }
}

TEST(FrictionSolver, notices_that_the_matrix_has_changed) {
  Random random(13);
  FrictionSolver solver(30);
  VectorXd p = VectorXd::Zero(30);
  for (int k = 0; k < 50; ++k) {
    const Problem problem = random_problem(random, 10, 0, 0.4, 0.3);
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    EXPECT_LE(violation(problem, p), 1e-12);
  }
}

// With the product of the old matrix, the old forces would seem to be the answer.
TEST(FrictionSolver, multiplies_the_forces_before_by_a_matrix_that_has_changed) {
  Random random(17);
  Problem problem = random_problem(random, 6, 0, 0.3, 0.2);
  VectorXd force = VectorXd::Constant(18, 0.1), p = VectorXd::Zero(18);
  force.head(6).setOnes();
  problem.r = problem.S * force;
  FrictionSolver solver(18, {.same_matrix = true});
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    EXPECT_LE(violation(problem, p), 1e-12);
    problem.S *= 2;
    solver.change_matrix();
  }
}

// 1e-14: sums of 30 terms, and 2e-15 of the forces
TEST(FrictionSolver, knows_the_product_of_its_forces_where_all_points_touch) {
  Random random(16);
  const Problem problem = random_problem(random, 10, 0, 0.4, 0.3);
  FrictionSolver solver(30, {.same_matrix = true});
  VectorXd p = VectorXd::Zero(30), force = p, product = p;
  EXPECT_FALSE(solver.product(p, product)) << "nothing was solved";
  for (int k = 0; k < 20; ++k) {
    for (int i = 0; i < 30; ++i) force(i) = i < 10 ? 1 + 0.1 * std::sin(k + i) : 0.2 * std::cos(k + i);
    ASSERT_EQ(solver.solve(problem.S, problem.S * force, problem.contacts, p), SolveStatus::solved);
    ASSERT_TRUE(solver.product(p, product));
    EXPECT_LE((product - problem.S * p).cwiseAbs().maxCoeff(), 1e-14 * product.cwiseAbs().maxCoeff());
    VectorXd other = p;
    other(k) *= 1 + 1e-12;
    EXPECT_FALSE(solver.product(other, product));
  }
}

TEST(FrictionSolver, accepts_coefficients_that_change_to_and_from_zero) {
  Random random(14);
  Problem problem = random_problem(random, 8, 1, 0, 0.3);
  FrictionSolver solver(25, {.same_matrix = true});
  VectorXd p = VectorXd::Zero(25);
  for (int k = 0; k < 300; ++k) {
    for (FrictionContact& c : problem.contacts) c.coefficient = k % 3 == 0 ? 0 : uniform(random, 0, 0.6);
    problem.r += 0.1 * lcp::normal_vector(random, 25);
    ASSERT_EQ(solver.solve(problem.S, problem.r, problem.contacts, p), SolveStatus::solved);
    EXPECT_LE(violation(problem, p), 1e-12);
  }
}

#if RICOCHET_HEAP_COUNTED
TEST(FrictionSolver, takes_no_memory) {
  Random random(15);
  FrictionSolver solver(120);
  std::vector<Problem> problems;
  for (int k = 0; k < 60; ++k) {
    problems.push_back(random_problem(random, k % 2 ? 40 : 5, 0, k % 5 == 0 ? 8 : 0.3, k % 3 ? 0.1 : 0));
    if (k % 10 == 9) problems.back().S.setZero();
  }
  VectorXd p = VectorXd::Zero(120);
  const long before = heap_counter::calls;
  for (const Problem& problem : problems) {
    solver.reset();
    solver.solve(problem.S, problem.r, problem.contacts, p.head(problem.r.size()));
  }
  const long after = heap_counter::calls;
  EXPECT_EQ(after, before);
  EXPECT_GT(solver.statistics().fallbacks, 0);
}
#endif

}  // namespace friction_solver_test
