// SPDX-License-Identifier: BSD-2-Clause
// Two clouds of masses fall on a floor, turning. The part of the scene around the first touch, with linear
// rotations, is compared with the run of the whole scene.
#include "src/accuracy/around_first_touch.hpp"

#include <gtest/gtest.h>

#include "contact/api/scene_model.hpp"
#include "contact/stepping/run_steps.hpp"
#include "src/store/placing.hpp"
#include "tests/contact/cloud.hpp"

namespace around_first_touch_test {

using namespace ricochet;
using contact::Vector;
using contact::test::Cloud;
using Eigen::Vector3d;

constexpr double rate = 2e5;

/// The second body is the lower one.
struct Falling {
  Cloud cloud{{0.1, 0.08, 0.06}, 2000, 1e-8, 3};
  scene::Scene scene;
  store::Kernels kernels;
  contact::Model model;

  /// @param pushed  both bodies, hardly turning, by a force at their centres
  explicit Falling(bool pushed = false) {
    if (pushed) {
      kernels::Load load{.name = "push", .unit = "N", .participation = cloud.kernel.loads.body_force};
      for (double& x : load.participation) x /= cloud.mass;
      const Vector3d& c = cloud.centre;
      load.total = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      load.moment = {0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0};
      load.residual.assign(9 * cloud.kernel.surface.size(), 0);
      cloud.kernel.applied = {load};
    }
    const auto kernel = std::shared_ptr<const kernels::Kernel>(&cloud.kernel, [](const auto*) {});
    for (const char* name : {"high", "low"}) {
      scene::Body& body = scene.bodies.emplace_back();
      body.name = name;
      body.rotate_deg = {35, -20, 40};
      body.velocity = {0.3, 0.1, -0.5};
      body.angular_velocity = {4, -7, 9};
      kernels.kernel.push_back(kernel);
      if (!pushed) continue;
      body.angular_velocity = {0.1, -0.2, 0.1};
      scene::Forcing& force = scene.loads.points.emplace_back();
      force.body = name;
      force.name = "push";
      force.vector = {0.5, 0, -1};
    }
    scene.bodies[0].translate = {0.4, 0, 0.5};
    scene.bodies[1].translate = {0, 0, pushed ? 0.1 : 0.3};
    scene.obstacles.push_back({{.name = "floor", .normal = {0, 0, 1}}});
    for (const auto& [a, b] : {std::pair("high", "low"), {"high", "floor"}, {"low", "floor"}}) {
      scene::Pair& pair = scene.contact.pairs.emplace_back();
      pair.a = a;
      pair.b = b;
      pair.friction = Friction{0.3, 0.3, 0};
    }
    scene.motion.rotation = Rotation::finite;
    scene.loads.gravity = {0, 0, -9.81};
    scene.time.duration = 0.3;
    scene.time.contact_rate_hz = rate;
    store::Prepared prepared{store::library_scene(scene, kernels.pointers()), {}};
    store::read_histories(scene, prepared.scene);
    prepared.placement = placement_of(prepared.scene);
    model = store::model_of(scene, prepared);
  }
  contact::FirstTouch touch() const {
    return contact::find_first_touch(model, store::step_options(scene), scene.time.duration).value();
  }
};

/// Impulse of the first pair that is pressed [N s], and velocity and spin of a body at the end.
struct Outcome {
  Vector3d impulse{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
};

Outcome outcome(const contact::Model& model, const StepOptions& options, double duration, int number) {
  const auto stepper = contact::make_stepper(contact::borrowed(model), options);
  Outcome out;
  contact::run_steps(*stepper, contact::step_count(duration, 1 / options.step), [&](std::int64_t) {
    for (const contact::Model::PairBlock& pair : model.pairs)
      if (pair.b < 0 && pair.a == number)
        out.impulse += options.step * model.resultant(pair, stepper->force(), frames_of(model, *stepper));
  });
  const contact::Bodies::Block& body = model.bodies[static_cast<std::size_t>(number)];
  if (stepper->turning()) {
    out.velocity = stepper->poses()[static_cast<std::size_t>(number)].velocity;
    out.spin = stepper->poses()[static_cast<std::size_t>(number)].spin;
  } else {
    out.velocity = model.momentum(number, stepper->modal()->v, duration) / body.mass;
    out.spin = body.inertia.inverse() * (model.angular_momentum(number, stepper->modal()->v, duration) -
                                         body.mass * body.centre.cross(out.velocity));
  }
  return out;
}

TEST(FirstTouch, with_linear_rotations_is_that_of_the_whole_scene) {
  const Falling fall;
  const contact::FirstTouch touch = fall.touch();
  const auto part = accuracy::around_first_touch(touch, fall.scene, fall.kernels, fall.model);
  ASSERT_EQ(part.scene.bodies.size(), 1);
  EXPECT_EQ(part.scene.bodies[0].name, "low");
  ASSERT_EQ(part.scene.contact.pairs.size(), 1);
  EXPECT_EQ(part.scene.contact.pairs[0].a, "low");
  EXPECT_FALSE(part.scene.motion.is_finite());
  // Only the candidates near the lowest one can touch in this time.
  EXPECT_LT(part.kernels.kernel[0]->surface.size(), 20);
  EXPECT_EQ(part.all.kernel[0]->surface.size(), 26);

  StepOptions options = store::step_options(fall.scene);
  const Outcome turning = outcome(fall.model, options, touch.until, 1);
  options.rigid.rotation = Rotation::linear;
  const Outcome linear = outcome(part.model, options, part.scene.time.duration, 0);
  EXPECT_GT(turning.impulse.norm(), 0.1);
  // The body has turned by 0.013 when it leaves, and its arm changes by this part, and so do results.
  EXPECT_NEAR(touch.turned, 0.013, 0.003);
  EXPECT_LT((turning.impulse - linear.impulse).norm(), 3 * touch.turned * turning.impulse.norm());
  EXPECT_LT((turning.velocity - linear.velocity).norm(), 3 * touch.turned * turning.velocity.norm());
  EXPECT_LT((turning.spin - linear.spin).norm(), 3 * touch.turned * turning.spin.norm());
}

/// The part begins with the run, and has the loads of its bodies alone.
TEST(FirstTouch, under_loads_with_linear_rotations_is_that_of_the_whole_scene) {
  const Falling fall(true);
  const contact::FirstTouch touch = fall.touch();
  EXPECT_EQ(touch.from, 0);
  EXPECT_GT(touch.end, 0.02);
  const auto part = accuracy::around_first_touch(touch, fall.scene, fall.kernels, fall.model);
  ASSERT_EQ(part.scene.bodies.size(), 1);
  ASSERT_EQ(part.model.forcing.size(), 1);
  StepOptions options = store::step_options(fall.scene);
  const Outcome turning = outcome(fall.model, options, touch.until, 1);
  options.rigid.rotation = Rotation::linear;
  const Outcome linear = outcome(part.model, options, part.scene.time.duration, 0);
  EXPECT_GT(turning.impulse.norm(), 0.1);
  EXPECT_GT(touch.turned, 0.005);
  EXPECT_LT((turning.impulse - linear.impulse).norm(), 3 * touch.turned * turning.impulse.norm());
  EXPECT_LT((turning.velocity - linear.velocity).norm(), 3 * touch.turned * turning.velocity.norm());
}

TEST(FirstTouch, has_a_share_of_rotation_beyond_its_turn) {
  const Falling fall;
  const contact::FirstTouch touch = fall.touch();
  const auto part = accuracy::around_first_touch(touch, fall.scene, fall.kernels, fall.model);
  StepOptions options = store::step_options(part.scene);
  auto linear =
      contact::impact_quantities(part.model, options, contact::step_count(part.scene.time.duration, rate))
          .value();
  const auto share = [&] {
    return accuracy::share_of_rotation(part, linear, Hertz{rate}, {}).value().at(Quantity::impulse);
  };
  EXPECT_EQ(share(), 0);
  linear.figures[Quantity::impulse].value *= 1.2;
  linear.figures[Quantity::impulse].scale *= 1.2;
  EXPECT_NEAR(share(), 1 - 1 / 1.2 - touch.turned, 2 * touch.turned);
}

}  // namespace around_first_touch_test
