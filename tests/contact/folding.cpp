// SPDX-License-Identifier: BSD-2-Clause
// Folded modes respond at once: a folded model moves its points as the whole one does with
// q_n = (f_n + F_n h − B_nᵀ p)/ω_n² for the modes that a step does not sample.
#include "contact/model/folding.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/contact/bodies.hpp"

namespace folding_test {

using namespace ricochet;
using namespace ricochet::contact;
using contact::test::clamped_bar;
using contact::test::rod;
using Eigen::Vector3d;
using kernels::Kernel;

constexpr double length = 10, t = 2, weight = 3e-3;

/// A rod in front of the tip of a bar under its weight, a load at its tip and a moving foot.
Model bar_and_rod(const Kernel& bar, const Kernel& free_rod) {
  return build_model({{"bar", &bar}, {"rod", &free_rod, Eigen::Matrix3d::Identity(), {length + 0.5, 0, 0}}},
                     {}, {{"bar", "rod", Vector3d(1, 0, 0), {}, {}}}, {weight, 0, 0},
                     {{"bar", "tip", false, {0.7, 0, 0}, {{0, 4}, {0, 1}}},
                      {"bar", "foot", true, {0.2, 0, 0}, {{0, 4}, {0, 1}}}});
}

/// Displacements of a point, of the bar's side of it and of its receiver.
struct Motion {
  double u, u_a, receiver;
};

/// The motion for modal coordinates q and a force p, with all that the model adds to B q.
Motion motion_of(const Model& model, const Vector& q, const Vector& p) {
  const Bodies::Block& bar = model.bodies[0];
  const Model::Receiver& mic = model.receivers[0];
  Motion out{
      model.B.row(0).dot(q) + model.static_displacement(0) - model.R(0, 0) * p(0),
      model.B.row(0).head(bar.modes).dot(q.head(bar.modes)) + model.static_a(0) - model.R_a(0, 0) * p(0),
      mic.shape.row(0).dot(q.head(bar.modes)) + mic.constant.x() + mic.flexibility(0, 0) * p(0)};
  for (std::size_t d = 0; d < model.forcing.size(); ++d) {
    const double h = model.forcing[d].history.at(t);
    out.u += h * model.forcing[d].displacement(0);
    out.u_a += h * model.forcing[d].displacement_a(0);
    out.receiver += h * mic.forcing(0, static_cast<Eigen::Index>(d));
  }
  return out;
}

TEST(Folding, keeps_the_motion_of_points_and_receivers) {
  const Kernel bar = clamped_bar(12, length), free_rod = rod(9, length / 2);
  const Model model = bar_and_rod(bar, free_rod);
  const double step = 1.5;  // of the bar, modes from ω = 2.2 on are folded, and of the rod from 2.5 on
  const auto folded = fold(borrowed(model), {.step = step});
  ASSERT_EQ(folded->folded.modes.size(), 5U + 5U);
  const Vector p{{0.4}};
  Vector q = Vector::LinSpaced(model.omega.size(), 0.3, -0.2), moving = q;
  for (const int n : folded->folded.modes) {
    double force = model.load(n) - model.B(0, n) * p(0);
    if (n < 12) force += model.forcing[0].history.at(t) * model.forcing[0].force(n);
    q(n) = force / (model.omega(n) * model.omega(n));
    moving(n) = 0;
  }
  const Motion expected = motion_of(model, q, p), found = motion_of(*folded, moving, p);
  EXPECT_NEAR(found.u, expected.u, 1e-12);
  EXPECT_NEAR(found.u_a, expected.u_a, 1e-12);
  EXPECT_NEAR(found.receiver, expected.receiver, 1e-12);
  Vector all = moving, rates = Vector::Zero(q.size());
  set_folded(*folded, t, p, all, &rates);
  EXPECT_LT((all - q).norm(), 1e-14);
  for (const int n : folded->folded.modes) {
    const double slope = n < 12 ? model.forcing[0].force(n) / 4 : 0;
    EXPECT_NEAR(rates(n), slope / (model.omega(n) * model.omega(n)), 1e-15) << n;
  }
}

// The spring of a point is that of its patch, whatever the step.
TEST(Folding, keeps_springs_and_their_shares) {
  const Kernel bar = clamped_bar(12, length), free_rod = rod(9, length / 2);
  Model model = bar_and_rod(bar, free_rod);
  model.bulge = Vector::Constant(1, 0.01);
  const auto folded = fold(borrowed(model), {.step = 1.5});
  ASSERT_EQ(model.springs().size(), 1U);
  EXPECT_EQ(folded->springs()[0].limit, model.springs()[0].limit);
  EXPECT_EQ(folded->patch_flexibility(), Vector(model.R.diagonal()));
  EXPECT_EQ(folded->patch_flexibility_of_a(), Vector(model.R_a.diagonal()));
  EXPECT_GT(folded->R(0, 0), 1.1 * model.R(0, 0));
}

TEST(Folding, leaves_models_alone_that_are_sampled_or_struck) {
  const Kernel bar = clamped_bar(12, length), free_rod = rod(9, length / 2);
  const auto model = std::make_shared<const Model>(bar_and_rod(bar, free_rod));
  EXPECT_EQ(fold(model, {.step = 0.1}), model);
  EXPECT_EQ(fold(model, {.contact = {.scheme = Scheme::impulse}, .step = 1.5}), model);
  const auto folded = fold(model, {.step = 1.5});
  EXPECT_NE(folded, model);
  EXPECT_EQ(fold(folded, {.step = 1.5}), folded);
}

}  // namespace folding_test
