// SPDX-License-Identifier: BSD-2-Clause
// Which rotation a scene has that does not give it.
#include <gmock/gmock.h>

#include "src/scene/read.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::motion_test {

using namespace test;
using ::testing::HasSubstr;

/// The motion of a ball over a floor for 0.01 s.
Motion motion_of(const std::vector<Override>& set, const std::string& text = smallest) {
  return scene_of(text, set).motion;
}

// 1° in 0.01 s is 1.7453 rad/s.
TEST(Rotation, is_finite_by_itself_if_a_free_body_spins_by_more_than_a_degree) {
  EXPECT_TRUE(motion_of({"bodies.ball.angular_velocity=[1.2,0.9,0.9]"}).is_finite());
  EXPECT_FALSE(motion_of({"bodies.ball.angular_velocity=[1.2,0.9,0.8]"}).is_finite());
  EXPECT_FALSE(
      motion_of({"bodies.ball.angular_velocity=[1.2,0.9,0.9]", "motion.rotation=linear"}).is_finite());
}

TEST(Rotation, is_finite_by_itself_if_linear_ones_do_not_serve_the_scene) {
  const std::string point = "loads.point=[{body=\"ball\",at=[0,0,1],vector=[0,0,1]";
  EXPECT_TRUE(motion_of({"contact.between=all"}).is_finite());
  EXPECT_TRUE(motion_of({point + ",axes=\"body\"}]"}).is_finite());
  EXPECT_FALSE(motion_of({point + "}]"}).is_finite());
}

TEST(Rotation, is_the_same_whether_given_or_not) {
  for (const char* set : {"contact.between=all", "bodies.ball.angular_velocity=[0,9,0]"}) {
    const Folder folder;
    const auto file = folder.write("scene.toml", smallest);
    EXPECT_EQ(read(file, {set}), read(file, {set, "motion.rotation=finite"})) << set;
  }
}

TEST(Rotation, is_open_unless_something_decides_it) {
  const auto expect_open = [](bool open, const std::vector<Override>& set,
                              const std::string& text = smallest) {
    const Motion motion = motion_of(set, text);
    EXPECT_FALSE(motion.is_finite()) << set.back();
    EXPECT_EQ(motion.rotation_open, open) << set.back();
  };
  const std::string spin = "bodies.ball.angular_velocity=[0,0,100]",
                    whole = "bodies.ball.support={skin=\"xyz\"}";
  expect_open(true, {"title=scene"});
  expect_open(true, {"accuracy=1e-2"});
  expect_open(false, {"motion.rotation=linear"});
  for (const char* key : {"contact.reach=0.1", "contact.zone=0.1", "contact.along=[1,0,0]",
                          "contact.scheme=impulse", "contact.kernel=table", "time.precision=single",
                          "bodies.ball.material.area=1e-4", "bodies.ball.damping={rayleigh=[1,0]}"})
    expect_open(false, {spin, key});
  expect_open(true, {"bodies.ball.damping={rayleigh=[0,1e-6]}"});
  expect_open(false, {whole});  // nothing may turn
  // What supports hold in part, their meshes tell.
  expect_open(false, {"bodies.ball.support={skin=\"xy\"}"});
  expect_open(
      false, {spin},
      changed(changed(smallest, "ball.msh", "ball.h5"), "material = { density = 1000, young = 1e9 }", ""));
  const std::string load = "loads.point=[{body=\"ball\",at=[0,0,1],vector=[0,0,1]}]";
  expect_open(true, {load});
  expect_open(true, {"accuracy=1e-2", load});
}

// Points do not stay over an obstacle that turns or shifts; along a half-space they do.
TEST(Rotation, is_finite_over_obstacles_that_move) {
  const std::string box = "obstacles.floor={shape=\"box\",size=[1,1,1]",
                    spins = box + ",angular_velocity=[0,0,1]}", shifts = box + ",velocity=[0,0,1]}";
  EXPECT_TRUE(motion_of({spins}, smallest).is_finite());
  EXPECT_TRUE(motion_of({shifts}, smallest).is_finite());
  EXPECT_FALSE(motion_of({shifts, "motion.rotation=linear"}, smallest).is_finite());
  EXPECT_FALSE(motion_of({shifts, "contact.reach=0.1"}, smallest).is_finite());
  EXPECT_FALSE(motion_of({"obstacles.floor.velocity=[0,0,1]"}, smallest).is_finite());
  EXPECT_THAT(complaint_of([&] {
                motion_of({spins, "motion.rotation=linear"}, smallest);
              }),
              HasSubstr("needs motion.rotation = \"finite\": set it, or leave angular_velocity out"));
}

// A clamped body holds no free one.
TEST(Rotation, is_open_if_any_body_is_free) {
  const std::string block =
      "[bodies.block]\nmesh = \"block.msh\"\nmaterial = { density = 1, young = 1 }\ncontact = \"top\"\n"
      "support = { foot = \"xyz\" }\n";
  const std::string two =
      changed(changed(smallest, "[obstacles.floor]\nnormal = [0, 0, 1]", block), "\"floor\"", "\"block\"");
  EXPECT_TRUE(motion_of({"title=scene"}, two).rotation_open);
  EXPECT_FALSE(motion_of({"bodies.ball.support={skin=\"xyz\"}"}, two).rotation_open);
  EXPECT_FALSE(motion_of({"bodies.block.support={foot=\"z\"}"}, two).rotation_open);
}

TEST(Rotation, which_is_finite_leaves_no_precision_open) {
  EXPECT_TRUE(scene_of(smallest, {"accuracy=1e-2"}).time.precision_by_accuracy);
  EXPECT_FALSE(scene_of(smallest, {"accuracy=1e-2", "contact.between=all"}).time.precision_by_accuracy);
}

// Kernels alone do not know how long the impact lasts.
TEST(Rotation, of_a_scene_without_duration_is_finite_for_any_spin) {
  const std::string kernels = changed(changed(smallest, "[time]\n", ""), "duration = 0.01\n", "");
  const auto finite = [&](const std::string& set) {
    const Folder folder;
    return read(folder.write("scene.toml", kernels), {set}, Purpose::kernels).motion.is_finite();
  };
  EXPECT_TRUE(finite("bodies.ball.angular_velocity=[0,0,1e-6]"));
  EXPECT_FALSE(finite("title=scene"));
}

}  // namespace ricochet::scene::motion_test
