// SPDX-License-Identifier: BSD-2-Clause
// Clouds that turn by any angle and meet each other, and a floor.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/contact/cloud.hpp"

namespace ricochet::contact::test {

struct Meeting {
  std::vector<const Cloud*> clouds;
  std::vector<PlacedBody> bodies;
  std::optional<Friction> friction{};
  Vector3d gravity{0, 0, 0};
  bool floor = false;
  bool turns = true;
};

inline std::shared_ptr<Model> meet(const Meeting& scene) {
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
    pair.everywhere = scene.turns;
  }
  return std::make_shared<Model>(build_model(
      bodies, {{.name = "floor", .point = {0, 0, 0}, .normal = Vector3d::UnitZ()}}, pairs, scene.gravity));
}

inline Vector3d momentum(const Meeting& scene, const Stepper& stepper) {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < scene.clouds.size(); ++k)
    out += scene.clouds[k]->mass * stepper.poses()[k].velocity;
  return out;
}

inline Vector3d angular_momentum(const Meeting& scene, const Stepper& stepper) {
  Vector3d out = Vector3d::Zero();
  for (std::size_t k = 0; k < scene.clouds.size(); ++k) {
    const Pose& pose = stepper.poses()[k];
    const Matrix3d A = pose.attitude.toRotationMatrix();
    out += A * scene.clouds[k]->inertia * A.transpose() * pose.spin +
           scene.clouds[k]->mass * pose.position.cross(pose.velocity);
  }
  return out;
}

}  // namespace ricochet::contact::test
