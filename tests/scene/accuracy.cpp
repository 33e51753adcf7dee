// SPDX-License-Identifier: BSD-2-Clause
// `accuracy` chooses only settings that a scene leaves open.
#include <gmock/gmock.h>

#include "src/scene/read.hpp"
#include "src/scene/write.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::accuracy_test {

using namespace test;

TEST(Accuracy, leaves_nothing_open_if_it_is_not_requested) {
  const Scene scene = scene_of(smallest);
  EXPECT_FALSE(scene.accuracy);
  EXPECT_FALSE(scene.modes.open());
  EXPECT_FALSE(scene.time.rate_by_accuracy);
  EXPECT_EQ(scene.time.precision, Precision::float64);
}

TEST(Accuracy, is_the_default_if_the_modes_are_open) {
  const Scene scene = scene_of(open_scene);
  EXPECT_EQ(scene.accuracy, 1e-2);
  EXPECT_EQ(scene.accuracy_of, (std::vector{Quantity::impulse, Quantity::rebound}));
  EXPECT_FALSE(scene_of(open_scene, {"accuracy=off", "modes.count=10"}).accuracy);
}

TEST(Accuracy, is_that_of_the_named_quantities) {
  const Scene scene = scene_of(open_scene, {"accuracy_of=[\"spin\", \"peak_force\"]"});
  EXPECT_EQ(scene.accuracy_of, (std::vector{Quantity::spin, Quantity::peak_force}));
}

TEST(Accuracy, chooses_what_is_not_given) {
  for (const char* modes : {"title=x", "modes={}", "modes.residual_flexibility=true"}) {
    const Scene scene = scene_of(open_scene, with_accuracy({modes}));
    EXPECT_EQ(scene.accuracy, 1e-2);
    EXPECT_TRUE(scene.modes.open());
    EXPECT_TRUE(block_of(scene).order_open);
    EXPECT_TRUE(block_of(scene).size_open);
    EXPECT_TRUE(block_of(scene).refine_open);
    EXPECT_FALSE(scene.find_body("ball")->order_open);  // a mesh file
    EXPECT_EQ(scene.modes.basis, Basis::contact);
    EXPECT_FALSE(scene.modes.up_to);
    EXPECT_TRUE(scene.time.rate_by_accuracy);
    EXPECT_TRUE(scene.time.precision_by_accuracy);
  }
}

TEST(Accuracy, chooses_the_samples_only_where_nothing_listens_and_none_are_given) {
  EXPECT_TRUE(scene_of(smallest, with_accuracy()).time.samples_by_accuracy);
  EXPECT_FALSE(scene_of(smallest).time.samples_by_accuracy);
  for (const char* given : {"time.rate_hz=1e3", "time.contact_rate_hz=1e5",
                            "output.receiver=[{name='mic',body='ball',at=[0,0,0]}]"})
    EXPECT_FALSE(scene_of(smallest, with_accuracy({given})).time.samples_by_accuracy) << given;
}

TEST(Accuracy, leaves_what_is_given) {
  const Scene scene = scene_of(smallest, with_accuracy({"time.rate_hz=1e3", "time.contact_rate_hz=2500",
                                                        "time.precision=single", "time.duration=1"}));
  EXPECT_FALSE(scene.modes.open());
  EXPECT_EQ(scene.modes.count, 10);
  EXPECT_EQ(scene.modes.basis, Basis::modes);
  EXPECT_FALSE(scene.time.rate_by_accuracy);
  EXPECT_EQ(scene.time.rate_hz, 1e3);
  EXPECT_EQ(scene.time.steps_per_sample(), 3);  // rounded up
  EXPECT_EQ(scene.time.step(), 1 / 3e3);
  EXPECT_EQ(scene.time.precision, Precision::float32);
}

TEST(Accuracy, is_preserved_by_the_resolved_scene) {
  for (const char* set :
       {"title=x", "time.rate_hz=1e3", "time.contact_rate_hz=2e5", "time.precision=double", "modes.count=3",
        "bodies.block.order=2", "bodies.block.size_factor=0.5", "accuracy_of=energy",
        "bodies.block.refine=[{at=[0,0,1],radius=0.1,size=0.02},{at=[1,0,1],radius=0.2,size=0.01}]"}) {
    const Folder folder;
    const Scene scene = read(folder.write("scene.toml", open_scene), with_accuracy({set}));
    const Scene back = read(folder.write("resolved.toml", to_toml(scene)));
    EXPECT_EQ(back.accuracy, scene.accuracy);
    EXPECT_EQ(back.accuracy_of, scene.accuracy_of);
    EXPECT_EQ(back.modes.open(), scene.modes.open());
    EXPECT_EQ(back.bodies, scene.bodies);
    EXPECT_EQ(back.modes.count, scene.modes.count);
    EXPECT_EQ(back.time.rate_by_accuracy, scene.time.rate_by_accuracy);
    EXPECT_EQ(back.time, scene.time);
    EXPECT_EQ(back.time.precision, scene.time.precision);
  }
}

TEST(BodyOfGivenElements, leaves_no_mesh_open) {
  const Scene order = scene_of(open_scene, {"bodies.block.order=2"}),
              size = scene_of(open_scene, {"bodies.block.geometry={h=0.1}"}),
              local = scene_of(open_scene, {"bodies.block.refine=[{at=[0,0,1],radius=0.1,size=0.02}]"});
  EXPECT_FALSE(block_of(order).order_open);
  EXPECT_FALSE(block_of(order).size_open);
  EXPECT_TRUE(block_of(size).order_open);
  EXPECT_FALSE(block_of(size).size_open);
  EXPECT_FALSE(block_of(size).refine_open);
  EXPECT_TRUE(block_of(local).order_open);
  EXPECT_FALSE(block_of(local).refine_open);
}

// The guard against deeply nested keys counts the dots of a key, not those of its value.
TEST(Refine, takes_many_balls_in_one_line) {
  std::string balls;
  for (int ball = 0; ball < 40; ++ball)
    balls += std::string(ball ? "," : "") + "{at=[0.5,0.5,1.5],radius=0.1,size=0.02}";
  EXPECT_EQ(block_of(scene_of(open_scene, {"bodies.block.refine=[" + balls + "]"})).refine.size(), 40U);
}

}  // namespace ricochet::scene::accuracy_test
