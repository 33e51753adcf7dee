// SPDX-License-Identifier: BSD-2-Clause
// Values of a scene reach the program: the default and a given value of each key.
#include <gmock/gmock.h>

#include "src/scene/read.hpp"
#include "src/scene/write.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::read_test {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(SceneDefaults, of_a_body_are_those_documented) {
  const Scene scene = scene_of(smallest);
  ASSERT_EQ(scene.bodies.size(), 1U);
  const Body& body = scene.bodies[0];
  EXPECT_EQ(body.name, "ball");
  EXPECT_THAT(body.geometry, IsEmpty());
  EXPECT_EQ(body.order, 3);
  EXPECT_EQ(body.scale, 1);
  for (const Vector3& vector : {body.translate, body.rotate_deg, body.velocity, body.angular_velocity})
    EXPECT_THAT(vector, ElementsAre(0, 0, 0));
  ASSERT_EQ(body.materials.size(), 1U);
  EXPECT_EQ(body.materials[0].group, "");
  EXPECT_EQ(body.materials[0].poisson, 0);
  EXPECT_EQ(body.materials[0].area, 0);
  EXPECT_EQ(body.damping.law, Damping::Law::none);
  EXPECT_THAT(body.support, IsEmpty());
}

TEST(SceneDefaults, of_everything_else_are_those_documented) {
  const Scene scene = scene_of(smallest);
  EXPECT_EQ(scene.title, "scene");  // the file name without .toml
  ASSERT_EQ(scene.obstacles.size(), 1U);
  EXPECT_THAT(scene.obstacles[0].point, ElementsAre(0, 0, 0));
  EXPECT_EQ(scene.modes.basis, Basis::modes);
  EXPECT_FALSE(scene.modes.up_to);
  EXPECT_EQ(scene.modes.count, 10);
  EXPECT_FALSE(scene.modes.flexibility_error);
  EXPECT_TRUE(scene.modes.residual_flexibility);
  EXPECT_EQ(scene.modes.relative_residual, 1e-8);
  EXPECT_EQ(scene.contact.scheme, Scheme::compliant);
  EXPECT_EQ(scene.contact.max_pivots, Contact{}.max_pivots);
  ASSERT_EQ(scene.contact.pairs.size(), 1U);
  const scene::Pair& pair = scene.contact.pairs[0];
  EXPECT_FALSE(pair.direction || pair.along || pair.spacing || pair.gap || pair.reach);
  EXPECT_EQ(scene.time.rate_hz, 44100);
  EXPECT_EQ(scene.time.duration, 0.01);
  EXPECT_THAT(scene.loads.gravity, ElementsAre(0, 0, 0));
  EXPECT_EQ(scene.output.every, 1);
  EXPECT_FALSE(scene.output.view);
  EXPECT_EQ(scene.output.snapshot_every, 0);
  EXPECT_EQ(scene.output.vtk_every, 0);
}

TEST(SceneDefaults, of_a_run_until_bodies_part_are_a_second_at_most) {
  EXPECT_FALSE(scene_of(smallest).time.until_parted);
  const scene::Time time = scene_of(smallest, {R"(time.duration="until parted")"}).time;
  EXPECT_TRUE(time.until_parted);
  EXPECT_EQ(time.duration, 1);
  EXPECT_EQ(scene_of(smallest, {R"(time={duration="until parted",longest=0.25})"}).time.duration, 0.25);
}

TEST(SceneDefaults, of_the_impulse_scheme_are_the_jump_and_no_rebound) {
  const Contact contact = scene_of(changed(smallest, "[contact]", "[contact]\nscheme = \"impulse\"")).contact;
  EXPECT_EQ(contact.scheme, Scheme::impulse);
  EXPECT_EQ(contact.admittance, Admittance::jump);
  EXPECT_EQ(contact.instant, Instant::step);
  EXPECT_EQ(contact.restitution, 0);
}

TEST(SceneDefaults, of_equilibrium_are_the_exact_solver_and_no_time) {
  const std::string at_rest = changed(changed(smallest, "[contact]", "[contact]\nscheme = \"static\""),
                                      "[time]\nduration = 0.01", "");
  EXPECT_EQ(scene_of(at_rest).contact.scheme, Scheme::at_rest);
  EXPECT_EQ(scene_of(at_rest).contact.solver, Solver::exact);
  EXPECT_EQ(scene_of(at_rest).time.duration, 0);
  EXPECT_EQ(scene_of(at_rest, {"contact.solver=uzawa"}).contact.solver, Solver::uzawa);
}

