// SPDX-License-Identifier: BSD-2-Clause
// Loads with histories, moving supports and receivers: read, refused, written, and in kernel requests.
#include <gmock/gmock.h>

#include "src/scene/read.hpp"
#include "src/scene/request.hpp"
#include "src/scene/write.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::loads_test {

using namespace test;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// A supported ball with loads, a motion of its support and a receiver; at the end, the motion of an obstacle.
const std::string driven = shared_scene("driven"),
                  supported = driven.substr(0, driven.find("[[loads.traction]]")),
                  belt = driven.substr(driven.rfind("[[loads.motion]]")),
                  sources = driven.substr(supported.size(), driven.size() - supported.size() - belt.size());

/// The scene with all of these, read in the folder of its history.
Scene driven_scene(const std::vector<Override>& overrides = {},
                   const std::string& text = supported + sources) {
  const Folder folder;
  folder.write("push.csv", "0, 1\n");
  folder.write("ball.msh", "a mesh");
  return read(folder.write("scene.toml", text), overrides);
}

KernelRequest driven_request(const std::vector<Override>& overrides = {},
                             const std::string& text = supported + sources) {
  const Folder folder;
  folder.write("push.csv", "0, 1\n");
  folder.write("ball.msh", "a mesh");
  const Scene scene = read(folder.write("scene.toml", text), overrides);
  return kernel_request(scene, scene.bodies[0]);
}

TEST(Sources, are_read_and_named_after_their_group_or_number) {
  const Scene scene = driven_scene();
  ASSERT_EQ(scene.loads.tractions.size(), 2U);
  EXPECT_EQ(scene.loads.tractions[0].name, "cap");
  EXPECT_EQ(scene.loads.tractions[0].group, "cap");
  EXPECT_EQ(scene.loads.tractions[0].body, "ball");
  EXPECT_THAT(scene.loads.tractions[0].vector, ElementsAre(0, 0, -2000));
  EXPECT_EQ(scene.loads.tractions[0].history, scene.file.parent_path() / "push.csv");
  EXPECT_EQ(scene.loads.tractions[1].name, "cap again");
  EXPECT_TRUE(scene.loads.tractions[1].history.empty());
  ASSERT_EQ(scene.loads.points.size(), 2U);
  EXPECT_EQ(scene.loads.points[0].name, "point 1");
  EXPECT_THAT(scene.loads.points[0].at, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_EQ(scene.loads.points[1].name, "point 2");
  ASSERT_EQ(scene.loads.motions.size(), 1U);
  EXPECT_EQ(scene.loads.motions[0].name, "foot");
  EXPECT_THAT(scene.loads.motions[0].vector, ElementsAre(1e-3, 0, -2e-3));
  ASSERT_EQ(scene.output.receivers.size(), 1U);
  EXPECT_EQ(scene.output.receivers[0].name, "mic é");
  EXPECT_EQ(scene.output.receivers[0].body, "ball");
  EXPECT_THAT(scene.output.receivers[0].at, ElementsAre(0.4, 0.5, -0.6));
}

TEST(MotionsOfObstacles, are_read_and_preserved_beside_those_of_supports) {
  const Folder folder;
  folder.write("push.csv", "0, 1\n");
  const Scene scene = read(folder.write("scene.toml", supported + sources + belt));
  ASSERT_EQ(scene.loads.motions.size(), 2U);
  const scene::Forcing& motion = scene.loads.motions[1];
  EXPECT_EQ(motion.obstacle, "floor");
  EXPECT_EQ(motion.name, "floor");
  EXPECT_EQ(motion.body, "");
  EXPECT_EQ(motion.group, "");
  EXPECT_THAT(motion.vector, ElementsAre(0, 0.5, 0));
  EXPECT_EQ(motion.history, folder.path() / "push.csv");
  EXPECT_EQ(read(folder.write("resolved.toml", to_toml(scene))).loads, scene.loads);
}

TEST(MotionsOfObstacles, do_not_change_kernels) {
  EXPECT_EQ(driven_request({}, supported + sources + belt).hash, driven_request().hash);
}

// A support holds components along the axes of the mesh and moves along those of the world: x of the body is
// y of the world.
TEST(Motions, of_a_rotated_body_are_along_the_components_of_its_support) {
  EXPECT_NO_THROW(driven_scene({"bodies.ball.rotate_deg=[0,0,90]", "loads.motion[0].vector=[0,1,-1]"}));
}

void expect_same(const std::vector<Forcing>& a, const std::vector<Forcing>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].name, b[k].name);
    EXPECT_EQ(a[k].body, b[k].body);
    EXPECT_EQ(a[k].group, b[k].group);
    EXPECT_EQ(a[k].at, b[k].at);
    EXPECT_EQ(a[k].vector, b[k].vector);
    EXPECT_EQ(a[k].history, b[k].history);
  }
}

