// SPDX-License-Identifier: BSD-2-Clause
// Placements that are kept between runs, compared with newly computed ones, and the scene that they are made
// of.
#include <gtest/gtest.h>

#include <algorithm>

#include "src/scene/scene.hpp"
#include "src/store/stored_kernels.hpp"
#include "tests/contact/plate.hpp"

namespace placement_store_test {

using namespace ricochet;
using contact::test::cap;
using store::KernelPointers;

scene::Scene scene_of(double height) {
  scene::Scene out;
  out.bodies.resize(2);
  out.bodies[0].name = "a";
  out.bodies[1].name = "b";
  out.bodies[1].rotate_deg = {180, 0, 0};
  out.bodies[1].translate = {0, 0, height};
  out.contact.pairs = {{{.a = "a", .b = "b", .gap = 0.01, .reach = 0.2}}};
  return out;
}

TEST(PlacementStore, serves_bodies_in_the_same_positions_and_no_others) {
  const kernels::Kernel a = cap(8, 1, 0.3), b = cap(12, 3, 0.3);
  kernels::Kernel softer = b;
  for (double& omega : softer.modes.angular_frequency) omega /= 2;
  const KernelPointers first{&a, &b}, second{&a, &softer};
  store::PlacementStore store;
  scene::Scene scene = scene_of(4.2);
  const auto expect_as_new = [&] {
    const contact::Placement found = store.place(scene, second), expected = store::place(scene, second);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(found.bodies[k].kernel, second[k]);
      EXPECT_EQ(found.bodies[k].translation, expected.bodies[k].translation);
      EXPECT_EQ(found.bodies[k].velocity, expected.bodies[k].velocity);
    }
    const contact::Pairing &one = found.pairs[0].pairing, &other = expected.pairs[0].pairing;
    EXPECT_EQ(one.unpaired, other.unpaired);
    ASSERT_EQ(one.points.size(), other.points.size());
    for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(one.points[i].gap, other.points[i].gap);
    EXPECT_EQ(found.pairs[0].request, expected.pairs[0].request);
  };
  store.place(scene, first);
  expect_as_new();
  scene.bodies[0].velocity = {0, 0, 1};
  expect_as_new();
  scene.contact.pairs[0].friction = Friction{0.3, 0.3, 0};
  expect_as_new();
  scene.contact.pairs[0].friction = Friction{0.4, 0.4, 0};
  expect_as_new();
  scene.contact.pairs[0].friction.reset();
  expect_as_new();
  scene.bodies[1].translate[2] = 4.3;
  expect_as_new();
  scene.contact.pairs[0].gap = 0.02;
  expect_as_new();
  scene.contact.pairs[0].reach = 0.1;
  expect_as_new();
  scene.bodies[1].translate[2] = 4.2;
  expect_as_new();
  scene.motion.rotation = Rotation::finite;
  expect_as_new();
}

TEST(LibraryScene, has_all_settings_of_the_scene_that_was_read) {
  const kernels::Kernel a = cap(8, 1, 0.3), b = cap(12, 3, 0.3);
  scene::Scene scene = scene_of(4.2);
  scene.bodies[0].velocity = {0, 0, 1};
  scene.bodies[0].arrival = 0.1;
  scene::Obstacle& belt = scene.obstacles.emplace_back();
  belt.name = "belt";
  belt.normal = {0, 0, 1};
  belt.velocity = {1, 0, 0};
  scene.contact.pairs[0].zone = 0.1;
  scene.contact.scheme = Scheme::impulse;
  scene.contact.max_pivots = 3;
  scene.motion.rotation = Rotation::finite;
  scene.time.contact_rate_hz = 1e5;
  scene.loads.gravity = {0, 0, -9.81};
  Scene library = store::library_scene(scene, {&a, &b});
  EXPECT_TRUE(static_cast<ContactScheme&>(library) == scene.contact);
  EXPECT_TRUE(static_cast<Stepping&>(library) == scene.time);
  EXPECT_TRUE(static_cast<RigidBodies&>(library) == scene.motion);
  EXPECT_TRUE(std::ranges::equal(library.obstacles, scene.obstacles));
  EXPECT_TRUE(std::ranges::equal(library.pairs, scene.contact.pairs));
  EXPECT_EQ(library.gravity, scene.loads.gravity);
  ASSERT_EQ(library.bodies.size(), 2U);
  EXPECT_EQ(library.bodies[1].kernel.get(), &b);
  for (Body& body : library.bodies) body.kernel.reset();
  EXPECT_TRUE(std::ranges::equal(library.bodies, scene.bodies));
}

}  // namespace placement_store_test