TEST(SceneDefaults, of_contact_adapted_bases_are_a_flexibility_error_of_a_thousandth) {
  const Modes modes = scene_of(smallest, {"modes={ basis = \"contact\", up_to_hz = 2e3 }"}).modes;
  EXPECT_EQ(modes.basis, Basis::contact);
  ASSERT_TRUE(modes.up_to);
  EXPECT_EQ(modes.up_to->value, 2000);
  EXPECT_FALSE(modes.count);
  EXPECT_EQ(modes.flexibility_error, 1e-3);
  EXPECT_TRUE(modes.residual_flexibility);
}

TEST(SceneValues, of_a_body_are_read) {
  const Scene scene = scene_of(fullest);
  ASSERT_NE(scene.find_body("ball"), nullptr);
  const Body& ball = *scene.find_body("ball");
  EXPECT_THAT(ball.geometry, ElementsAre(Pair("number of turns", 2), Pair("size", 0.004)));
  EXPECT_EQ(ball.order, 2);
  EXPECT_EQ(ball.scale, 0.001);
  EXPECT_THAT(ball.translate, ElementsAre(0, 0.11, -2));
  EXPECT_THAT(ball.rotate_deg, ElementsAre(90, 0.5, -45));
  EXPECT_THAT(ball.velocity, ElementsAre(0, -1.5, 3));
  EXPECT_THAT(ball.angular_velocity, ElementsAre(1, 0, -20.5));
  ASSERT_EQ(ball.materials.size(), 1U);
  EXPECT_EQ(ball.materials[0].density, 11300);
  EXPECT_EQ(ball.materials[0].young, 10400000);
  EXPECT_EQ(ball.materials[0].poisson, 0.37);
  EXPECT_THAT(ball.contact, ElementsAre("rim", "cap"));
  EXPECT_THAT(ball.support, ElementsAre(Pair("clamp", "xyz"), Pair("symmetry plane", "x")));
}

TEST(SceneValues, of_a_rod_hold_its_cross_section) {
  const Scene scene = scene_of(changed(smallest, "young = 1e9", "young = 1e9, area = 2e-4"));
  EXPECT_EQ(scene.bodies[0].materials[0].area, 2e-4);
}

TEST(SceneValues, of_materials_by_physical_volume_are_read) {
  const Scene scene = scene_of(fullest);
  const std::vector<Material>& materials = scene.find_body("block")->materials;
  ASSERT_EQ(materials.size(), 2U);
  EXPECT_EQ(materials[0].group, "cork");
  EXPECT_EQ(materials[0].density, 240);
  EXPECT_EQ(materials[1].group, "steel");
  EXPECT_EQ(materials[1].density, 7800);
  EXPECT_EQ(materials[1].poisson, 0.3);
}

/// The materials of the smallest scene with this one.
std::vector<Material> with_material(const std::string& text, const std::vector<Override>& overrides = {}) {
  return scene_of(changed(smallest, "{ density = 1000, young = 1e9 }", text), overrides).bodies[0].materials;
}

// EN 1993-1-1
TEST(Materials, by_name_have_its_values) {
  const Material steel{
      .group = "", .density = 7850, .young = 210e9, .poisson = 0.3, .area = 0, .yield = 235e6};
  EXPECT_THAT(with_material("\"steel\""), ElementsAre(steel));
  EXPECT_THAT(with_material("{ like = \"steel\" }"), ElementsAre(steel));
  EXPECT_THAT(with_material("\"7800\"", {"bodies.ball.material=Steel"}), ElementsAre(steel));
}

TEST(Materials, like_another_differ_in_the_keys_that_are_given) {
  const Material stiffer{
      .group = "", .density = 7850, .young = 200e9, .poisson = 0.3, .area = 1e-4, .yield = 235e6};
  EXPECT_THAT(with_material("{ young = 200e9, area = 1e-4, like = \"steel\" }"), ElementsAre(stiffer));
  EXPECT_THAT(
      with_material("\"steel\"", {"bodies.ball.material.young=200e9", "bodies.ball.material.area=1e-4"}),
      ElementsAre(stiffer));
}