TEST(Sources, are_preserved_by_the_resolved_scene) {
  const Folder folder;
  folder.write("push.csv", "0, 1\n");
  const Scene scene = read(folder.write("scene.toml", supported + sources));
  EXPECT_THAT(to_toml(scene), HasSubstr("history = \"push.csv\"\n"));
  const Scene back = read(folder.write("resolved.toml", to_toml(scene)));
  expect_same(back.loads.tractions, scene.loads.tractions);
  expect_same(back.loads.points, scene.loads.points);
  expect_same(back.loads.motions, scene.loads.motions);
  ASSERT_EQ(back.output.receivers.size(), 1U);
  EXPECT_EQ(back.output.receivers[0].name, "mic é");
  EXPECT_EQ(back.output.receivers[0].body, "ball");
  EXPECT_EQ(back.output.receivers[0].at, scene.output.receivers[0].at);
}

TEST(KernelHash, does_not_depend_on_sources_if_there_are_none) {
  EXPECT_THAT(driven_request({}, supported).toml, Not(HasSubstr("loads")));
  const std::string elsewhere = changed(supported, "[obstacles.floor]", R"([bodies.plate]
mesh = "ball.msh"
material = { density = 1000, young = 1e9 }
contact = "skin"

[[loads.point]]
body = "plate"
at = [0, 0, 0]
vector = [0, 0, 1]

[[contact.pair]]
between = ["ball", "plate"]

[obstacles.floor])");
  EXPECT_EQ(driven_request({}, changed(elsewhere, "between = [\"ball\", \"floor\"]", "")).hash,
            driven_request({}, supported).hash);
}

TEST(KernelHash, depends_on_positions_of_sources_but_not_on_their_values) {
  const std::string hash = driven_request().hash;
  EXPECT_NE(driven_request({}, supported).hash, hash);
  for (const char* set :
       {"loads.traction[0].group=rim", "loads.traction[1].name=other", "loads.point[0].at=[0,0,1]",
        "output.receiver[0].at=[0,0,0]", "output.receiver[0].name=ear"})
    EXPECT_NE(driven_request({set}).hash, hash) << set;
  for (const char* set :
       {"loads.traction[0].vector=[1,1,1]", "loads.traction[1].history=push.csv",
        "loads.point[0].vector=[1,1,1]", "loads.motion[0].vector=[1,0,0]", "loads.motion[0].name=shaker"})
    EXPECT_EQ(driven_request({set}).hash, hash) << set;
}

