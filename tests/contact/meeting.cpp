// SPDX-License-Identifier: BSD-2-Clause
// Bodies that turn by any angle and meet each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/stepping/floating_stepper.hpp"
#include "tests/contact/cloud.hpp"
#include "tests/support.hpp"

namespace ricochet::contact::test {
namespace {

struct Meeting {
  std::vector<const Cloud*> clouds;
  std::vector<PlacedBody> bodies;
  std::optional<Friction> friction{};
  Vector3d gravity{0, 0, 0};
  bool floor = false;
};

std::shared_ptr<Model> meet(const Meeting& scene) {
  std::vector<PlacedBody> bodies = scene.bodies;
  std::vector<PairRequest> pairs;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies[k].name = "b" + std::to_string(k);
    bodies[k].kernel = &scene.clouds[k]->kernel;
    for (std::size_t j = 0; j < k; ++j) pairs.push_back({bodies[j].name, bodies[k].name, {}, {}, {}});
    if (scene.floor) pairs.push_back({bodies[k].name, "floor", {}, {}, {}});
  }
  for (PairRequest& pair : pairs) {
    pair.friction = scene.friction;
    pair.everywhere = true;
  }
  return std::make_shared<Model>(build_model(
      bodies, {{.name = "floor", .point = {0, 0, 0}, .normal = Vector3d::UnitZ()}}, pairs, scene.gravity));
}

Vector3d momentum(const Meeting& scene, const Stepper& stepper) {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < scene.clouds.size(); ++k)
    out += scene.clouds[k]->mass * stepper.poses()[k].velocity;
  return out;
}

Vector3d angular_momentum(const Meeting& scene, const Stepper& stepper) {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < scene.clouds.size(); ++k) {
    const Pose& pose = stepper.poses()[k];
    const Matrix3d A = pose.attitude.toRotationMatrix();
    out += A * scene.clouds[k]->inertia * A.transpose() * pose.spin +
           scene.clouds[k]->mass * pose.position.cross(pose.velocity);
  }
  return out;
}

/// Irregular bodies with modes, R, spins and friction, from few to many steps in a touch.
TEST(Meeting, keeps_the_balances) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-1, 1);
  const auto any = [&] { return Vector3d(between(random), between(random), between(random)); };
  for (int round = 0; round < 12; ++round) {
    const double rate = 1e4 * std::pow(10.0, round % 3);
    std::vector<std::unique_ptr<Cloud>> clouds;
    Meeting scene;
    for (int k = 0; k < 3; ++k) {
      clouds.push_back(std::make_unique<Cloud>(Vector3d(0.1, 0.08, 0.06), 2000, round % 4 == 0 ? 0 : 1e-8,
                                               static_cast<unsigned>(10 * round + k)));
      scene.clouds.push_back(clouds.back().get());
      PlacedBody body;
      body.rotation = turn(3 * between(random), any());
      body.translation = Vector3d(0.15 * (k - 1), 0, 0) + 0.01 * any();
      body.velocity = Vector3d(-3.0 * (k - 1), 0, 0) + 0.3 * any();
      body.angular_velocity = 30 * any();
      scene.bodies.push_back(body);
    }
    if (round % 2) scene.friction = Friction{0.5, 0.5, 0};
    const auto model = meet(scene);
    auto stepper = make_stepper(model, stepping(rate));
    const Energy start = stepper->modal()->energy();
    const Vector3d p = momentum(scene, *stepper), L = angular_momentum(scene, *stepper);
    double highest = 0, drift = 0;
    const int steps = static_cast<int>(0.03 * rate);
    int touching = 0;
    for (int k = 0; k < steps; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok) << round << " " << k;
      const Energy now = stepper->modal()->energy();
      highest = std::max(highest, now.total() / start.total() - 1);
      drift = std::max(drift, std::abs(now.ledger() - start.ledger()) / start.total());
      touching += stepper->active() > 0;
    }
    ASSERT_GT(touching, 3) << round;
    EXPECT_LT(highest, 1e-12) << round;  // contact never adds energy
    EXPECT_LT(drift, 1e-12) << round;
    EXPECT_LT((momentum(scene, *stepper) - p).norm(), 1e-13 * start.kinetic) << round;
    EXPECT_LT((angular_momentum(scene, *stepper) - L).norm(), 1e-12 * L.norm()) << round;
  }
}

}  // namespace
}  // namespace ricochet::contact::test
