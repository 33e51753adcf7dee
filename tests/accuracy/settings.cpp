// SPDX-License-Identifier: BSD-2-Clause
// The settings that are chosen for a scene, as text and as a file. Scenes with the same bodies share them.
#include "src/accuracy/settings.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <random>

#include "src/scene/read.hpp"
#include "tests/scene/scenes.hpp"

namespace settings_test {

using namespace ricochet;
using namespace ricochet::accuracy;
using namespace ricochet::scene::test;
using scene::Basis;
using scene::Override;
using scene::Scene;
using ::testing::HasSubstr;

/// Name of the file with the settings of the scene.
std::string settings_of(const std::vector<Override>& overrides, const std::string& ball = "a ball") {
  const Folder folder;
  folder.write("ball.msh", ball);
  folder.write("block.geo", "a block");
  return settings_path("out", scene::read(folder.write("scene.toml", open_scene), overrides)).string();
}

TEST(Settings, are_shared_by_scenes_with_the_same_bodies_and_accuracy) {
  const std::string path = settings_of(with_accuracy());
  EXPECT_THAT(path, HasSubstr("out/ball-block-"));
  for (const char* same : {"bodies.ball.velocity=[0,0,-1]", "contact.gap=1e-3", "title=x", "time.rate_hz=1e3",
                           "bodies.ball.damping.loss_factor=0.01"})
    EXPECT_EQ(settings_of(with_accuracy({same})), path) << same;
  for (const char* other : {"bodies.ball.material.young=2e9", "bodies.block.order=3", "modes.count=10",
                            "accuracy_of=spin", "contact.reach=1e-3", "accuracy=1e-3", "contact.friction=0.1",
                            "motion.rotation=finite", "motion.rotation=linear"})
    EXPECT_NE(settings_of(with_accuracy({other})), path) << other;
  EXPECT_NE(settings_of(with_accuracy(), "another ball"), path);
  EXPECT_EQ(settings_of(with_accuracy({"settings=own.settings.toml"})), "out/own.settings.toml");
  EXPECT_EQ(settings_of(with_accuracy({"contact.friction=0.1"})),
            settings_of(with_accuracy({"contact.friction={static=0.4,dynamic=0.2,stribeck_velocity=1}"})));
}

Settings some_settings() {
  const KernelSettings found{.mesh = {{"block", {4, 0.5, {{{0, 0.1, -0.2}, 1e-3, 2e-4}}}}},
                             .basis = Basis::contact,
                             .up_to = Hertz{3e3},
                             .flexibility_error = 0.1,
                             .zone = 1e-3};
  return {.found = found, .pilot = true, .elements_before = {{"block", 5e3}}, .rate = Hertz{1e5}};
}

TEST(Settings, are_read_as_written) {
  const Settings settings = some_settings();
  EXPECT_EQ(parse_settings(to_toml(settings)), settings);
  const Folder folder;
  const Scene scene = scene_of(open_scene);
  write_settings(settings, scene, folder.path() / "x.settings.toml");
  EXPECT_EQ(read_settings(folder.path() / "x.settings.toml"), settings);
  EXPECT_FALSE(read_settings(folder.path() / "none.settings.toml"));
  for (const char* damaged : {"", "[found]", "[found]\nbasis = \"contact\"\nup_to_hz = -1.0", "= =",
                              "[found]\nbasis = \"modes\"\nup_to_hz = 1.0\nbodies.a = { order = 2, "
                              "size_factor = 1.0, refine = [{}] }"})
    EXPECT_FALSE(parse_settings(damaged)) << damaged;
}

// Text is how the settings travel between ranks and runs, so a lost entry ends a search. The names in
// brackets are all members: one more does not compile before it is drawn here.
TEST(Settings, survive_text_with_every_member_whatever_its_value) {
  std::mt19937 random(7);
  const auto draw = [&] {
    return std::ldexp(1 + (random() % 1000) / 997.0, static_cast<int>(random() % 40) - 20);
  };
  const auto flip = [&] { return random() % 2 == 0; };
  const auto draw_ball = [&](scene::FineBall& ball) {
    auto& [at, radius, size] = ball;
    at = {draw(), -draw(), 0};
    radius = draw();
    size = draw();
  };
  const auto draw_kernels = [&](KernelSettings& settings) {
    auto& [mesh, basis, up_to, flexibility_error, zone, view, rotation] = settings;
    rotation = flip() ? Rotation::finite : Rotation::linear;
    basis = flip() ? Basis::modes : Basis::contact;
    up_to = Hertz{draw()};
    flexibility_error = draw();
    if (flip()) zone = draw();
    view = flip();
    for (const char* body : {"ball", "a-b_1"}) {
      if (flip()) continue;
      auto& [order, size_factor, refine] = mesh[body];
      order = 1 + static_cast<int>(random() % 10);
      size_factor = draw();
      refine.resize(random() % 3);
      for (scene::FineBall& ball : refine) draw_ball(ball);
    }
  };
  for (int k = 0; k < 200; ++k) {
    Settings settings;
    auto& [found, pilot, elements_before, rate, for_few_candidates, missed_by, error, least_error,
           idle_rounds] = settings;
    draw_kernels(found);
    pilot = flip();
    if (flip()) elements_before["a-b_1"] = draw();
    rate = Hertz{draw()};
    for_few_candidates = static_cast<int>(random() % 5);
    for (double* const value : {&missed_by, &error, &least_error})
      if (flip()) *value = draw();
    idle_rounds = static_cast<int>(random() % 3);
    ASSERT_EQ(parse_settings(to_toml(settings)), settings) << to_toml(settings);
  }
}

TEST(Settings, on_a_full_disk_are_an_error_and_leave_the_earlier_file) {
  const Folder folder;
  const Scene scene = scene_of(open_scene);
  const std::filesystem::path file = folder.write("x.settings.toml", "earlier");
  const auto fill = [&] {  // the limit represents a full disk; only the child process is subject to it
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20, 20};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    complaint_of([&] { write_settings(some_settings(), scene, file); });
    std::exit(testing::Test::HasFailure() ? 1 : 0);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(0), "^$");
  std::ifstream left(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(left), {}), "earlier");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(Settings, replace_only_what_is_open) {
  const Scene open = with_settings(scene_of(open_scene), some_settings().found);
  EXPECT_EQ(block_of(open).order, 4);
  EXPECT_EQ(block_of(open).size_factor, 0.5);
  EXPECT_EQ(block_of(open).refine, some_settings().found.mesh.at("block").refine);
  EXPECT_FALSE(block_of(open).order_open);
  EXPECT_EQ(open.modes.up_to, Hertz{3e3});
  EXPECT_EQ(open.modes.flexibility_error, 0.1);
  EXPECT_EQ(open.contact.pairs[0].zone, 1e-3);
  const Scene given =
      with_settings(scene_of(open_scene, {"modes.count=10", "contact.reach=1"}), some_settings().found);
  EXPECT_FALSE(given.modes.up_to);
  EXPECT_FALSE(given.contact.pairs[0].zone);
}

TEST(Settings, leave_the_visualisation_surface_out_of_kernels_that_nobody_looks_at) {
  Scene scene = scene_of(open_scene);
  scene.output.view = true;
  KernelSettings settings;
  EXPECT_TRUE(with_settings(scene, settings).output.view);
  settings.view = false;
  EXPECT_FALSE(with_settings(scene, settings).output.view);
}

TEST(Settings, decide_a_rotation_that_is_open) {
  KernelSettings linear, finite;
  finite.rotation = Rotation::finite;
  EXPECT_TRUE(with_settings(scene_of(open_scene), finite).motion.is_finite());
  EXPECT_FALSE(with_settings(scene_of(open_scene), linear).motion.is_finite());
  EXPECT_FALSE(with_settings(scene_of(open_scene, {"motion.rotation=linear"}), finite).motion.is_finite());
  EXPECT_TRUE(with_settings(scene_of(open_scene, {"motion.rotation=finite"}), linear).motion.is_finite());
}

}  // namespace settings_test
