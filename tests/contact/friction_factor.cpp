// SPDX-License-Identifier: BSD-2-Clause
// A step of Newton's method with a factor that was updated for changed states against one with a new factor.
// The solver would hide a wrong update, as it falls back on new factors.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "contact/complementarity/friction_system.hpp"

namespace friction_factor_test {

using namespace ricochet::contact;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using enum ContactState;

constexpr int rubbing = 20, smooth = 4, points = rubbing + smooth, rows = 3 * rubbing + smooth;
constexpr double coefficient = 0.4;

class UpdatedFactor : public testing::Test {
 protected:
  UpdatedFactor() {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const MatrixXd B = MatrixXd::NullaryExpr(rows, 2 * rows, [&] { return normal(random); });
    A_ = B * B.transpose() / (2 * rows);
    near_ = 1e-3 * VectorXd::NullaryExpr(rows, [&] { return normal(random); });
  }

  static Index row_of(int k) { return k < rubbing ? 3 * k : 2 * rubbing + k; }
  static Vector2d direction(int k) { return {std::cos(0.7 * k), std::sin(0.7 * k)}; }

  FrictionSystem make_system() {
    FrictionSystem system(rows);
    for (int k = 0; k < points; ++k) system.add(k < rubbing ? coefficient : 0);
    system.A() = A_;
    system.set_matrix();
    return system;
  }

  /// Forces of these states, moved by `by` times a small vector that leaves slipping points in the cone.
  VectorXd forces(const std::vector<ContactState>& states, double by) const {
    VectorXd p = VectorXd::Zero(rows);
    for (int k = 0; k < points; ++k) {
      if (states[k] == open) continue;
      const Index row = row_of(k);
      p(row) = 1 + 0.02 * k + by * near_(row);
      if (k >= rubbing) continue;
      p.segment<2>(row + 1) = -coefficient * p(row) * direction(k);
      if (states[k] == stick)
        p.segment<2>(row + 1) = 0.3 * p.segment<2>(row + 1) + by * near_.segment<2>(row + 1);
    }
    return p;
  }

  /// Solves for the forces of these states, known in advance, in a step of Newton's method and one more to
  /// round-off. The slips do not turn, so that the problem is linear. Returns the number of factors that were
  /// made.
  int factors_to_solve(FrictionSystem& system, const std::vector<ContactState>& states) {
    const VectorXd expected = forces(states, 0);
    VectorXd w = VectorXd::Zero(rows);
    for (int k = 0; k < points; ++k) {
      const Index row = row_of(k);
      if (states[k] == open) w(row) = 0.5;
      if (states[k] == slip) w.segment<2>(row + 1) = 0.2 * direction(k);
      system[k].state = states[k];
      system[k].direction = direction(k);
      system[k].slip = 0.2;
    }
    const VectorXd r = A_ * expected - w;
    VectorXd::Map(system.r(), rows) = r;
    VectorXd::Map(system.p(), rows) = forces(states, 1);
    int left = 2;
    SolveStatistics statistics;
    const double largest = r.cwiseAbs().maxCoeff();
    EXPECT_EQ(system.solve(largest, largest, left, statistics), SolveStatus::solved);
    // the tolerance of w times the condition of Newton's matrix
    EXPECT_LT((VectorXd::Map(system.p(), rows) - expected).norm(), 1e-9 * expected.norm());
    return static_cast<int>(statistics.renewals);
  }

  MatrixXd A_;
  VectorXd near_;  ///< small
};

// The factor is made with point 3 in one state and point 21, without friction, in one. Both change once, and
// return. Others slip, stick and are open throughout.
TEST_F(UpdatedFactor, solves_in_one_step) {
  for (const ContactState from : {open, stick, slip})
    for (const ContactState to : {open, stick, slip}) {
      if (from == to) continue;
      SCOPED_TRACE(testing::Message() << int(from) << " to " << int(to));
      std::vector<ContactState> states(points, stick);
      states[8] = states[15] = slip;
      states[11] = states[22] = open;
      states[3] = from;
      states[21] = from == open ? open : stick;
      FrictionSystem system = make_system();
      EXPECT_EQ(factors_to_solve(system, states), 1);
      states[3] = to;
      states[21] = from == open ? stick : open;
      EXPECT_EQ(factors_to_solve(system, states), 0);
      states[3] = from;
      EXPECT_EQ(factors_to_solve(system, states), 0);
      states[12] = open;
      EXPECT_EQ(factors_to_solve(system, states), 0);
    }
}

}  // namespace friction_factor_test
