// SPDX-License-Identifier: BSD-2-Clause
// The resolved scene, as --dry-run prints it, is a scene itself: reading it gives the same scene.
#include "src/scene/write.hpp"
#include "src/scene/read.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/scene/scenes.hpp"

namespace ricochet::scene::write_test {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_same(const Scene& a, Scene b) {
  b.file = a.file;
  EXPECT_EQ(to_toml(a), to_toml(b));
  EXPECT_TRUE(a == b);
}

/// Writes the scene and reads it back from a file in the same folder.
void expect_to_come_back(const std::string& text, const std::vector<Override>& overrides = {}) {
  const Folder folder;
  const Scene scene = read(folder.write("scene.toml", text), overrides);
  expect_same(read(folder.write("resolved.toml", to_toml(scene))), scene);
}

TEST(Resolved, scene_reads_back_unchanged) {
  expect_to_come_back(smallest);
  expect_to_come_back(fullest);
  for (const char* solver : {"exact", "uzawa"})
    expect_to_come_back(changed(smallest, "[time]\nduration = 0.01", ""),
                        {"contact.scheme=static", std::string("contact.solver=") + solver});
  for (const char* file : {"/meshes/two-disks/two-disks.toml", "/meshes/two-rods/two-rods.toml",
                           "/meshes/hertz/resting-ball.toml", "/meshes/hertz/two-balls.toml"}) {
    const Scene scene = read(std::string(RICOCHET_SOURCE) + file);
    const Folder folder;
    const std::string text = to_toml(scene);
    Scene back = read(folder.write("resolved.toml", text));
    for (Body& body : back.bodies)  // a mesh is named relative to the folder of its scene
      body.mesh = scene.file.parent_path() / body.mesh.lexically_relative(folder.path());
    expect_same(back, scene);
  }
}

// Strings of all kinds, and numbers that need all of their digits or have no decimals.
TEST(Resolved, scene_with_each_form_of_a_value_reads_back) {
  const std::string mic = "output.receiver=[{name=\"mic\",body=\"ball\",at=[0,0,1]}]";
  const std::vector<std::vector<Override>> forms{
      {"contact.kernel=table"},
      {R"(title="back\\slash \"quote\" tab\t line\n bell\u0007 delete\u007F é")"},
      {"title="},
      {R"(bodies.ball.contact=["a \"b\"", "c.d"])"},
      {R"(bodies.ball.support={ "a b" = "x", "c.d" = "yz" })"},
      {"bodies.ball.velocity=[0.1,-1e30,3.0000000000000004]"},
      {"bodies.ball.material={ density = 1, young = [0.3, 0.2, 0.1], shear = [0.1, 0.1, 0.1], poisson = "
       "[0.1, -0.3, 1.1], "
       "axes = [[0.3, 0.4, 0.001], [-0.4, 0.3, 0.7e-17]] }"},
      {"bodies.ball.material={ like = \"sitka spruce\", about = { point = [0.1, 0, 0], direction = [1, 2, "
       "0.3] } }"},
      {"bodies.ball.material={ steel = \"steel\", wood = { density = 1, "
       "stiffness = [3, 0, 0, 0, 0.1, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1] } }"},
      {"bodies.ball.material={ \"all of it\" = { density = 1, young = 2 } }"},
      {"time.rate_hz=1e20", "time.duration=1e-15", "time.precision=single"},
      {R"(time={duration="until parted",longest=0.25})"},
      {mic},
      {mic, "output.receivers_rate_hz=11025"},
      {mic, "output.sound={receivers=\"mic\",direction=[1,2,3]}"},
      {mic,
       R"(output.sound={receivers=["mic","mic"],direction=[1,0,0],high_pass_hz=0,fade=0.5,format="float"})"},
      {"contact.between=[\"floor\",\"ball\"]", "contact.direction=[1,2,3]"},
      {"motion.rotation=finite"},
      {"contact.friction=0.3"},
      {"contact.friction=0"},
      {"contact.friction=0.3", "contact.scheme=static", "contact.increments=7"},
      {"contact.friction={static=0.3,dynamic=0.3,stribeck_velocity=0.1}"},
      {"contact.friction={static=0.4,dynamic=0.1,stribeck_velocity=0.01}",
       "obstacles.floor.velocity=[0.5,-1,0]"},
      {"obstacles.floor={shape=\"sphere\",radius=0.1,side=\"inside\",point=[0,0,0.1]}"},
      {"obstacles.floor={shape=\"cone\",radius=0.1,length=0.2,rotate_deg=[0,90,0]}"},
      {"obstacles.floor={shape=\"torus\",radius=0.1,radius_small=0.02}"},
      {"obstacles.floor={shape=\"box\",size=[0.1,0.2,0.3]}"},
      {"obstacles.floor={surface=\"anvil.stl\",scale=1e-3}"}};
  for (const auto& form : forms) expect_to_come_back(smallest, form);
  for (const char* law :
       {"{}", "{ratio=0.1}", "{loss_factor=0.002}", "{rayleigh=[3,1e-7]}", "{viscosity=1e-6}",
        "{t60=[[20,3]]}", "{t60=[[100,2],[1000,0.8]]}", "{by_mode=[1e-3,0,2e-3]}"})
    expect_to_come_back(smallest, {std::string("bodies.ball.damping=") + law});
  const std::string basis = "basis=\"contact\",up_to_hz=1e3";
  for (const std::string& modes :
       {std::string("up_to_hz=1e3"), std::string("count=9"),
        std::string("up_to_hz=1e3,flexibility_error=0.012"), basis, basis + ",flexibility_error=1e-6",
        basis + ",count=12", basis + ",residual_flexibility=false"})
    expect_to_come_back(smallest, {"modes={" + modes + "}"});
  expect_to_come_back(tabular);
  expect_to_come_back(tabular, {"contact.scheme=impulse", "contact.admittance=difference", "output.every=3"});
  expect_to_come_back(
      changed(changed(smallest, "ball.msh", "ball.h5"), "material = { density = 1000, young = 1e9 }", ""));
  const std::string impulses =
      "scheme = \"impulse\"\nadmittance = \"difference\"\ninstant = \"exact\"\nrestitution = 0.25\n";
  expect_to_come_back(changed(changed(fullest, impulses, "friction = 0.7\n"), "reach = 0.02\n",
                              "reach = 0.02\nfriction = 0\n"));
}