TEST(Pressure, takes_the_place_of_the_vector_and_is_preserved) {
  const auto pressed = [](const std::string& line) {
    return changed(supported + sources, "vector = [0, 0, -2e3]", line);
  };
  const Scene scene = driven_scene({}, pressed("pressure = 2000"));
  EXPECT_EQ(scene.loads.tractions[0].pressure, 2000);
  const std::string text = to_toml(scene);
  EXPECT_THAT(text, HasSubstr("pressure = 2000"));
  EXPECT_EQ(driven_scene({}, text).loads.tractions[0].pressure, 2000);
  const std::string hash = driven_request({}, pressed("pressure = 2000")).hash;
  EXPECT_NE(hash, driven_request().hash);
  EXPECT_EQ(hash, driven_request({}, pressed("pressure = -1")).hash);
  EXPECT_THAT(complaint_of([&] { driven_scene({}, pressed("")); }),
              HasSubstr("vector: is missing: give [x, y, z] in Pa, world axes, or a pressure in Pa"));
  for (const char* key : {"vector = [0, 0, 1]", "axes = \"body\""})
    EXPECT_THAT(complaint_of([&] { driven_scene({}, pressed(std::string("pressure = 1\n") + key)); }),
                HasSubstr(": has no effect on a pressure"));
}

TEST(KernelRequests, hold_a_support_once_for_any_number_of_histories) {
  const std::string again =
      "[[loads.motion]]\nbody = \"ball\"\ngroup = \"foot\"\nname = \"again\"\nvector = [0, 0, 1]\n";
  const KernelRequest request = driven_request({}, supported + sources + again);
  ASSERT_EQ(request.loads.motions.size(), 1U);
  EXPECT_EQ(request.loads.motions[0].name, "foot");
  EXPECT_EQ(request.hash, driven_request().hash);
}

// After rotations by 90 degrees about x and then z, the x, y, z axes of the
// body are the y, z, x axes of the world.
TEST(KernelRequests, hold_positions_in_the_frame_of_the_body) {
  const KernelRequest request =
      driven_request({"bodies.ball.rotate_deg=[90,0,90]", "bodies.ball.translate=[1,2,3]",
                      "loads.motion[0].vector=[0,1,0]"});
  ASSERT_EQ(request.loads.points.size(), 2U);
  EXPECT_THAT(request.loads.points[0].at,
              ElementsAre(DoubleNear(-1.8, 1e-12), DoubleNear(-2.7, 1e-12), DoubleNear(-0.9, 1e-12)));
  EXPECT_THAT(request.loads.points[0].vector, ElementsAre(0, 0, 0));
  EXPECT_TRUE(request.loads.tractions.at(0).history.empty());
  ASSERT_EQ(request.receivers.size(), 1U);
  EXPECT_THAT(request.receivers[0].at,
              ElementsAre(DoubleNear(-1.5, 1e-12), DoubleNear(-3.6, 1e-12), DoubleNear(-0.6, 1e-12)));
}

// The places of the last test, in the axes of the body.
const std::string own_places =
    changed(changed(sources, "at = [0.1, 0.2, 0.3]", "at_body = [-1.8, -2.7, -0.9]"), "at = [0.4, 0.5, -0.6]",
            "at_body = [-1.5, -3.6, -0.6]");
// The motion of a support is along the axes of the world.
const std::vector<Override> placed{"bodies.ball.rotate_deg=[90,0,90]", "bodies.ball.translate=[1,2,3]",
                                   "loads.motion[0].vector=[0,1,0]", "loads.point[1].vector=[0,0,1]"};

TEST(KernelHash, is_that_of_the_place_in_whichever_axes_it_is_given) {
  EXPECT_EQ(driven_request(placed, supported + own_places).hash, driven_request(placed).hash);
}

TEST(KernelHash, of_places_in_axes_of_the_body_does_not_depend_on_the_placement) {
  const std::string text = changed(supported + own_places, "at = [0, 0, 0.3]", "at_body = [0, 0, 0.3]");
  EXPECT_EQ(driven_request(placed, text).hash,
            driven_request({"bodies.ball.rotate_deg=[0,20,0]", "loads.motion[0].vector=[0,0,0]"}, text).hash);
}