// Wood Handbook, FPL-GTR-190, tables 5-1 and 5-2: E_T/E_L = 0.043, G_RT/E_L = 0.003, ν_LR = 0.372.
TEST(Materials, by_name_may_be_orthotropic) {
  const Material wood = with_material("{ like = \"sitka spruce\", density = 400 }")[0];
  ASSERT_TRUE(wood.orthotropy);
  EXPECT_EQ(wood.density, 400);
  EXPECT_NEAR(wood.orthotropy->young[2] / wood.orthotropy->young[0], 0.043, 5e-5);  // rounded to three digits
  EXPECT_NEAR(wood.orthotropy->shear[0] / wood.orthotropy->young[0], 0.003, 5e-6);
  EXPECT_EQ(wood.orthotropy->poisson[2], 0.372);
}

TEST(Materials, by_name_have_other_names_and_spellings) {
  EXPECT_EQ(with_material("\"Stainless-Steel\""), with_material("\"stainless steel\""));
  EXPECT_EQ(with_material("\"aluminum\""), with_material("\"aluminium\""));
}

TEST(Materials, of_groups_are_names_or_tables) {
  const std::vector<Material> materials = with_material(
      "{ axle = \"steel\", head = { like = \"lead\", yield = 1e7 }, cap = { density = 1, young = 2 } }");
  ASSERT_EQ(materials.size(), 3U);
  EXPECT_EQ(materials[0].group, "axle");
  EXPECT_EQ(materials[0].density, 7850);
  EXPECT_EQ(materials[1].group, "cap");
  EXPECT_EQ(materials[1].young, 2);
  EXPECT_EQ(materials[2].group, "head");
  EXPECT_EQ(materials[2].density, 11340);
  EXPECT_EQ(materials[2].yield, 1e7);
  EXPECT_EQ(with_material("{ axle = \"lead\" }", {"bodies.ball.material.axle.young=3"})[0].young, 3);
}

TEST(Materials, by_name_are_numbers_in_the_resolved_scene) {
  const Scene scene = scene_of(changed(smallest, "{ density = 1000, young = 1e9 }", "\"steel\""));
  EXPECT_THAT(to_toml(scene),
              HasSubstr("material = { density = 7850.0, young = 210000000000.0, poisson = 0.3, "
                        "yield = 235000000.0 }\n"));
}

TEST(SceneValues, of_each_law_of_damping_are_read) {
  using Law = Damping::Law;
  const std::tuple<const char*, Law, double, double> laws[] = {
      {"{}", Law::none, 0, 0},
      {"{ ratio = 0.01 }", Law::ratio, 0.01, 0},
      {"{ loss_factor = 2e-3 }", Law::loss_factor, 0.002, 0},
      {"{ rayleigh = [3, 1e-7] }", Law::rayleigh, 3, 1e-7},
      {"{ viscosity = 1e-6 }", Law::viscosity, 1e-6, 0}};
  for (const auto& [text, law, first, second] : laws) {
    SCOPED_TRACE(text);
    const Damping damping = scene_of(changed(smallest, "contact = \"skin\"",
                                             std::string("contact = \"skin\"\ndamping = ") + text))
                                .bodies[0]
                                .damping;
    EXPECT_EQ(damping.law, law);
    EXPECT_EQ(damping.first, first);
    EXPECT_EQ(damping.second, second);
  }
}

TEST(SceneValues, of_decay_times_and_losses_by_mode_are_read) {
  const auto damping = [](const std::string& text) {
    return scene_of(smallest, {"bodies.ball.damping=" + text}).bodies[0].damping;
  };
  const Damping times = damping("{t60=[[100,2],[1e3,0.5]]}"), losses = damping("{by_mode=[1e-3,2e-3]}");
  EXPECT_EQ(times.law, Damping::Law::t60);
  EXPECT_EQ(times.table, (std::vector<std::array<double, 2>>{{100, 2}, {1000, 0.5}}));
  EXPECT_EQ(losses.law, Damping::Law::by_mode);
  EXPECT_THAT(losses.by_mode, ElementsAre(1e-3, 2e-3));
}