TEST(Resolved, scene_holds_the_rotation_unless_it_is_open) {
  for (const char* open : {"title=scene", "motion={}", "contact.scheme=impulse", "contact.kernel=table"})
    EXPECT_THAT(to_toml(scene_of(smallest, {open})), Not(HasSubstr("motion"))) << open;
  const auto expect = [](const char* rotation, const std::string& set) {
    EXPECT_THAT(to_toml(scene_of(smallest, {set})),
                HasSubstr(fmt::format("\n[motion]\nrotation = \"{}\"\n\n[time]\n", rotation)));
  };
  expect("finite", "motion.rotation=finite");
  expect("finite", "contact.between=all");
  expect("linear", "motion.rotation=linear");
  expect("linear", "contact.reach=0.1");
}

TEST(AComment, says_how_bodies_turn_and_why) {
  const auto about = [](const std::string& set) { return about_rotation(scene_of(smallest, {set})); };
  EXPECT_EQ(about("motion.rotation=finite"), "");
  EXPECT_EQ(about("motion.rotation=linear"), "");
  EXPECT_EQ(about("contact.reach=0.1"),
            "# motion.rotation is \"linear\": contact.reach excludes \"finite\".\n");
  EXPECT_EQ(about("contact.between=all"), "# motion.rotation is \"finite\": contact.between needs it.\n");
  // 2 rad/s over 0.01 s
  EXPECT_EQ(about("bodies.ball.angular_velocity=[0,0,-2]"),
            "# motion.rotation is \"finite\": bodies.ball spins by 1.15 degrees.\n");
  EXPECT_THAT(about("title=scene"), HasSubstr("\"linear\", or \"finite\" if"));
}

// A unit vector may be slightly longer than 1. Normalising it again would change it.
TEST(Resolved, directions_do_not_drift) {
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y) {
      const std::string vector = fmt::format("[{},{},7]", x, y);
      SCOPED_TRACE(vector);
      expect_to_come_back(smallest, {"contact.direction=" + vector, "obstacles.floor.normal=" + vector});
    }
}

