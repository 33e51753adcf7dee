// SPDX-License-Identifier: BSD-2-Clause
// Kernels that can be derived from others, and kernels that cannot.
#include "src/scene/derive.hpp"
#include "src/scene/read.hpp"
#include "src/scene/request.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kernels/write.hpp"
#include "tests/kernels/bar.hpp"
#include "tests/kernels/sample.hpp"
#include "tests/scene/scenes.hpp"

namespace ricochet::scene::derive_test {

using namespace test;
using kernels::Kernel;
using kernels::test::Bar;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Optional;

const std::string scene_text =
    changed(changed(smallest, "count = 10", "up_to_hz = 14.0"), "[contact]", R"([contact]
direction = [0, 0, -1]
along = [1, 0, 0]
spacing = 0.01)");

/// The request for the ball of the scene with these overrides.
KernelRequest request_of_ball(const std::vector<Override>& overrides = {}) {
  const Folder folder;
  folder.write("ball.msh", "a mesh");
  folder.write("other.msh", "another mesh");
  const Scene scene = read(folder.write("scene.toml", scene_text), overrides);
  return kernel_request(scene, scene.bodies[0]);
}

std::optional<kernels::Similarity> similarity_with(const std::vector<Override>& overrides) {
  return similarity(request_of_ball(), request_of_ball(overrides));
}

/// A bar in place of the ball. Its 40 modes reach up to 14.4 Hz.
Kernel kernel_of(const KernelRequest& request) {
  Kernel kernel = Bar{}.kernel();
  kernel.hash = request.hash;
  kernel.scene = request.toml;
  kernel.mesh_sha256 = request.mesh_sha256;
  return kernel;
}

Kernel derived_with(const std::vector<Override>& overrides, const std::vector<Override>& before = {}) {
  const KernelRequest had = request_of_ball(before), wanted = request_of_ball(overrides);
  return derived(kernel_of(had), had, wanted);
}

std::string refusal_of(const std::vector<Override>& overrides, const std::vector<Override>& before = {}) {
  return complaint_of([&] { derived_with(overrides, before); });
}

TEST(KernelFiles, state_the_request_that_they_answer) {
  for (const char* set :
       {"title=any",
        "bodies.ball.material={steel={density=7800,young=2e11,poisson=0.3},cork={density=240,young=2e7}}",
        "bodies.ball.material={density=1,young=2,area=3}", "bodies.ball.damping={rayleigh=[1,2]}",
        "bodies.ball.support={\"symmetry plane\"=\"x\"}", "bodies.ball.contact=[\"rim\",\"a \\\"cap\\\"\"]",
        "bodies.ball.geometry={\"number of turns\"=2,size=4e-3}", "modes={count=7}",
        "modes={basis=\"contact\",up_to_hz=3,low_rank=1e-9}", "output.view=true"}) {
    KernelRequest request = request_of_ball({set});
    request.turns = std::string(set) == "title=any";
    if (std::string(set) == "output.view=true") request.points = {4, 0, 2};
    seal(request);
    const KernelRequest answered = request_of({request.hash, request.toml, request.mesh_sha256}, "FILE");
    EXPECT_EQ(answered.toml, request.toml);
    EXPECT_EQ(answered.points, request.points);
    EXPECT_EQ(answered.turns, request.turns);
  }
}

TEST(KernelFiles, of_imported_bodies_state_their_request_and_serve_others_of_the_same_file) {
  const auto request_with = [](const std::string& modes) {
    const Folder folder;
    folder.write("ball.h5", "a body file");
    const Scene scene =
        read(folder.write("scene.toml", changed(changed(smallest, "ball.msh", "ball.h5"),
                                                "material = { density = 1000, young = 1e9 }", "")),
             {"modes=" + modes});
    return kernel_request(scene, scene.bodies[0]);
  };
  const KernelRequest had = request_with("{count=9}"), wanted = request_with("{count=7}");
  const KernelRequest answered = request_of({had.hash, had.toml, had.mesh_sha256}, "FILE");
  EXPECT_EQ(answered.toml, had.toml);
  const auto by = similarity(answered, wanted);
  ASSERT_TRUE(by);
  EXPECT_EQ(by->young * by->density * by->scale, 1);
  KernelRequest other = wanted;
  other.mesh_sha256 = "of another file";
  EXPECT_FALSE(similarity(answered, other));
}

TEST(KernelFiles, of_other_versions_are_refused) {
  const KernelRequest request = request_of_ball();
  const auto complaint = [&](const std::string& hash, const std::string& toml) {
    return complaint_of([&] { request_of({hash, toml, request.mesh_sha256}, "FILE"); });
  };
  EXPECT_THAT(complaint(std::string(64, '0'), request.toml),
              HasSubstr("FILE: is a kernel of another version"));
  EXPECT_THAT(complaint(request.hash, "]"), HasSubstr("FILE: its scene is not TOML"));
  EXPECT_THAT(complaint(request.hash, "[modes]\ncount = 3"), HasSubstr("FILE: body: is missing"));
  EXPECT_THAT(complaint(request.hash, request.toml + "[magnets]\n"), HasSubstr("unknown key"));
}

TEST(Similar, bodies_differ_by_factors_of_stiffness_density_and_size) {
  const auto by = similarity_with({"bodies.ball.material.young=3e9", "bodies.ball.material.density=500",
                                   "bodies.ball.scale=2", "contact.spacing=0.02"});
  ASSERT_TRUE(by);
  EXPECT_DOUBLE_EQ(by->young, 3);
  EXPECT_DOUBLE_EQ(by->density, 0.5);
  EXPECT_DOUBLE_EQ(by->scale, 2);
  EXPECT_FALSE(by->area);
}

TEST(Similar, bodies_may_differ_in_everything_except_shape) {
  for (const char* set : {"bodies.ball.damping.ratio=0.1", "bodies.ball.translate=[1,2,3]", "modes={count=3}",
                          "output.view=true", "contact.direction=[0,0,1]", "bodies.ball.mesh=ball.msh"})
    EXPECT_TRUE(similarity_with({set})) << set;
}

TEST(Similar, bodies_may_not_differ_in_anything_else) {
  for (const char* set :
       {"bodies.ball.material.poisson=0.1", "bodies.ball.order=2", "bodies.ball.mesh=other.msh",
        "bodies.ball.geometry.size=1", "bodies.ball.contact=other", "bodies.ball.support.clamp=x",
        "contact.direction=[0,1,0]", "contact.along=[0,1,0]", "contact.spacing=0.02", "bodies.ball.scale=2",
        "bodies.ball.material.area=1"})
    EXPECT_FALSE(similarity_with({set})) << set;
}

// The flexibility of a body that turns is rounded, and may be compressed.
TEST(Similar, bodies_may_turn_if_they_did_not_but_not_the_other_way) {
  KernelRequest still = request_of_ball({}), turning = still;
  still.direction = turning.direction = {};
  turning.turns = true;
  seal(turning);
  EXPECT_TRUE(similarity(still, turning));
  EXPECT_FALSE(similarity(turning, still));
  EXPECT_TRUE(similarity(turning, turning));
  Kernel kernel = kernels::test::plain_kernel();
  kernel.modes.certificate.left_out = 0;
  const Kernel derived_one = derived(kernel, still, turning);
  ASSERT_TRUE(derived_one.surface.compact);
  EXPECT_EQ(derived_one.surface.compact->whole.size(), kernel.surface.residual_flexibility.size());
  EXPECT_EQ(derived_one.hash, turning.hash);
  still.modes.residual_flexibility = turning.modes.residual_flexibility = false;
  EXPECT_TRUE(similarity(turning, still));
  EXPECT_FALSE(derived(derived_one, turning, still).surface.has_flexibility());
}

// Balls are in metres, so a mesh of another scale has them elsewhere.
TEST(Similar, bodies_have_the_same_refinement_and_scale) {
  KernelRequest had = request_of_ball({});
  had.body.refine = {{.at = {0, 0.1, 1}, .radius = 0.2, .size = 0.05}};
  seal(had);
  EXPECT_EQ(request_of({had.hash, had.toml, had.mesh_sha256}, "FILE").body.refine, had.body.refine);
  EXPECT_NE(had.hash, request_of_ball({}).hash);
  EXPECT_FALSE(similarity(had, request_of_ball({})));
  EXPECT_FALSE(similarity(request_of_ball({}), had));
  KernelRequest wanted = had;
  EXPECT_TRUE(similarity(had, wanted));
  wanted.body.scale = 2;
  EXPECT_FALSE(similarity(had, wanted));
}

TEST(Similar, bodies_of_several_materials_have_common_factors) {
  const auto with = [](const char* young) {
    return request_of_ball(
        {fmt::format("bodies.ball.material={{a={{density=1,young=3}},b={{density=2,young={}}}}}", young)});
  };
  const KernelRequest had = with("5");
  KernelRequest wanted = had;
  for (Material& material : wanted.body.materials) material.young *= 1.1;
  ASSERT_TRUE(similarity(had, wanted));
  EXPECT_DOUBLE_EQ(similarity(had, wanted)->young, 1.1);
  EXPECT_FALSE(similarity(had, with("6")));
}

TEST(Similar, bodies_have_proportional_laws_in_the_same_axes) {
  const auto with = [](const std::string& law) {
    return request_of_ball({"bodies.ball.material={density=1,poisson=[0.1,0.2,0.3]," + law + "}"});
  };
  const KernelRequest had = with("young=[3,2,1],shear=[1,1,1]");
  ASSERT_TRUE(similarity(had, with("young=[3.3,2.2,1.1],shear=[1.1,1.1,1.1]")));
  EXPECT_DOUBLE_EQ(similarity(had, with("young=[3.3,2.2,1.1],shear=[1.1,1.1,1.1]"))->young, 1.1);
  EXPECT_FALSE(similarity(had, with("young=[3.3,2.2,1.1],shear=[1,1,1]")));
  EXPECT_FALSE(similarity(had, with("young=[3,2,1],shear=[1,1,1],axes=[[0,1,0],[1,0,0]]")));
  EXPECT_FALSE(similarity(had, request_of_ball({"bodies.ball.material={density=1,young=3}"})));
  const auto of_21 = [](const std::string& last) {
    return request_of_ball(
        {"bodies.ball.material={density=1,stiffness=[3,1,1,0,0,0,3,1,0,0,0,3,0,0,0,1,0,0,1,0," + last +
         "]}"});
  };
  EXPECT_TRUE(similarity(of_21("1"), of_21("1")));
  EXPECT_FALSE(similarity(of_21("1"), of_21("1.01")));
}

// The line about which axes turn scales with the body.
TEST(Similar, bodies_of_another_size_have_the_centre_line_of_that_size) {
  const auto with = [](double scale, double place) {
    return request_of_ball(
        {fmt::format("bodies.ball.scale={}", scale), fmt::format("contact.spacing={}", 0.01 * scale),
         fmt::format("bodies.ball.material={{density=1,young=[3,2,1],shear=[1,1,1],poisson=[0,0,0],"
                     "about={{point=[{},0,0],direction=[0,0,1]}}}}",
                     place)});
  };
  EXPECT_TRUE(similarity(with(1, 0.3), with(2, 0.6)));
  EXPECT_FALSE(similarity(with(1, 0.3), with(2, 0.3)));
}

// A scene with a receiver and a load of each kind, and a kernel of them. Positions are in the axes of the
// body.
TEST(Similar, bodies_have_the_same_loads_and_receivers_at_places_that_scale) {
  const std::vector<Override> heard = {"output.receiver=[{name=\"mic\",body=\"ball\",at=[0.1,0,0.3]}]"};
  const std::vector<Override> all = {heard[0], "bodies.ball.support={foot=\"z\"}",
                                     "loads.traction=[{body=\"ball\",group=\"skin\",vector=[0,0,1]}]",
                                     "loads.point=[{body=\"ball\",at=[0,0,0.2],vector=[0,0,1]}]",
                                     "loads.motion=[{body=\"ball\",group=\"foot\",vector=[0,0,1]}]"};
  const auto with = [&](const Override& set, const std::vector<Override>& base) {
    std::vector<Override> sets = base;
    sets.push_back(set);
    return request_of_ball(sets);
  };
  const KernelRequest had = request_of_ball(all);
  EXPECT_EQ(request_of({had.hash, had.toml, had.mesh_sha256}, "FILE").toml, had.toml);
  for (const char* set : {"bodies.ball.damping={t60=[[100,2]]}", "bodies.ball.material.young=2e9",
                          "loads.point[0].vector=[1,0,0]"})
    EXPECT_TRUE(similarity(had, with(set, all))) << set;
  for (const char* set :
       {"output.receiver[0].name=other", "output.receiver[0].at=[0.1,0,0.2]", "loads.point[0].at=[0,0,0.1]",
        "loads.traction[0].name=other", "bodies.ball.scale=2", "output.receiver=[]", "loads={}"})
    EXPECT_FALSE(similarity(had, with(set, all))) << set;

  KernelRequest twice = had;
  twice.body.scale = 2;
  *twice.spacing *= 2;
  EXPECT_FALSE(similarity(had, twice));
  scale_places(twice, 2);
  EXPECT_EQ(twice.receivers[0].at, (Vector3{0.2, 0, 0.6}));
  EXPECT_TRUE(similarity(had, twice));
  scale_places(twice, 1.5);
  EXPECT_EQ(twice.receivers[0].at, (Vector3{0.3, 0, 0.9}));  // rounded: 1.5 · 0.2 is above 0.3
}

TEST(Derived, kernels_with_receivers_take_another_damping_and_keep_their_static_rows) {
  const Override heard = "output.receiver=[{name=\"mic\",body=\"ball\",at=[0.1,0,0.3]}]";
  const KernelRequest had = request_of_ball({heard}),
                      damped = request_of_ball({heard, "bodies.ball.damping={t60=[[100,2]]}"}),
                      bare = request_of_ball({heard, "modes.residual_flexibility=false"});
  Kernel kernel = kernel_of(had);
  const std::size_t n = kernel.modes.size();
  kernel.receivers = {{.name = "mic",
                       .point = {0.1, 0, 0.3},
                       .shape = std::vector<double>(3 * n, 0.5),
                       .residual_flexibility = std::vector<double>(3 * kernel.surface.size(), 1e-9),
                       .body_force_residual = std::vector<double>(9, 1e-6),
                       .load_residual = {},
                       .motion_residual = {}}};
  const Kernel found = derived(kernel, had, damped);
  EXPECT_EQ(found.receivers, kernel.receivers);
  EXPECT_EQ(found.surface.shape, kernel.surface.shape);
  for (const double rate : found.modes.decay_rate) EXPECT_NEAR(rate, std::log(1000) / 2, 1e-14);
  const Kernel without = derived(kernel, had, bare);
  validate(without, "the kernel");
  EXPECT_TRUE(without.receivers[0].residual_flexibility.empty());
}

TEST(Derived, damping_by_mode_needs_all_modes) {
  const KernelRequest had = request_of_ball(),
                      wanted = request_of_ball({"bodies.ball.damping={by_mode=[0.1]}"});
  Kernel kernel = kernel_of(had);
  EXPECT_NEAR(derived(kernel, had, wanted).modes.decay_rate[2], 0.05 * Bar{}.omega(3), 1e-13);
  kernel.modes.certificate.left_out = 1;
  EXPECT_THAT(complaint_of([&] { derived(kernel, had, wanted); }), HasSubstr("damping by mode"));
}

TEST(Derived, kernels_answer_the_new_request) {
  const Kernel kernel =
      derived_with({"bodies.ball.material.young=4e9", "bodies.ball.damping.ratio=0.01", "modes.up_to_hz=28"});
  const KernelRequest wanted = request_of_ball(
      {"bodies.ball.material.young=4e9", "bodies.ball.damping.ratio=0.01", "modes.up_to_hz=28"});
  EXPECT_EQ(kernel.hash, wanted.hash);
  EXPECT_EQ(kernel.scene, wanted.toml);
  EXPECT_EQ(kernel.body, "ball");
  EXPECT_FALSE(kernel.view);  // none, although the bar has one
  EXPECT_EQ(kernel.modes.size(), 40U);
  const Bar bar;
  EXPECT_THAT(kernel.modes.angular_frequency[3], DoubleNear(2 * bar.omega(4), 1e-12));
  EXPECT_THAT(kernel.modes.decay_rate[3], DoubleNear(0.02 * bar.omega(4), 1e-13));
}

// The area of a solid has no meaning. The patches of a rod have the area of its cross-section.
TEST(Derived, kernels_of_rods_keep_their_cross_section) {
  const auto masses = [](const char* area) {
    const KernelRequest had = request_of_ball({fmt::format("bodies.ball.material.area={}", area)});
    KernelRequest wanted = had;
    wanted.body.scale = 2;
    *wanted.spacing *= 2;
    wanted.modes.up_to->value /= 2;
    seal(wanted);
    const Kernel before = kernel_of(had);
    return derived(before, had, wanted).mass / before.mass;
  };
  EXPECT_DOUBLE_EQ(masses("0.3"), 2);  // as in the bar
  EXPECT_DOUBLE_EQ(masses("0.4"), 8);
}

TEST(Derived, kernels_hold_the_requested_modes) {
  const Bar bar;
  const auto modes = [](const char* wanted, const char* had = "title=any") {
    return derived_with({wanted}, {had}).modes.size();
  };
  EXPECT_EQ(modes("modes.up_to_hz=14.3"), 40U);  // above the first request, but still covered
  EXPECT_EQ(modes("modes.up_to_hz=7"), 19U);     // modes at (n - 1/2) 0.36 Hz
  EXPECT_EQ(modes("modes={count=7}"), 7U);
  EXPECT_EQ(modes("modes={count=7}", "modes={count=40}"), 7U);
  EXPECT_EQ(modes("modes={up_to_hz=7}", "modes={count=40}"), 19U);
  EXPECT_LT(modes("modes={up_to_hz=1.4,flexibility_error=0.1}"), 10U);
  EXPECT_EQ(modes("modes={up_to_hz=14,flexibility_error=1e-3}", "modes={up_to_hz=14,flexibility_error=1e-3}"),
            40U);
  EXPECT_EQ(modes("modes.relative_residual=1e-7"), 40U);
  const Kernel bare = derived_with({"modes.residual_flexibility=false"});
  EXPECT_TRUE(bare.surface.residual_flexibility.empty());
  EXPECT_TRUE(bare.loads.body_force_residual.empty());
}

TEST(Derived, kernels_do_not_hold_more_than_the_old_one) {
  EXPECT_THAT(refusal_of({"modes.up_to_hz=15"}), HasSubstr("has all modes up to 14.4"));
  EXPECT_THAT(refusal_of({"bodies.ball.material.young=5e8"}), HasSubstr("has all modes up to 10."));
  EXPECT_THAT(refusal_of({"modes={count=41}"}), HasSubstr("has 40 modes, fewer than 41"));
  EXPECT_THAT(refusal_of({"modes={up_to_hz=14,flexibility_error=1e-3}"}), HasSubstr("may cause an error"));
  EXPECT_THAT(refusal_of({"modes.relative_residual=1e-9"}), HasSubstr("computed with other settings"));
  EXPECT_THAT(refusal_of({}, {"modes.residual_flexibility=false"}), HasSubstr("no residual flexibility"));
  EXPECT_THAT(refusal_of({"modes={basis=\"contact\",up_to_hz=14}"}),
              HasSubstr("computed with other settings"));
  EXPECT_THAT(refusal_of({"bodies.ball.order=2"}), HasSubstr("another body"));
  const KernelRequest had = request_of_ball(), wanted = request_of_ball({"output.view=true"});
  Kernel kernel = kernel_of(had);
  kernel.view.reset();
  EXPECT_THAT(complaint_of([&] { derived(kernel, had, wanted); }), HasSubstr("has no visualisation surface"));
}

TEST(Derived, contact_adapted_bases_serve_the_same_band_of_a_similar_body) {
  const auto of = [](const char* young, const char* band) {
    return request_of_ball({fmt::format("bodies.ball.material.young={}", young),
                            fmt::format("modes={{basis=\"contact\",up_to_hz={}}}", band)});
  };
  const KernelRequest had = of("1e9", "5");
  Kernel kernel = kernel_of(had);
  kernel.modes.basis = "contact";
  EXPECT_EQ(derived(kernel, had, of("9e9", "15")).modes.size(), 40U);
  EXPECT_THAT(complaint_of([&] { derived(kernel, had, of("9e9", "14")); }), HasSubstr("another band"));
}

// One direction can be taken from all three components, but a basis adapted
// to all directions is not adapted to one.
TEST(Derived, kernels_in_one_direction_serve_no_other_and_those_in_all_serve_each) {
  const std::string open = changed(scene_text, "direction = [0, 0, -1]\n", "");
  const auto ask = [&](const std::string& text, const char* modes) {
    const Folder folder;
    folder.write("ball.msh", "a mesh");
    const Scene scene = read(folder.write("scene.toml", text), {modes});
    return kernel_request(scene, scene.bodies[0]);
  };
  for (const char* modes : {"modes={count=5}", "modes={basis=\"contact\",up_to_hz=14}",
                            "modes={up_to_hz=14,flexibility_error=1e-3}"}) {
    const KernelRequest all = ask(open, modes), one = ask(scene_text, modes);
    EXPECT_FALSE(similarity(one, all));
    ASSERT_TRUE(similarity(all, one));
    Kernel kernel = kernels::test::plain_kernel(3);
    kernel.modes.basis = all.modes.basis == Basis::contact ? "contact" : "modes";
    const auto derive = [&] { return derived(kernel, all, one); };
    if (all.modes.count)
      EXPECT_EQ(derive().surface.direction, one.direction);
    else
      EXPECT_THAT(complaint_of(derive),
                  ::testing::AnyOf(HasSubstr("direction"), HasSubstr("were truncated")));
  }
}

// Without friction, one direction is enough; with it, kernels of one direction do not serve.
TEST(Derived, kernels_with_friction_serve_scenes_without) {
  const auto ask = [&](const char* friction) {
    const Folder folder;
    folder.write("ball.msh", "a mesh");
    const Scene scene = read(folder.write("scene.toml", scene_text), {friction});
    return kernel_request(scene, scene.bodies[0]);
  };
  const KernelRequest rough = ask("contact.friction=0.3"), smooth = ask("contact.friction=0");
  ASSERT_TRUE(similarity(rough, smooth));
  EXPECT_FALSE(similarity(smooth, rough));
  KernelRequest along_normals = rough;
  along_normals.normal_residual = true;
  EXPECT_FALSE(similarity(along_normals, rough));
}

TEST(Derived, points_are_numbered_as_on_the_whole_surface) {
  KernelRequest whole = request_of_ball(), three = whole, one = whole;
  three.points = {3, 2, 1};
  one.points = {1};
  seal(three);
  seal(one);
  const Kernel cut = derived(kernel_of(whole), whole, three), again = derived(cut, three, one);
  EXPECT_THAT(again.surface.node, ::testing::ElementsAre(0.5 * 1.7, 0.4, 0));
  EXPECT_FALSE(similarity(three, whole));
  EXPECT_FALSE(similarity(one, three));
}

TEST(Derived, points_within_reach_keep_the_record_of_the_complete_surface) {
  const KernelRequest whole = request_of_ball();
  const auto near = [&](const std::vector<std::int64_t>& points, bool within_reach = true) {
    KernelRequest request = whole;
    request.points = points;
    request.within_reach = within_reach;
    seal(request);
    return request;
  };
  const KernelRequest three = near({1, 2, 3}), two = near({1, 3}), chosen = near({1, 2, 3}, false);
  EXPECT_NE(three.hash, chosen.hash);
  EXPECT_NE(three.hash, two.hash);
  const KernelRequest answered = request_of({three.hash, three.toml, three.mesh_sha256, {{1, 2, 3}}}, "FILE");
  EXPECT_EQ(answered.points, three.points);
  EXPECT_TRUE(answered.within_reach);

  const Kernel all = kernel_of(whole), cut = derived(all, whole, three), again = derived(cut, three, two);
  ASSERT_TRUE(again.surface.whole);
  EXPECT_EQ(again.surface.whole->node, all.surface.node);
  EXPECT_EQ(again.surface.whole->held, two.points);
  EXPECT_THAT(again.surface.node,
              ::testing::ElementsAreArray(derived(all, whole, near({1, 3}, false)).surface.node));
  EXPECT_FALSE(derived(cut, three, near({1, 3}, false)).surface.whole);
  EXPECT_FALSE(similarity(two, three));
  EXPECT_FALSE(similarity(chosen, two));  // this one has no record of its surface
}

TEST(Folders, hold_kernels_to_derive_from_among_other_files) {
  const Folder folder;
  const KernelRequest had = request_of_ball(), wanted = request_of_ball({"modes.up_to_hz=7"});
  EXPECT_FALSE(derive_from_any(folder.path(), wanted));
  EXPECT_FALSE(derive_from_any(folder / "not there", wanted));
  folder.write("a.kernel.h5", "torn");
  kernels::write(kernel_of(request_of_ball({"bodies.ball.order=2"})), folder / "b.kernel.h5");
  kernels::write(kernel_of(request_of_ball({"modes={count=3}", "modes.relative_residual=1e-3"})),
                 folder / "c.kernel.h5");
  EXPECT_FALSE(derive_from_any(folder.path(), wanted));
  kernels::write(kernel_of(had), folder / "d.kernel.h5");
  const auto found = derive_from_any(folder.path(), wanted);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->from, folder / "d.kernel.h5");
  EXPECT_EQ(found->kernel.hash, wanted.hash);
}

}  // namespace ricochet::scene::derive_test