TEST(SceneValues, of_contact_are_read_and_its_directions_made_unit) {
  const Contact contact = scene_of(fullest).contact;
  EXPECT_EQ(contact.scheme, Scheme::impulse);
  EXPECT_EQ(contact.admittance, Admittance::difference);
  EXPECT_EQ(contact.instant, Instant::exact);
  EXPECT_EQ(contact.restitution, 0.25);
  EXPECT_EQ(contact.max_pivots, 40);
  ASSERT_EQ(contact.pairs.size(), 2U);
  const scene::Pair& pair = contact.pairs[0];
  EXPECT_EQ(pair.a, "ball");
  EXPECT_EQ(pair.b, "block");
  ASSERT_TRUE(pair.direction && pair.along && pair.spacing && pair.gap && pair.reach);
  EXPECT_THAT(*pair.direction, ElementsAre(0, -0.6, 0.8));  // 3, 4, 5
  EXPECT_THAT(*pair.along, ElementsAre(0, 0, 1));
  EXPECT_EQ(*pair.spacing, 0.005);
  EXPECT_EQ(*pair.gap, 0.01);
  EXPECT_EQ(*pair.reach, 0.02);
  EXPECT_EQ(contact.pairs[1].b, "the floor");
  EXPECT_FALSE(contact.pairs[1].direction);
}

TEST(SceneValues, of_everything_else_are_read) {
  const Scene scene = scene_of(fullest);
  EXPECT_EQ(scene.title, "Ball, block & \"floor\"");
  ASSERT_NE(scene.find_obstacle("the floor"), nullptr);
  EXPECT_THAT(scene.find_obstacle("the floor")->point, ElementsAre(0, -1, 0.5));
  EXPECT_THAT(scene.find_obstacle("the floor")->normal, ElementsAre(0, 1, 0));
  EXPECT_EQ(scene.find_body("the floor"), nullptr);
  EXPECT_EQ(scene.find_obstacle("ball"), nullptr);
  ASSERT_TRUE(scene.modes.up_to);
  EXPECT_EQ(scene.modes.up_to->value, 1500);
  EXPECT_FALSE(scene.modes.count);
  EXPECT_FALSE(scene.modes.residual_flexibility);
  EXPECT_EQ(scene.modes.relative_residual, 1e-6);
  EXPECT_EQ(scene.time.rate_hz, 96000);
  EXPECT_THAT(scene.loads.gravity, ElementsAre(0, -9.81, 1));
  EXPECT_EQ(scene.output.every, 4);
  EXPECT_TRUE(scene.output.view);
  EXPECT_EQ(scene.output.snapshot_every, 100);
  EXPECT_EQ(scene.output.vtk_every, 16);
}

TEST(SceneValues, of_stress_keep_visualisation_surfaces) {
  EXPECT_TRUE(scene_of(smallest, {"output.stress=true"}).output.view);
  EXPECT_FALSE(scene_of(smallest, {"output.stress=false"}).output.view);
}

TEST(SceneValues, of_frames_for_paraview_keep_visualisation_surfaces) {
  EXPECT_TRUE(scene_of(smallest, {"output.vtk_every=5"}).output.view);
  EXPECT_FALSE(scene_of(smallest, {"output.vtk_every=0"}).output.view);
}

// 352.8 kHz is 8 times 44.1 kHz; 1 MHz is 22 times 45.5 kHz.
TEST(SceneValues, of_rows_of_receivers_divide_the_output_rate) {
  const Override mic = "output.receiver=[{name=\"mic\",body=\"ball\",at=[0,0,1]}]";
  const auto every = [&](const char* rate, const char* set) {
    const Scene scene = scene_of(smallest, {mic, std::string("time.rate_hz=") + rate, set});
    return scene.output.receivers_every(scene.time.rate_hz);
  };
  EXPECT_EQ(every("352800", "title=any"), 1);
  EXPECT_EQ(every("352800", "output.every=100"), 8);
  EXPECT_EQ(every("1e6", "output.every=2"), 22);
  EXPECT_EQ(every("1000", "output.every=2"), 1);
  EXPECT_EQ(every("352800", "output.receivers_rate_hz=352800"), 1);
  EXPECT_EQ(every("352800", "output.receivers_rate_hz=44100"), 8);
  EXPECT_EQ(every("352800", "output.receivers_rate_hz=40000"), 8);
  EXPECT_EQ(every("300", "output.receivers_rate_hz=100"), 3);
}