TEST(Sources, keep_the_axes_of_their_places_in_the_resolved_scene) {
  const Scene scene = driven_scene({}, supported + own_places);
  const std::string text = to_toml(scene);
  EXPECT_THAT(text, HasSubstr("at_body = [-1.8, -2.7, -0.9]\n"));
  EXPECT_THAT(text, HasSubstr("at = [0.0, 0.0, 0.3]\n"));
  EXPECT_THAT(text, HasSubstr("at_body = [-1.5, -3.6, -0.6]\n"));
  const Scene back = driven_scene({}, text);
  EXPECT_EQ(back.loads.points, scene.loads.points);
  EXPECT_EQ(back.output.receivers, scene.output.receivers);
}

// A gauge with its place and direction in the axes of the world, as in
// hold_positions_in_the_frame_of_the_body.
const std::string gauged = supported + sources +
                           "[[output.gauge]]\nname = \"foil\"\nbody = \"ball\"\nat = [0.4, 0.5, -0.6]\n"
                           "direction = [0, 3, 4]\nlength = 0.01\n";

TEST(Gauges, are_read_and_preserved_by_the_resolved_scene) {
  const Scene scene = driven_scene({}, gauged), back = driven_scene({}, to_toml(scene));
  ASSERT_EQ(scene.output.gauges.size(), 1U);
  EXPECT_EQ(scene.output.gauges[0].name, "foil");
  EXPECT_THAT(scene.output.gauges[0].at, ElementsAre(0.4, 0.5, -0.6));
  EXPECT_THAT(*scene.output.gauges[0].direction,
              ElementsAre(0, DoubleNear(0.6, 1e-15), DoubleNear(0.8, 1e-15)));
  EXPECT_EQ(scene.output.gauges[0].length, 0.01);
  EXPECT_EQ(back.output.gauges, scene.output.gauges);
  EXPECT_FALSE(scene.time.samples_by_accuracy);
}

TEST(Gauges, are_refused_with_a_remedy) {
  const auto said = [](const Override& set) {
    return ricochet::test::complaint_of([&] { driven_scene({set}, gauged); });
  };
  EXPECT_THAT(said("output.gauge[0].name=time"), HasSubstr("is that of the times in the result"));
  EXPECT_THAT(said("output.gauge[0].body=disk"), HasSubstr("ball"));
  EXPECT_THAT(said("output.gauge=[{name='foil',body='ball',at=[0,0,0],length=0.01}]"),
              HasSubstr("belongs to a gauge with a direction: add it, or leave this key out"));
  EXPECT_THAT(said("output.gauge=[{name='a',body='ball',at=[0,0,0]},{name='a',body='ball',at=[0,0,0]}]"),
              HasSubstr("another gauge has this name: give each its own"));
  EXPECT_THAT(said("output.gauge=[{name='a',body='ball'}]"), HasSubstr("the point of the body"));
}

TEST(KernelHash, depends_on_gauges_in_the_axes_of_the_body) {
  const auto hash = [](const std::vector<Override>& sets) {
    std::vector<Override> all = placed;
    all.insert(all.end(), sets.begin(), sets.end());
    return driven_request(all, gauged).hash;
  };
  const std::string own = "output.gauge=[{name='foil',body='ball',at_body=[-1.5,-3.6,-0.6],length=0.01,";
  EXPECT_EQ(hash({own + "direction=[3,4,0]}]"}), hash({}));
  EXPECT_EQ(hash({own + "direction=[-3,-4,0]}]"}), hash({}));
  EXPECT_NE(hash({own + "direction=[0,3,4]}]"}), hash({}));
  for (const char* set : {"output.gauge[0].length=0.02", "output.gauge[0].at=[0,0,0]", "output.gauge=[]"})
    EXPECT_NE(hash({set}), hash({})) << set;
  EXPECT_EQ(hash({"output.gauge=[]"}), driven_request(placed).hash);
}

}  // namespace ricochet::scene::loads_test