TEST(Resolved, scene_holds_every_default) {
  const std::string text = to_toml(scene_of(smallest));
  for (const char* line : {"title = \"scene\"\n",
                           "mesh = \"ball.msh\"\n",
                           "geometry = { }\n",
                           "order = 3\n",
                           "scale = 1.0\n",
                           "material = { density = 1000.0, young = 1000000000.0, poisson = 0.0 }\n",
                           "damping = {}\n",
                           "contact = [\"skin\"]\n",
                           "support = { }\n",
                           "translate = [0.0, 0.0, 0.0]\n",
                           "rotate_deg = [0.0, 0.0, 0.0]\n",
                           "\nvelocity = [0.0, 0.0, 0.0]\n",
                           "angular_velocity = [0.0, 0.0, 0.0]\n",
                           "point = [0.0, 0.0, 0.0]\n",
                           "normal = [0.0, 0.0, 1.0]\nvelocity = [0.0, 0.0, 0.0]\n",
                           "basis = \"modes\"\n",
                           "residual_flexibility = true\n",
                           "relative_residual = 1e-08\n",
                           "scheme = \"compliant\"\n",
                           "rate_hz = 44100.0\n",
                           "gravity = [0.0, 0.0, 0.0]\n",
                           "every = 1\n",
                           "view = false\n",
                           "snapshot_every = 0\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(Resolved, scene_holds_the_flexibility_error_of_contact_adapted_bases) {
  EXPECT_THAT(to_toml(scene_of(smallest, {"modes={ basis = \"contact\", up_to_hz = 1e3 }"})),
              HasSubstr("[modes]\nbasis = \"contact\"\nup_to_hz = 1000.0\nflexibility_error = 0.001\n"));
}

// For any working folder, a mesh is named relative to the folder of its scene.
TEST(Resolved, scene_names_meshes_from_its_folder) {
  Scene scene = scene_of(smallest);
  const std::tuple<const char*, const char*, const char*> meshes[] = {
      {"scene.toml", "ball.msh", "ball.msh"},
      {"scene.toml", "../shapes/ball.msh", "../shapes/ball.msh"},
      {"here/scene.toml", "here/ball.msh", "ball.msh"},
      {"here/scene.toml", "shapes/ball.msh", "../shapes/ball.msh"},
      {"here/scene.toml", "/far/ball.msh", "/far/ball.msh"},
      {"/far/scene.toml", "/far/ball.msh", "ball.msh"}};
  for (const auto& [file, mesh, name] : meshes) {
    scene.file = file;
    scene.bodies[0].mesh = mesh;
    EXPECT_THAT(to_toml(scene), HasSubstr(std::string("\nmesh = \"") + name + "\"\n"));
  }
}

TEST(Numbers, are_the_shortest_that_read_back_and_always_floats) {
  EXPECT_EQ(toml_number(0.1), "0.1");
  EXPECT_EQ(toml_number(3), "3.0");
  EXPECT_EQ(toml_number(-0.0), "0.0");
  EXPECT_EQ(toml_number(1e-7), "1e-07");
  EXPECT_EQ(toml_number(1e300), "1e+300");
  EXPECT_EQ(toml_number(0.1 + 0.2), "0.30000000000000004");
}

TEST(Slug, is_the_title_as_a_file_name) {
  EXPECT_EQ(slug("Two disks, edge on"), "two-disks-edge-on");
  EXPECT_EQ(slug("Two disks at 6 m/s: part 1.5_b"), "two-disks-at-6-m-s-part-1-5-b");
  // Other characters are dropped, even at the start, and digits of `printf TITLE | sha256sum` follow.
  EXPECT_EQ(slug("  V0 = 6 m/s!  "), "v0-6-m-s-cb3c8b");
  EXPECT_EQ(slug("a--b__c"), "a-b-c-bc3c74");
  EXPECT_EQ(slug("../../etc"), "etc-74ccf3");
  EXPECT_EQ(slug("Étude"), "tude-5bb2b9");
  EXPECT_EQ(slug("!?"), "scene-8faf83");
  EXPECT_EQ(slug("v=1.0"), "v-1-0-19b33d");
  EXPECT_EQ(slug("v=-1.0"), "v-1-0-84dbe6");
  EXPECT_EQ(slug("日本"), "scene-cf2abf");
  EXPECT_EQ(slug("中国"), "scene-f0e952");
  EXPECT_EQ(slug(""), "scene");
}

}  // namespace ricochet::scene::write_test