TEST(SceneValues, of_contact_adapted_bases_are_read) {
  const Modes within =
      scene_of(smallest, {"modes={ basis = \"contact\", up_to_hz = 2e3, flexibility_error = 1e-6 }"}).modes;
  EXPECT_EQ(within.basis, Basis::contact);
  EXPECT_EQ(within.flexibility_error, 1e-6);
  EXPECT_FALSE(within.count);
  // A number of vectors for any error: the error then has no default.
  const Modes counted = scene_of(smallest, {"modes={ basis = \"contact\", up_to_hz = 2e3, count = 60, "
                                            "residual_flexibility = false }"})
                            .modes;
  EXPECT_EQ(counted.basis, Basis::contact);
  EXPECT_EQ(counted.up_to->value, 2000);
  EXPECT_EQ(counted.count, 60);
  EXPECT_FALSE(counted.flexibility_error);
  EXPECT_FALSE(counted.residual_flexibility);
}

TEST(SceneValues, of_certified_modes_may_name_another_solver) {
  EXPECT_EQ(scene_of(smallest, {"modes.solver=krylovschur"}).modes.solver, "krylovschur");
  // The default may be named where no other solver is possible.
  EXPECT_EQ(scene_of(smallest, {"modes={basis=\"contact\",up_to_hz=1e3,solver=\"ricochet\"}"}).modes.solver,
            "ricochet");
}

TEST(SceneValues, of_truncated_modes_are_read) {
  for (const char* basis : {"", "basis = \"modes\", "}) {
    const Modes modes =
        scene_of(smallest, {std::string("modes={ ") + basis + "up_to_hz = 2e3, flexibility_error = 0.5 }"})
            .modes;
    EXPECT_EQ(modes.basis, Basis::modes);
    EXPECT_EQ(modes.up_to->value, 2000);
    EXPECT_FALSE(modes.count);
    EXPECT_EQ(modes.flexibility_error, 0.5);
  }
  // Without a residual flexibility, all modes are kept.
  EXPECT_FALSE(scene_of(smallest, {"modes={ up_to_hz = 2e3 }"}).modes.flexibility_error);
}

// Squares of such lengths exceed the range of double precision, but the direction is valid.
TEST(Directions, may_have_any_length) {
  for (const char* normal : {"[0, 3e200, 4e200]", "[0, 3e-200, 4e-200]"}) {
    const Scene scene = scene_of(changed(smallest, "[0, 0, 1]", normal));
    EXPECT_DOUBLE_EQ(scene.obstacles[0].normal[1], 0.6) << normal;
    EXPECT_DOUBLE_EQ(scene.obstacles[0].normal[2], 0.8) << normal;
  }
}

// The body of a pair comes first, which defines "out of a". A direction that the
// user gave out of the floor is reversed.
TEST(Pairs, that_name_the_obstacle_first_are_swapped) {
  const Contact contact =
      scene_of(changed(smallest, R"(["ball", "floor"])", "[\"floor\", \"ball\"]\ndirection = [0, 0, 2]"))
          .contact;
  EXPECT_EQ(contact.pairs[0].a, "ball");
  EXPECT_EQ(contact.pairs[0].b, "floor");
  EXPECT_THAT(*contact.pairs[0].direction, ElementsAre(0, 0, -1));
}

TEST(Pairs, inherit_missing_keys_from_contact) {
  const Contact contact =
      scene_of(changed(fullest, "scheme = \"impulse\"", "scheme = \"impulse\"\ngap = 0.5\nreach = 0.25"))
          .contact;
  ASSERT_EQ(contact.pairs.size(), 2U);
  EXPECT_EQ(*contact.pairs[0].gap, 0.01);
  EXPECT_EQ(*contact.pairs[1].gap, 0.5);
  EXPECT_EQ(*contact.pairs[1].reach, 0.25);
}

TEST(Friction, is_one_coefficient_or_two_with_a_transition) {
  const auto of = [](const std::string& value) {
    return scene_of(changed(smallest, "[contact]", "[contact]\nfriction = " + value))
        .contact.pairs[0]
        .friction;
  };
  EXPECT_EQ(of("0.3"), (Friction{0.3, 0.3, 0}));
  EXPECT_EQ(of("1"), (Friction{1, 1, 0}));
  EXPECT_EQ(of("{ static = 0.3 }"), (Friction{0.3, 0.3, 0}));
  EXPECT_EQ(of("{ static = 0.4, dynamic = 0.3, stribeck_velocity = 0.01 }"), (Friction{0.4, 0.3, 0.01}));
  EXPECT_EQ(of("{ static = 0.2, dynamic = 0.5, stribeck_velocity = 2 }"), (Friction{0.2, 0.5, 2}));
  EXPECT_EQ(of("{ static = 0.3, dynamic = 0.3 }"), (Friction{0.3, 0.3, 0}));
  EXPECT_FALSE(of("0"));
  EXPECT_FALSE(of("-0.0"));
  EXPECT_FALSE(of("{ static = 0, dynamic = 0 }"));
  EXPECT_FALSE(scene_of(smallest).contact.pairs[0].friction);
}

