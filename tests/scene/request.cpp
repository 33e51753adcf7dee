// SPDX-License-Identifier: BSD-2-Clause
// The hash of a kernel depends on all data that the kernel depends on, and on nothing else. Otherwise runs
// would use the modes of another body or recompute modes needlessly.
#include "src/scene/request.hpp"
#include "src/scene/read.hpp"
#include "src/scene/write.hpp"

#include <gmock/gmock.h>

#include <set>

#include "tests/scene/scenes.hpp"

namespace ricochet::scene::request_test {

using namespace test;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

const std::string scene_text = changed(smallest, "[contact]", R"([contact]
direction = [0, 0, -1]
along = [1, 0, 0]
spacing = 0.01)");

/// The request of the ball, whose mesh file contains `mesh`.
KernelRequest request_of(const std::string& text, const std::vector<Override>& overrides = {},
                         const std::string& mesh = "a mesh") {
  const Folder folder;
  folder.write("ball.msh", mesh);
  folder.write("moved.msh", mesh);
  const Scene scene = read(folder.write("scene.toml", text), overrides);
  return kernel_request(scene, scene.bodies[0]);
}

std::string hash_with(const Override& set) { return request_of(scene_text, {set}).hash; }

// The example in FIPS 180-4.
TEST(Sha256, matches_the_standard) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(KernelHash, is_the_same_for_the_same_scene) {
  const std::string hash = request_of(scene_text).hash;
  EXPECT_EQ(hash, request_of(scene_text).hash);
  EXPECT_EQ(hash.size(), 64U);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
}

// Stored kernels are found by these hashes, which the order of declarations and the form of numbers decide.
TEST(KernelHash, of_these_scenes_is_that_of_stored_kernels) {
  KernelRequest part = request_of(scene_text);
  EXPECT_EQ(part.hash, "e569968561986216cc6ad9f6b242d425f371b7839ac07b01bd04721082e35781") << part.toml;
  part.points = {1, 2, 5};
  seal(part);
  EXPECT_EQ(part.hash, "2aa1f582392e4606d4d817f356ead9cdb8b93f94e309f9b9e5222c87d911b61a") << part.toml;
  part.within_reach = part.normal_residual = true;
  seal(part);
  EXPECT_EQ(part.hash, "71136713966cd9be10ef2a22a4bded253f75df6ec29c846512749fde5a9dff2e") << part.toml;
  const KernelRequest full = request_of(
      scene_text,
      {R"(bodies.ball={ mesh = "ball.msh", geometry = { size = 1 }, order = 2, size_factor = 0.5, scale = 0.1, )"
       R"(rotate_deg = [0, 0, 90], damping = { t60 = [[100, 2], [1000, 0.8]] }, contact = ["skin", "rim"], )"
       R"(material = { a = { density = 1000, young = 1e9, poisson = 0.3, area = 1, yield = 1e6 }, )"
       R"(b = { density = 1, young = 2 } }, support = { foot = "zx" } })",
       "modes={ basis = \"contact\", up_to_hz = 100, flexibility_error = 0.01, low_rank = 1e-6, "
       "residual_components = \"all\" }",
       R"(loads.traction=[{ body = "ball", group = "skin", vector = [1, 0, 0] }])",
       R"(loads.point=[{ body = "ball", at = [1, 2, 3], vector = [1, 0, 0] }])",
       R"(loads.motion=[{ body = "ball", group = "foot", vector = [0, 0, 1] }])",
       R"(output={ view = true, receiver = [{ name = "mic", body = "ball", at = [0, 0.1, 0] }] })"});
  EXPECT_EQ(full.hash, "9c4287e8abd51f7bafd945bdc10666ad8994da38f269cc9e04989bd29b68bfc2") << full.toml;
}

TEST(KernelHash, changes_with_everything_that_the_kernel_depends_on) {
  const std::string hash = request_of(scene_text).hash;
  for (const char* set :
       {"bodies.ball.material.young=2e9", "bodies.ball.material.density=1001",
        "bodies.ball.material.poisson=0.1", "bodies.ball.material.area=1", "bodies.ball.order=2",
        "bodies.ball.scale=2", "bodies.ball.geometry.size=1", "bodies.ball.damping.ratio=0.1",
        "bodies.ball.contact=other", "bodies.ball.support.clamp=x", "modes.count=11",
        "modes.residual_flexibility=false", "modes.relative_residual=1e-9", "contact.direction=[0,1,0]",
        "contact.along=[0,1,0]", "contact.spacing=0.02", "output.view=true"})
    EXPECT_NE(hash_with(set), hash) << set;
}

TEST(KernelHash, changes_with_each_constant_of_a_law_and_with_its_axes) {
  const std::string start = "bodies.ball.material={ density = 1, ",
                    nine = "young = [3, 2, 1], shear = [1, 1, 1], ";
  std::set<std::string> hashes;
  for (const std::string& law :
       {nine + "poisson = [0, 0, 0]", nine + "poisson = [0, 0, 0.1]",
        std::string("young = [3, 2, 1.1], shear = [1, 1, 1], poisson = [0, 0, 0]"),
        std::string("young = [3, 2, 1], shear = [1, 1, 1.1], poisson = [0, 0, 0]"),
        nine + "poisson = [0, 0, 0], axes = [[0, 1, 0], [1, 0, 0]]",
        nine + "poisson = [0, 0, 0], about = { point = [0, 0, 0], direction = [0, 0, 1] }",
        nine + "poisson = [0, 0, 0], about = { point = [1, 0, 0], direction = [0, 0, 1] }",
        std::string("stiffness = [3, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1]"),
        std::string("stiffness = [3, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1.1]")})
    EXPECT_TRUE(hashes.insert(hash_with(start + law + " }")).second) << law;
  EXPECT_EQ(hash_with(start + nine + "poisson = [0, 0, 0] }"),
            hash_with(start + nine + "poisson = [0, 0, 0], axes = [[2, 0, 0], [0, 3, 0]] }"));
}

// The same band with other settings gives a different kernel.
TEST(KernelHash, changes_with_basis_and_flexibility_error) {
  std::set<std::string> hashes;
  for (const char* modes : {"{ up_to_hz = 1e3 }", "{ up_to_hz = 1e3, flexibility_error = 1e-3 }",
                            "{ up_to_hz = 1e3, flexibility_error = 2e-3 }",
                            "{ basis = \"contact\", up_to_hz = 1e3, flexibility_error = 2e-3 }",
                            "{ basis = \"contact\", up_to_hz = 1e3, flexibility_error = 1e-3 }",
                            "{ basis = \"contact\", up_to_hz = 1e3, count = 10 }",
                            "{ basis = \"contact\", up_to_hz = 2e3, count = 10 }"})
    EXPECT_TRUE(hashes.insert(hash_with(std::string("modes=") + modes)).second) << modes;
}

TEST(KernelHash, is_unchanged_if_a_default_of_the_modes_is_given) {
  const auto same = [](const char* one, const char* other) {
    EXPECT_EQ(hash_with(std::string("modes=") + one), hash_with(std::string("modes=") + other));
  };
  same("{ up_to_hz = 1e3 }", "{ basis = \"modes\", up_to_hz = 1e3 }");
  same("{ basis = \"contact\", up_to_hz = 1e3 }",
       "{ basis = \"contact\", up_to_hz = 1e3, flexibility_error = 1e-3 }");
}

TEST(KernelHash, is_unchanged_by_everything_else) {
  const std::string hash = request_of(scene_text).hash;
  for (const char* set :
       {"title=other", "bodies.ball.velocity=[0,-6,0]", "bodies.ball.translate=[1,2,3]", "contact.gap=0.5",
        "contact.reach=0.5", "contact.scheme=impulse", "contact.max_pivots=20", "time.rate_hz=96000",
        "time.duration=1", "loads.gravity=[0,0,-9.81]", "output.every=2", "output.snapshot_every=5",
        "obstacles.floor.point=[0,0,1]", "bodies.ball.order=3", "bodies.ball.material.yield=65e6",
        "bodies.ball.mesh=moved.msh"})  // 3 is the default; the other file has the same contents
    EXPECT_EQ(hash_with(set), hash) << set;
}

TEST(KernelHash, does_not_depend_on_the_name_of_the_body) {
  const std::string renamed =
      changed(changed(scene_text, "[bodies.ball]", "[bodies.cube]"), "\"ball\"", "\"cube\"");
  EXPECT_EQ(request_of(renamed).hash, request_of(scene_text).hash);
}

TEST(KernelHash, changes_with_the_content_of_the_mesh_file) {
  EXPECT_NE(request_of(scene_text, {}, "another mesh").hash, request_of(scene_text).hash);
  EXPECT_EQ(request_of(scene_text, {}, "abc").mesh_sha256, sha256("abc"));
}

/// Hash of a ball whose mesh is the .geo file with these contents.
std::string geo_hash(const std::string& main, const std::string& included, const std::string& merged) {
  const Folder folder;
  folder.write("ball.geo", main);
  folder.write("parts/sizes.geo", included);
  folder.write("parts/shape.step", merged);
  const Scene scene = read(folder.write("scene.toml", smallest), {"bodies.ball.mesh=ball.geo"});
  return kernel_request(scene, scene.bodies[0]).hash;
}

TEST(KernelHash, changes_with_the_files_that_a_geo_includes) {
  const std::string main = "Include \"parts/sizes.geo\";\nPoint(1) = {0, 0, 0};\n";
  // sizes.geo merges a file in its folder and includes the file that includes it,
  // which must not cause an endless loop.
  const std::string sizes = "  Merge \"shape.step\";\nInclude \"../ball.geo\";\n";
  const std::string hash = geo_hash(main, sizes, "a cube");
  EXPECT_EQ(geo_hash(main, sizes, "a cube"), hash);
  EXPECT_NE(geo_hash(main, sizes, "a cone"), hash);
  EXPECT_NE(geo_hash(main, sizes + "size = 1;\n", "a cube"), hash);
  EXPECT_NE(geo_hash(main + "size = 1;\n", sizes, "a cube"), hash);
  EXPECT_EQ(geo_hash("size = 1;\n", sizes, "a cube"),
            geo_hash("size = 1;\n", "", ""));  // nothing is included
}

TEST(KernelRequests, name_a_missing_file) {
  const Folder folder;
  const Scene scene = read(folder.write("scene.toml", smallest));
  const std::string mesh = (folder.path() / "ball.msh").string();
  const auto ask = [&] { kernel_request(scene, scene.bodies[0]); };
  EXPECT_EQ(complaint_of(ask), "scene.toml: bodies.ball.mesh = \"" + mesh +
                                   "\": no such file: a path starts at the folder of the scene");
  folder.write("balls.msh", "");
  EXPECT_EQ(complaint_of(ask),
            "scene.toml: bodies.ball.mesh = \"" + mesh + "\": no such file. Did you mean \"balls.msh\"?");
  std::filesystem::create_directory(mesh);
  EXPECT_EQ(complaint_of(ask),
            "scene.toml: bodies.ball.mesh = \"" + mesh + "\": is a folder: name a file in it");

  folder.write("ball.geo", "Include \"gone.geo\";\n");
  const Scene geo = read(folder.path() / "scene.toml", {"bodies.ball.mesh=ball.geo"});
  EXPECT_EQ(complaint_of([&] { kernel_request(geo, geo.bodies[0]); }),
            "scene.toml: bodies.ball.mesh includes = \"" + (folder.path() / "gone.geo").string() +
                "\": no such file: there are \"ball.geo\", \"balls.msh\"");
}

TEST(KernelRequests, hold_no_velocity) {
  const Body body =
      request_of(scene_text, {"bodies.ball.velocity=[0,-6,0]", "bodies.ball.angular_velocity=[0,0,9]"}).body;
  for (const Vector3& vector : {body.velocity, body.angular_velocity})
    EXPECT_THAT(vector, ElementsAre(0, 0, 0));
}

TEST(KernelRequests, of_many_runs_of_a_scene_hash_a_mesh_once) {
  const Folder folder;
  folder.write("ball.msh", "abc");
  const Scene scene = read(folder.write("scene.toml", smallest));
  MeshHashes known;
  const auto ask = [&](MeshHashes* meshes) { return kernel_request(scene, scene.bodies[0], meshes); };
  EXPECT_EQ(ask(&known).hash, ask(nullptr).hash);
  folder.write("ball.msh", "abd");
  EXPECT_EQ(ask(&known).mesh_sha256, sha256("abc"));
  EXPECT_EQ(ask(nullptr).mesh_sha256, sha256("abd"));
}

// After rotations by 90 degrees about x and then z, the x, y, z axes of the body are the y, z, x
// axes of the world. An axis has no sign.
TEST(KernelRequests, hold_axes_in_the_frame_of_the_body) {
  const KernelRequest request =
      request_of(scene_text, {"bodies.ball.rotate_deg=[90,0,90]", "contact.direction=[0,-3,4]"});
  EXPECT_THAT(*request.direction, ElementsAre(0.6, -0.8, 0));
  EXPECT_THAT(*request.along, ElementsAre(0, 0, 1));
}

// No other kernel is therefore needed for a body that is rotated together with its axes,
// or that is hit from the opposite side.
TEST(KernelHash, is_unchanged_if_body_and_axes_rotate_together) {
  const std::string hash = request_of(scene_text).hash;  // direction −z, along x
  EXPECT_EQ(request_of(scene_text, {"bodies.ball.rotate_deg=[90,0,90]", "contact.direction=[1,0,0]",
                                    "contact.along=[0,1,0]"})
                .hash,
            hash);
  EXPECT_EQ(hash_with("contact.direction=[0,0,1]"), hash);
  EXPECT_NE(hash_with("bodies.ball.rotate_deg=[90,0,90]"), hash);
}

// One component suffices only if all pairs have the same direction.
TEST(KernelRequests, hold_a_direction_only_if_all_pairs_share_it) {
  const std::string two = changed(smallest, "between = [\"ball\", \"floor\"]", R"(
direction = [0, 0, 1]
[[contact.pair]]
between = ["ball", "floor"]
[[contact.pair]]
between = ["ball", "floor"])");
  EXPECT_TRUE(request_of(two).direction);
  EXPECT_TRUE(request_of(two, {"contact.pair[1].direction=[0,0,-1]"}).direction);
  EXPECT_FALSE(request_of(two, {"contact.pair[1].direction=[0,1,0]"}).direction);
  EXPECT_FALSE(
      request_of(changed(two, "direction = [0, 0, 1]", ""), {"contact.pair[1].direction=[0,0,1]"}).direction);
  EXPECT_EQ(complaint_of([&] { request_of(two, {"contact.pair[1].spacing=0.5"}); }),
            "scene.toml: contact: two pairs require different patches (along, spacing) of bodies.ball: a "
            "body has one "
            "set of candidates; give both pairs the same values");
}

// Friction acts along the surface, so its kernel is that of a scene in which contact may act in any
// direction.
TEST(KernelRequests, of_bodies_with_friction_hold_all_components) {
  const std::string open = changed(scene_text, "direction = [0, 0, -1]\n", "");
  const KernelRequest rough = request_of(scene_text, {"contact.friction=0.3"});
  EXPECT_TRUE(rough.friction);
  EXPECT_FALSE(rough.direction);
  EXPECT_FALSE(may_be_normal(rough));
  EXPECT_TRUE(may_be_normal(request_of(open)));
  EXPECT_EQ(rough.hash, request_of(open).hash);
  EXPECT_NE(rough.hash, request_of(scene_text).hash);
  for (const char* same :
       {"contact.friction=0.5", "contact.friction={static=0.4,dynamic=0.3,stribeck_velocity=1}"})
    EXPECT_EQ(request_of(scene_text, {same}).hash, rough.hash) << same;
}

TEST(KernelRequests, of_bodies_without_friction_are_as_before) {
  const std::string two = changed(smallest, "between = [\"ball\", \"floor\"]", R"(
direction = [0, 0, 1]
[[contact.pair]]
between = ["ball", "floor"]
[[contact.pair]]
between = ["ball", "floor"])");
  for (const char* set :
       {"contact.friction=0", "contact.friction={static=0}", "obstacles.floor.velocity=[1,0,0]"}) {
    const KernelRequest smooth = request_of(two, {set});
    EXPECT_FALSE(smooth.friction) << set;
    EXPECT_EQ(smooth.hash, request_of(two).hash) << set;
  }
  for (const char* one : {"contact.pair[0].friction=0.1", "contact.pair[1].friction=0.1"}) {
    const KernelRequest rough = request_of(two, {one});
    EXPECT_TRUE(rough.friction) << one;
    EXPECT_FALSE(rough.direction) << one;
  }
}

// An obstacle meets a body that turns along any of its axes, at any of its candidates.
// Its flexibility is compact, so its kernel is another one than that of a body that keeps its attitude.
TEST(KernelRequests, of_bodies_that_turn_hold_all_components_and_candidates) {
  const std::string directed = changed(smallest, "[contact]", "[contact]\ndirection = [0, 0, -1]");
  const KernelRequest turning = request_of(directed, {"motion.rotation=finite"});
  EXPECT_TRUE(turning.turns);
  EXPECT_FALSE(turning.direction);
  EXPECT_FALSE(turning.points);
  EXPECT_FALSE(may_be_normal(turning));
  EXPECT_TRUE(may_be_normal(request_of(smallest)));
  EXPECT_NE(turning.hash, request_of(smallest).hash);
  EXPECT_EQ(turning.hash, request_of(smallest, {"motion.rotation=finite", "contact.friction=0.3"}).hash);
  EXPECT_EQ(request_of(directed, {"motion.rotation=linear"}).hash, request_of(directed).hash);
  EXPECT_NE(turning.hash, request_of(directed).hash);
}

TEST(KernelPaths, are_the_name_of_the_body_and_twelve_digits) {
  KernelRequest request;
  request.body.name = "ball";
  request.hash = "0123456789abcdef0123456789abcdef";
  EXPECT_EQ(kernel_path("some/out", request), "some/out/ball-0123456789ab.kernel.h5");
}

std::array<double, 9> turned(const Vector3& degrees) {
  Body body;
  body.rotate_deg = degrees;
  return rotation_of(body);
}

TEST(Rotation, of_quarter_turns_is_exact_about_each_axis) {
  EXPECT_THAT(turned({0, 0, 0}), ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
  EXPECT_THAT(turned({90, 0, 0}), ElementsAre(1, 0, 0, 0, 0, -1, 0, 1, 0));  // y to z
  EXPECT_THAT(turned({0, 90, 0}), ElementsAre(0, 0, 1, 0, 1, 0, -1, 0, 0));  // z to x
  EXPECT_THAT(turned({0, 0, 90}), ElementsAre(0, -1, 0, 1, 0, 0, 0, 0, 1));  // x to y
  EXPECT_THAT(turned({0, 0, -270}), ElementsAreArray(turned({0, 0, 90})));
  EXPECT_THAT(turned({0, 0, 180}), ElementsAre(-1, 0, 0, 0, -1, 0, 0, 0, 1));
}

TEST(Rotation, is_about_x_then_y_then_z) {
  EXPECT_THAT(turned({90, 90, 0}), ElementsAre(0, 1, 0, 0, 0, -1, -1, 0, 0));  // y to z to x
  EXPECT_THAT(turned({90, 0, 90}), ElementsAre(0, 0, 1, 1, 0, 0, 0, 1, 0));    // z to −y to x
  EXPECT_THAT(turned({0, 90, 90}), ElementsAre(0, -1, 0, 0, 0, 1, -1, 0, 0));  // z to x to y
  EXPECT_THAT(turned({90, 90, 90}), ElementsAre(0, 0, 1, 0, 1, 0, -1, 0, 0));  // y to z to x to y
}

// 1e17 is 80 below a multiple of 360. Small additions to such a number are lost.
TEST(Rotation, by_many_turns_equals_the_remainder) {
  for (const Vector3 degrees : {Vector3{1e17, 0, 0}, Vector3{0, -1e17, 0}, Vector3{0, 0, 1e17}}) {
    const double left = std::remainder(degrees[0] + degrees[1] + degrees[2], 360.0);
    EXPECT_EQ(std::abs(left), 80);
    Vector3 same{};
    for (int k = 0; k < 3; ++k) same[k] = degrees[k] == 0 ? 0 : left;
    EXPECT_THAT(turned(degrees), ElementsAreArray(turned(same)));
  }
}

TEST(Rotation, by_any_angle_matches_the_closed_form) {
  const auto matrix = turned({0, 0, 30});
  EXPECT_NEAR(matrix[0], 0.86602540378443865, 1e-15);  // √3/2
  EXPECT_NEAR(matrix[3], 0.5, 1e-15);
}

}  // namespace ricochet::scene::request_test
