// SPDX-License-Identifier: BSD-2-Clause
// The balance of angular momentum in impacts of spinning bodies, against the mechanics of rigid bodies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/rigid_plate.hpp"
#include "tests/kernels/bar.hpp"

namespace angular_momentum_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

const Vector3d up(0, 0, 1);
const std::vector<Obstacle> ground{{"floor", Vector3d::Zero(), up}};

TEST(Spin, gives_the_momenta_and_the_energy_of_a_rigid_body) {
  Kernel kernel = rigid_plate();
  const Vector3d V(0.3, -0.2, -1), w(0.1, 0.4, -0.7), t(3, 1, 2);
  const Matrix3d Q = turn(0.4, {1, 2, -1});
  const Model model = build_model({{"plate", &kernel, Q, t, V, w}}, ground, {{"plate", "floor", {}, {}, {}}},
                                  Vector3d::Zero());
  const Vector3d centre = Q * Vector3d(0.5, 0.5, 0) + t;
  // Mass 1 and inertia 1.
  EXPECT_LT((model.momentum(0, model.v0, 0) - V).norm(), 1e-14);
  EXPECT_LT((model.angular_momentum(0, model.v0, 0) - (centre.cross(V) + w)).norm(), 1e-14);
  EXPECT_NEAR(0.5 * model.v0.squaredNorm(), 0.5 * V.squaredNorm() + 0.5 * w.squaredNorm(), 1e-14);
  // Each point moves at V + ω × (x − c).
  for (int i = 0; i < model.gap.size(); ++i) {
    const Vector3d n = model.normal.row(i), x = model.point_a.row(i);
    EXPECT_NEAR(model.B.row(i).dot(model.v0), n.dot(V + w.cross(x - centre)), 1e-14);
  }
}

TEST(Spin, that_a_body_can_not_have_is_refused) {
  const Kernel rod_kernel = rod(3, 10), clamped = ricochet::kernels::test::Bar{}.kernel();
  const auto spun = [](const Kernel& kernel, const Vector3d& w) {
    build_model({{"body", &kernel, Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero(), w}},
                {{"wall", Vector3d(11, 0, 0), Vector3d(-1, 0, 0)}}, {{"body", "wall", {}, {}, {}}},
                Vector3d::Zero());
  };
  EXPECT_THAT(complaint_of([&] {
                spun(rod_kernel, {0, 0, 1});
              }),
              HasSubstr("bodies.body.angular_velocity: this body cannot move rigidly that way"));
  EXPECT_THAT(complaint_of([&] {
                spun(rod_kernel, {1, 0, 0});
              }),  // about its axis, without inertia
              HasSubstr("bodies.body.angular_velocity: this body cannot"));
  EXPECT_THAT(complaint_of([&] {
                spun(clamped, {0, 0, 1});
              }),
              HasSubstr("Set angular_velocity = [0, 0, 0], or take its support out."));
}

/// One edge of a plate that falls at 1 m/s and turns at w about y hits the floor.
struct Blow {
  double speed, spin, impulse;  ///< after the blow, upward; about y; of the floor
  Vector3d left;                ///< change of angular momentum about the origin, less the moment of the floor
};

Blow blow(double w, double restitution) {
  const Kernel kernel = rigid_plate();
  const Model model =
      build_model({{"plate", &kernel, Matrix3d::Identity(), {3, 2, 0.01}, {0, 0, -1}, {0, w, 0}}}, ground,
                  {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
  const auto stepper =
      make_stepper(model, {.contact = {.scheme = Scheme::impulse, .restitution = restitution}, .step = 1e-4});
  const auto spin = [&](const Vector& v) {  // about the centre, inertia 1
    return Vector3d(model.angular_momentum(0, v, 0) - model.bodies[0].centre.cross(model.momentum(0, v, 0)));
  };
  const Vector3d before = model.angular_momentum(0, model.v0, 0);
  Vector3d moment = Vector3d::Zero();
  Blow out{};
  while (out.impulse == 0 && stepper->time() < 0.1) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    for (int i = 0; i < model.gap.size(); ++i) {
      const double P = stepper->force()(i) * 1e-4;
      out.impulse += P;
      moment += Vector3d(model.point_a.row(i)).cross(P * up);
    }
  }
  const Vector& after = stepper->modal()->v;
  out.speed = model.momentum(0, after, 0).z();
  out.spin = spin(after).y();
  out.left = model.angular_momentum(0, after, 0) - before - moment;
  return out;
}

// ω > 0 lowers the edge x = 1, at r = 1/2: P = (1 + e) (v + ω r)/(1/m + r²/I), v' = −v + P/m, ω' = ω − r P/I.
TEST(Spin, changes_by_the_moment_of_the_impulse_of_an_edge) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const double w = 0.8, r = 0.5, P = (1 + e) * (1 + w * r) / (1 + r * r);
    const Blow found = blow(w, e);
    EXPECT_NEAR(found.impulse, P, 1e-11) << e;
    EXPECT_NEAR(found.speed, -1 + P, 1e-11) << e;
    EXPECT_NEAR(found.spin, w - r * P, 1e-11) << e;
    EXPECT_LT(found.left.norm(), 1e-12) << e;
  }
}

// Two plates without gravity: nothing else acts on them.
TEST(AngularMomentum, of_two_spinning_bodies_is_conserved) {
  Kernel soft = rigid_plate();
  soft.surface.residual_flexibility.assign(27 * 27, 0);
  for (std::size_t i = 0; i < 27; ++i) soft.surface.residual_flexibility[28 * i] = 1e-4;
  const Model model =
      build_model({{"upper", &soft, Matrix3d::Identity(), {0.3, 0.2, 0.01}, {0.1, 0.2, -1}, {0.2, -0.5, 0.3}},
                   {"lower", &soft, upside_down(), {0, 1, 0}, {0, 0, 0.5}, {-0.4, 0.3, 0.1}}},
                  {}, {{"upper", "lower", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  ASSERT_GT(model.gap.size(), 1);
  const auto total = [&](const Vector& v) {
    Eigen::Matrix<double, 6, 1> out;
    out << model.momentum(0, v, 0) + model.momentum(1, v, 0),
        model.angular_momentum(0, v, 0) + model.angular_momentum(1, v, 0);
    return out;
  };
  const auto at_start = total(model.v0);
  const auto stepper = make_stepper(model, {.step = 1e-5});
  double impulse = 0, exchanged = 0;
  for (int k = 0; k < 5000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    impulse += 1e-5 * stepper->force().sum();
    ASSERT_LT((total(stepper->modal()->v) - at_start).norm(), 1e-11) << k;
    exchanged = std::max(
        exchanged,
        (model.angular_momentum(0, stepper->modal()->v, 0) - model.angular_momentum(0, model.v0, 0)).norm());
  }
  EXPECT_GT(impulse, 0.5);    // they did hit each other,
  EXPECT_GT(exchanged, 0.1);  // off centre
}

}  // namespace angular_momentum_test