TEST(Friction, of_a_pair_replaces_that_of_contact) {
  const std::string text = changed(smallest, "between = [\"ball\", \"floor\"]", R"(friction = 0.3
[[contact.pair]]
between = ["ball", "floor"]
[[contact.pair]]
between = ["ball", "floor"]
friction = 0
[[contact.pair]]
between = ["ball", "floor"]
friction = { static = 0.4, dynamic = 0.2, stribeck_velocity = 0.1 })");
  const std::vector<Override> none;
  const Contact contact = scene_of(text).contact;
  EXPECT_EQ(contact.pairs[0].friction, (Friction{0.3, 0.3, 0}));
  EXPECT_FALSE(contact.pairs[1].friction);
  EXPECT_EQ(contact.pairs[2].friction, (Friction{0.4, 0.2, 0.1}));
  EXPECT_TRUE(contact.rubs("ball"));
  EXPECT_TRUE(contact.rubs("floor"));
  EXPECT_FALSE(scene_of(smallest).contact.rubs("ball"));
}

TEST(Friction, is_varied_by_overrides) {
  const auto of = [](const std::vector<Override>& set) {
    return scene_of(smallest, set).contact.pairs[0].friction;
  };
  EXPECT_EQ(of({"contact.friction=0.2"}), (Friction{0.2, 0.2, 0}));
  EXPECT_EQ(of({"contact.friction.static=0.2"}), (Friction{0.2, 0.2, 0}));
  EXPECT_EQ(
      of({"contact.friction={static=0.2,dynamic=0.1,stribeck_velocity=1}", "contact.friction.static=0.5"}),
      (Friction{0.5, 0.1, 1}));
}

TEST(Obstacles, have_a_shape_or_a_surface) {
  const auto of = [](const std::string& table) {
    return scene_of(smallest, {"obstacles.floor={" + table + "}"}).obstacles[0];
  };
  EXPECT_TRUE(of("normal=[0,0,1]").is_half_space());
  const Obstacle bowl = of("shape=\"sphere\",radius=0.1,side=\"inside\"");
  EXPECT_EQ(bowl.shape, Shape::sphere);
  EXPECT_EQ(bowl.side, ObstacleSide::inside);
  EXPECT_EQ(bowl.radius, 0.1);
  const Obstacle anvil = of("surface=\"anvil.stl\"");
  EXPECT_EQ(anvil.shape, Shape::mesh);
  EXPECT_EQ(anvil.surface.filename(), "anvil.stl");
  EXPECT_EQ(anvil.scale, 1);
  EXPECT_EQ(of("shape=\"cone\",radius=0.1,length=0.3").radius_small, 0);
}

TEST(Obstacles, move_in_any_direction_and_turn) {
  const std::string paddle =
      "obstacles.floor={shape=\"box\",size=[1,1,1],velocity=[0,0,2],angular_velocity=[0,0,3]}";
  const Scene scene = scene_of(smallest, {paddle});
  EXPECT_THAT(scene.obstacles[0].velocity, ElementsAre(0, 0, 2));
  EXPECT_THAT(scene.obstacles[0].angular_velocity, ElementsAre(0, 0, 3));
  EXPECT_TRUE(leaves_its_surface(scene, scene.obstacles[0]));
  const Scene again = scene_of(to_toml(scene));
  EXPECT_EQ(again.obstacles, scene.obstacles);
  EXPECT_THAT(scene_of(smallest, {"obstacles.floor.velocity=[1,0,0.25]"}).obstacles[0].velocity,
              ElementsAre(1, 0, 0.25));
}

TEST(Obstacles, move_along_their_surface) {
  EXPECT_EQ(scene_of(smallest).obstacles[0].velocity, Vector3{});
  EXPECT_THAT(scene_of(smallest, {"obstacles.floor.velocity=[1,-2,0]"}).obstacles[0].velocity,
              ElementsAre(1, -2, 0));
  // The normal of a tilted obstacle is rounded.
  EXPECT_THAT(scene_of(smallest, {"obstacles.floor.normal=[1,1,3]", "obstacles.floor.velocity=[3,0,-1]"})
                  .obstacles[0]
                  .velocity,
              ElementsAre(3, 0, -1));
}

// "direction" points out of the first member of "between", whichever of the two the pair itself gives.
TEST(Pairs, are_swapped_once_for_any_inherited_keys) {
  const std::string two_balls = changed(smallest, "[obstacles.floor]", R"([bodies.cube]
mesh = "cube.msh"
material = { density = 1000, young = 1e9 }
contact = "skin"

[obstacles.floor])");
  const Contact shared = scene_of(changed(two_balls, R"(between = ["ball", "floor"])", R"(
between = ["floor", "ball"]
direction = [0, 0, 1]
[[contact.pair]]
direction = [0, 1, 0]
[[contact.pair]]
between = ["floor", "cube"]
[[contact.pair]]
between = ["ball", "cube"])"))
                             .contact;
  ASSERT_EQ(shared.pairs.size(), 3U);
  EXPECT_EQ(shared.pairs[0].a, "ball");
  EXPECT_THAT(*shared.pairs[0].direction, ElementsAre(0, -1, 0));
  EXPECT_EQ(shared.pairs[1].a, "cube");
  EXPECT_THAT(*shared.pairs[1].direction, ElementsAre(0, 0, -1));
  EXPECT_EQ(shared.pairs[2].a, "ball");
  EXPECT_THAT(*shared.pairs[2].direction, ElementsAre(0, 0, 1));
}

TEST(Bodies, are_in_the_order_of_their_names) {
  const Scene scene = scene_of(fullest);
  ASSERT_EQ(scene.bodies.size(), 2U);
  EXPECT_EQ(scene.bodies[0].name, "ball");
  EXPECT_EQ(scene.bodies[1].name, "block");
}

TEST(ScenePaths, start_at_the_folder_of_the_scene) {
  const Folder folder;
  const Scene scene = read(folder.write("deep/scene.toml", fullest));
  EXPECT_EQ(scene.find_body("ball")->mesh, folder.path() / "deep/ball.geo");
  EXPECT_EQ(scene.find_body("block")->mesh, folder.path() / "shapes/block.step");
}

TEST(ScenePaths, that_are_absolute_stay) {
  EXPECT_EQ(scene_of(changed(smallest, "ball.msh", "/far/away/ball.msh")).bodies[0].mesh,
            "/far/away/ball.msh");
}

TEST(Scenes, that_ship_with_the_meshes_are_read) {
  for (const char* file : {"/meshes/two-disks/two-disks.toml", "/meshes/two-rods/two-rods.toml"}) {
    const Scene scene = read(std::string(RICOCHET_SOURCE) + file);
    EXPECT_EQ(scene.bodies.size(), 2U) << file;
    for (const Body& body : scene.bodies) EXPECT_TRUE(std::filesystem::exists(body.mesh)) << body.mesh;
  }
}

TEST(TableScene, names_a_file_in_its_folder_and_no_bodies) {
  EXPECT_EQ(scene_of(smallest).contact.kernel, ContactKernel::modes);
  const Folder folder;
  const Scene scene = read(folder.write("scenes/scene.toml", tabular));
  EXPECT_EQ(scene.contact.kernel, ContactKernel::table);
  EXPECT_EQ(scene.contact.table, folder.path() / "tables/rods.h5");
  EXPECT_EQ(scene.contact.scheme, Scheme::compliant);
  EXPECT_THAT(scene.bodies, IsEmpty());
  EXPECT_THAT(scene.contact.pairs, IsEmpty());
}

TEST(Title, is_refused_if_it_makes_file_names_too_long) {
  const auto titled = [](int length) {
    return "title = \"" + std::string(static_cast<std::size_t>(length), 'a') + "\"\n" + smallest;
  };
  EXPECT_EQ(scene_of(titled(226)).title.size(), 226);  // 255 bytes with .summary.json and .1234567.partial
  EXPECT_EQ(complaint_about(titled(227)),
            "scene.toml: title: with the names of receivers, it gives file names of 256 bytes, more than "
            "255: shorten it");
}

}  // namespace ricochet::scene::read_test
