// SPDX-License-Identifier: BSD-2-Clause
// Decisions of the accuracy loop after a round with given shares of the error.
#include "src/accuracy/decision.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "src/accuracy/mesh_levels.hpp"
#include "src/scene/scene.hpp"

namespace decision_test {

using namespace ricochet;
using accuracy::BodySize;
using accuracy::decide;
using accuracy::Decision;
using contact::Cause;
using ::testing::HasSubstr;

/// A scene with one body of a geometry, of which everything is open.
scene::Scene open_scene() {
  scene::Scene scene;
  scene.accuracy = 1e-2;
  scene.bodies.emplace_back();
  scene.bodies[0].name = "part";
  scene.bodies[0].mesh = "part.step";
  scene.bodies[0].order_open = scene.bodies[0].size_open = true;
  scene.contact.pairs.emplace_back();
  return scene;
}

/// Settings of the second round.
accuracy::Settings second_round(const scene::Scene& scene) {
  accuracy::Settings settings;
  settings.found.mesh = accuracy::meshes_at(scene, 1);
  settings.found.up_to = Hertz{1e4};
  settings.found.flexibility_error = 0.1;
  settings.rate = Hertz{1e6};
  return settings;
}

contact::Dialled round_with(const std::map<Cause, double>& shares) {
  contact::Dialled round;
  round.estimate.emplace();
  round.estimate->requested = {Quantity::impulse};
  for (const auto& [cause, share] : shares)
    round.estimate->by_cause[cause] = contact::Errors{{Quantity::impulse, share}};
  return round;
}

std::vector<BodySize> body_of(double modes, double unknowns) {
  return {{.body = "part", .modes = modes, .vectors = modes, .unknowns = unknowns}};
}

const std::vector<BodySize> small = body_of(100, 1e4);

TEST(Decision, ends_if_the_accuracy_is_met) {
  const scene::Scene scene = open_scene();
  const Decision found =
      decide(scene, second_round(scene), round_with({{Cause::mesh, 4e-3}, {Cause::modes, 5e-3}}), small);
  EXPECT_FALSE(found.next);
  EXPECT_EQ(found.reason, "");
}

TEST(Decision, refines_the_cause_with_the_largest_share) {
  const scene::Scene scene = open_scene();
  const accuracy::Settings settings = second_round(scene);
  const Decision band =
      decide(scene, settings, round_with({{Cause::mesh, 1e-3}, {Cause::modes, 0.1}}), small);
  ASSERT_TRUE(band.next);
  EXPECT_EQ(band.reason, "modes");
  EXPECT_EQ(band.next->found.up_to.value, 2e4);
  EXPECT_EQ(band.next->found.mesh, settings.found.mesh);
  // An order is expected to leave a quarter of the share: one brings 0.015 to half of 0.01, and not 0.1.
  for (const auto& [share, level] : {std::pair(0.015, 2), std::pair(0.1, 3)}) {
    const Decision mesh =
        decide(scene, settings, round_with({{Cause::mesh, share}, {Cause::modes, 1e-3}}), small);
    ASSERT_TRUE(mesh.next);
    EXPECT_EQ(mesh.reason, "mesh");
    EXPECT_EQ(mesh.next->found.mesh, accuracy::meshes_at(scene, level));
  }
}

// A pilot whose share of the mesh is small keeps its elements, however coarse they are.
TEST(Decision, ends_with_the_pilot_if_it_meets_the_accuracy) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.found.mesh = accuracy::meshes_at(scene, 0);
  settings.pilot = true;
  const Decision met =
      decide(scene, settings, round_with({{Cause::mesh, 4e-3}, {Cause::modes, 5e-3}}), small);
  EXPECT_FALSE(met.next);
  EXPECT_EQ(met.reason, "");
}

TEST(Decision, keeps_a_given_band_and_says_that_it_prevents_the_accuracy) {
  scene::Scene scene = open_scene();
  scene.modes.up_to = Hertz{1e4};
  const Decision found =
      decide(scene, second_round(scene), round_with({{Cause::mesh, 1e-3}, {Cause::modes, 0.1}}), small);
  EXPECT_FALSE(found.next);
  EXPECT_EQ(found.reason, "modes contributes 0.1: modes.up_to_hz = 10000 is given");
}

// A given spacing contributes 0.014 of 0.02: a finer mesh could not reach 0.01, and hardly helps.
TEST(Decision, refines_nothing_that_matters_less_than_what_is_given) {
  scene::Scene scene = open_scene();
  scene.contact.pairs[0].spacing = 1e-3;
  const accuracy::Settings settings = second_round(scene);
  const Decision found =
      decide(scene, settings, round_with({{Cause::mesh, 6e-3}, {Cause::spacing, 0.014}}), small);
  EXPECT_FALSE(found.next);
  EXPECT_EQ(found.reason, "spacing contributes 0.014: contact.spacing is given");
  // Nor the band of a pilot, which would be doubled.
  accuracy::Settings first = settings;
  first.pilot = true;
  auto pilot = round_with({{Cause::modes, 6e-3}, {Cause::spacing, 0.014}});
  pilot.quantities.emplace();
  pilot.quantities->force = {0, 1, 0, 0};
  EXPECT_FALSE(decide(scene, first, pilot, small).next);
  const Decision coarse =
      decide(scene, settings, round_with({{Cause::mesh, 6e-2}, {Cause::spacing, 0.014}}), small);
  EXPECT_TRUE(coarse.next);
}

// Twice the band of a solid has eight times the modes: 8 · 300 modes of 48 000 unknowns are affordable, and
// 8 · 320 are not.
TEST(Decision, starts_no_round_that_is_too_much_work) {
  const scene::Scene scene = open_scene();
  const auto round = round_with({{Cause::mesh, 1e-4}, {Cause::modes, 0.1}});
  const auto modes_of = [&](double modes) {
    accuracy::Settings settings = second_round(scene);
    settings.found.basis = scene::Basis::modes;
    return decide(scene, settings, round, body_of(modes, 48000));
  };
  EXPECT_TRUE(modes_of(300).next);
  const Decision found = modes_of(320);
  EXPECT_FALSE(found.next);
  EXPECT_THAT(found.reason, HasSubstr("modes contributes 0.1: the next round would compute about 3e+03 modes "
                                      "of 5e+04 unknowns of \"part\""));
}

// From order 3 to 4, a solid has (4/3)³ times the unknowns, and its surface (4/3)² times the candidates: 1156
// Ritz vectors of 94 815 unknowns are affordable, and 1333 are not.
TEST(Decision, counts_the_vectors_of_new_candidates_as_work) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.found.basis = scene::Basis::contact;
  const auto round = round_with({{Cause::mesh, 0.1}});
  EXPECT_TRUE(decide(scene, settings, round, body_of(650, 4e4)).next);
  EXPECT_FALSE(decide(scene, settings, round, body_of(750, 4e4)).next);
}

// 8 · 500 modes are more than half of 3000 unknowns, and 8 · 180 are not.
TEST(Decision, refines_the_mesh_with_a_band_that_its_elements_do_not_have) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.found.basis = scene::Basis::modes;
  const auto round = round_with({{Cause::mesh, 1e-4}, {Cause::modes, 0.1}});
  const Decision found = decide(scene, settings, round, body_of(500, 3000));
  ASSERT_TRUE(found.next);
  EXPECT_EQ(found.reason, "mesh, modes");
  // Half of 3000 (4/3)³ unknowns are less than 8 · 500 modes, and those of elements smaller by √2 are more.
  EXPECT_EQ(found.next->found.mesh, accuracy::meshes_at(scene, 3));
  EXPECT_EQ(decide(scene, settings, round, body_of(180, 3000)).reason, "modes");
}

/// The decision after rounds with these errors by the mesh, in succession.
Decision after_rounds(const std::vector<double>& errors) {
  const scene::Scene scene = open_scene();
  Decision found{second_round(scene), ""};
  std::vector<BodySize> sizes = small;
  for (const double error : errors) {
    ++sizes[0].elements;
    found = decide(scene, found.next.value(), round_with({{Cause::mesh, error}}), sizes);
  }
  return found;
}

// 0.06 is below 0.7 · 0.1, and 0.08 is not.
TEST(Decision, ends_after_two_rounds_that_have_hardly_reduced_the_error) {
  EXPECT_TRUE(after_rounds({0.1, 0.12}).next);
  for (const std::vector<double>& errors :
       {std::vector{0.1, 0.12, 0.08}, std::vector{0.1, 0.06, 0.07, 0.05}}) {
    const Decision found = after_rounds(errors);
    EXPECT_FALSE(found.next);
    EXPECT_EQ(found.reason, fmt::format("2 rounds have not reduced the error of {:g} to 0.7 of it",
                                        *std::ranges::min_element(errors.begin(), errors.end() - 2)));
  }
  EXPECT_TRUE(after_rounds({0.1, 0.12, 0.06}).next);
  EXPECT_EQ(after_rounds({0.1, 0.12, 0.009}).reason, "");
}

// After a round without effect, nothing supports the expectation that two orders at once would have more.
TEST(Decision, goes_on_by_single_levels_after_a_round_that_has_not_reduced_the_error) {
  const scene::Scene scene = open_scene();
  EXPECT_EQ(after_rounds({0.1}).next.value().found.mesh, accuracy::meshes_at(scene, 3));
  EXPECT_EQ(after_rounds({0.1, 0.05}).next.value().found.mesh, accuracy::meshes_at(scene, 5));
  EXPECT_EQ(after_rounds({0.1, 0.12}).next.value().found.mesh, accuracy::meshes_at(scene, 4));
}

// The same impact ends its search where it has ended. Another one with the same bodies has its own history.
TEST(Decision, repeats_the_end_of_a_search_of_the_same_impact_alone) {
  const scene::Scene scene = open_scene();
  accuracy::Settings stored = second_round(scene);
  stored.error = 0.08;
  stored.least_error = 0.1;
  stored.idle_rounds = 1;
  const auto after = [&](double error) {
    return decide(scene, stored, round_with({{Cause::mesh, error}}), small);
  };
  EXPECT_FALSE(after(0.0801).next);
  EXPECT_TRUE(after(0.3).next);
}

TEST(Meshes, keep_given_elements_near_contact) {
  scene::Scene scene = open_scene();
  scene.bodies[0].refine = {{.radius = 1e-3, .size = 1e-4}};
  EXPECT_EQ(accuracy::meshes_at(scene, 2).at("part").refine, scene.bodies[0].refine);
}

TEST(Meshes, of_open_sizes_shrink_after_order_4_and_those_of_own_sizes_end_with_order_5) {
  const scene::Scene scene = open_scene(), own = accuracy::with_own_sizes(scene);
  const auto rise = [](const scene::Scene& of) {
    std::vector<std::pair<int, double>> out;
    for (int level = 0; level < 9; ++level) {
      const accuracy::MeshSettings mesh = accuracy::meshes_at(of, level).at("part");
      out.emplace_back(mesh.order, mesh.size_factor);
    }
    return out;
  };
  const double root = std::sqrt(2.0);
  const std::vector<std::pair<int, double>> shrinking{{2, 2},        {3, 2},   {4, 2},   {4, root}, {4, 1},
                                                      {4, 1 / root}, {4, 0.5}, {4, 0.5}, {4, 0.5}},
      rising{{2, 1}, {3, 1}, {4, 1}, {5, 1}, {5, 1}, {5, 1}, {5, 1}, {5, 1}, {5, 1}};
  EXPECT_EQ(rise(scene), shrinking);
  EXPECT_EQ(rise(own), rising);
}

// A transfinite geometry has the same elements whatever the size, so that only their order is finer.
TEST(Decision, raises_the_order_where_smaller_elements_were_not_made) {
  scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.found.mesh = accuracy::meshes_at(scene, 3);
  settings.elements_before["part"] = 500;
  auto round = round_with({{Cause::modes, 1e-4}});
  round.estimate->by_cause[Cause::mesh] = std::nullopt;  // nothing has been compared
  std::vector<BodySize> sizes = body_of(100, 1e4);
  sizes[0].elements = 1000;
  const Decision made = decide(scene, settings, round_with({{Cause::mesh, 0.1}}), sizes);
  ASSERT_TRUE(made.next);
  EXPECT_EQ(made.next->found.mesh.at("part").order, 4);
  settings.elements_before["part"] = 1000;
  const Decision fixed = decide(scene, settings, round, sizes);
  ASSERT_TRUE(fixed.next);
  EXPECT_EQ(fixed.reason, "mesh");
  EXPECT_EQ(fixed.next->found.mesh.at("part").order, 5);
  EXPECT_EQ(fixed.next->found.mesh.at("part").size_factor, settings.found.mesh.at("part").size_factor);
}

// Elements of a rod resolve half as many modes as they have unknowns. Twice the band has 140 modes, which 388
// unknowns of elements of a quarter of the size resolve; where the geometry fixes the elements, the highest
// order has 194.
TEST(Decision, resolves_the_wider_band_of_a_rod) {
  scene::Scene scene = open_scene();
  scene.bodies[0].materials.emplace_back().area = 1;
  accuracy::Settings settings = second_round(scene);
  settings.found.mesh["part"] = {.order = 4};
  const auto round = round_with({{Cause::modes, 0.1}});
  const auto mesh_after = [&](double modes) {
    std::vector<BodySize> rod = body_of(modes, 97);
    rod[0].dimension = 1;
    rod[0].elements = 24;
    const Decision found = decide(scene, settings, round, rod);
    EXPECT_TRUE(found.next) << found.reason;
    if (!found.next) return accuracy::MeshSettings{};
    EXPECT_EQ(found.next->found.up_to.value, 2 * settings.found.up_to.value);
    return found.next->found.mesh.at("part");
  };
  EXPECT_EQ(mesh_after(24), settings.found.mesh.at("part"));
  EXPECT_EQ(mesh_after(70), (accuracy::MeshSettings{.order = 4, .size_factor = 0.25}));
  settings.elements_before["part"] = 24;
  EXPECT_EQ(mesh_after(70), (accuracy::MeshSettings{.order = 8}));
}

TEST(Decision, claims_nothing_while_a_share_is_unknown) {
  scene::Scene scene = open_scene();
  scene.bodies[0].mesh = "part.msh";
  scene.bodies[0].order_open = scene.bodies[0].size_open = false;
  accuracy::Settings settings = second_round(scene);
  settings.found.mesh.clear();
  auto round = round_with({{Cause::modes, 1e-4}});
  round.estimate->by_cause[Cause::mesh] = std::nullopt;
  const Decision found = decide(scene, settings, round, small);
  EXPECT_FALSE(found.next);
  EXPECT_EQ(found.reason, "the share of the mesh is unknown: the mesh is read as it is");
}

// 69 candidates need 207 Ritz vectors: fewer than 1348 modes, however few vectors the round had. 150 modes
// are cheaper.
TEST(Decision, compares_ritz_vectors_of_the_next_round_with_the_modes_of_its_band) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.pilot = true;
  contact::Dialled round = round_with({{Cause::mesh, 0.1}});
  round.quantities.emplace();
  round.model.gap.setZero(69);
  std::vector<BodySize> sizes = body_of(1348, 1e4);
  sizes[0].vectors = 24;
  const auto basis = [&] { return decide(scene, settings, round, sizes).next.value().found.basis; };
  EXPECT_EQ(basis(), scene::Basis::contact);
  sizes[0].modes = 150;
  EXPECT_EQ(basis(), scene::Basis::modes);
}

/// The settings after a pilot with 40 candidates, whose contact lasts for 1 ms with a longest touch [s].
accuracy::Settings after_pilot_with_touch(double longest, double share_of_modes = 1e-4) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  settings.pilot = true;
  contact::Dialled round = round_with({{Cause::mesh, 0.1}, {Cause::modes, share_of_modes}});
  round.quantities.emplace();
  round.quantities->longest_touch = longest;
  round.quantities->figures[Quantity::duration] = {.value = contact::Vector::Constant(1, 1e-3),
                                                   .scale = 1e-3};
  round.quantities->force.assign(64, 0);
  round.quantities->force[1] = 1;  // a pulse, which fills any band
  round.model.gap.setZero(40);
  return decide(scene, settings, round, body_of(1000, 1e4)).next.value();
}

// Ritz vectors are fewer than 1000 modes, but ring at frequencies of their own when the body lands again.
TEST(Decision, chooses_modes_where_touches_repeat) {
  EXPECT_EQ(after_pilot_with_touch(0.8e-3).found.basis, scene::Basis::contact);
  EXPECT_EQ(after_pilot_with_touch(0.7e-3).found.basis, scene::Basis::modes);
}

// Twice the band of a solid has eight times the modes, and twice the Ritz vectors.
TEST(Decision, doubles_the_band_of_modes_of_a_solid_once_and_that_of_ritz_vectors_twice) {
  EXPECT_EQ(after_pilot_with_touch(0.8e-3, 0.1).found.up_to.value, 4e4);
  EXPECT_EQ(after_pilot_with_touch(0.7e-3, 0.1).found.up_to.value, 2e4);
}

// The poles of spheres of coarse elements, and means of patches at edges, lie farther apart than in the
// drawing.
TEST(Decision, refines_the_mesh_where_bodies_miss_each_other_by_less_than_a_candidate) {
  const scene::Scene scene = open_scene();
  accuracy::Settings settings = second_round(scene);
  contact::Dialled round;
  round.quantities.emplace();
  round.quantities->missed_by = 2e-4;
  round.quantities->spacing_there = 1e-3;
  const Decision near = decide(scene, settings, round, small);
  ASSERT_TRUE(near.next);
  EXPECT_EQ(near.reason, "mesh (nothing touches, by 0.0002 m at candidates 0.001 m apart)");
  EXPECT_EQ(near.next->found.mesh, accuracy::meshes_at(scene, 2));
  // A gap of curvature, which falls with the square of the element, halves from 1 to 1/√2 of its size.
  round.quantities->missed_by = 1e-4;
  EXPECT_TRUE(decide(scene, *near.next, round, small).next);
  // 1.5e-4 of the surfaces and 5e-5 of curvature become 1.5e-4 and 2.5e-5.
  round.quantities->missed_by = 1.75e-4;
  const Decision there = decide(scene, *near.next, round, small);
  EXPECT_FALSE(there.next);
  EXPECT_THAT(there.reason, HasSubstr("finer elements bring them no nearer"));
  round.quantities->missed_by = 2e-3;
  const Decision far = decide(scene, settings, round, small);
  EXPECT_FALSE(far.next);
  EXPECT_THAT(far.reason, HasSubstr("nothing touches"));
}

/// Of a body that turns, whose kernel holds these candidates.
Decision after_pilot_of_turning(double candidates, bool turns = true) {
  scene::Scene scene = open_scene();
  if (turns) scene.motion.rotation = Rotation::finite;
  accuracy::Settings settings = second_round(scene);
  settings.pilot = true;
  contact::Dialled round = round_with({{Cause::mesh, 0.1}});
  round.quantities.emplace();
  round.quantities->nearer = 1e-5;
  round.quantities->pressed.assign(40, false);
  round.quantities->pressed[0] = true;
  round.model.gap = contact::Vector::LinSpaced(40, 0, 1);
  round.model.area = contact::Vector::Ones(40);
  kernels::Kernel kernel;
  kernel.surface.area.assign(40, 1.0);
  contact::Bodies::Block& body = round.model.bodies.emplace_back();
  body.name = "part";
  body.kernel = &kernel;
  body.rotation.setIdentity();
  body.translation.setZero();
  round.model.point_a = round.model.point_b = contact::Matrix::Zero(40, 3);
  round.model.pairs.push_back({.first_point = 0, .points = 40, .a = 0, .b = -1, .reach = {}});
  std::vector<BodySize> sizes = body_of(1000, 1e4);
  sizes[0].candidates = candidates;
  return decide(scene, settings, round, sizes);
}

// 120 Ritz vectors for 40 candidates would be cheaper than 1000 modes, and a zone holds a few of them.
TEST(Decision, gives_bodies_that_turn_modes_and_all_of_their_candidates) {
  const Decision turning = after_pilot_of_turning(40), fixed = after_pilot_of_turning(0, false);
  ASSERT_TRUE(turning.next && fixed.next);
  EXPECT_EQ(turning.next->found.basis, scene::Basis::modes);
  EXPECT_FALSE(turning.next->found.zone);
  EXPECT_EQ(fixed.next->found.basis, scene::Basis::contact);
  EXPECT_TRUE(fixed.next->found.zone);
}

// From order 3 to 4, 1200 candidates become 2133, and 1100 become 1956.
TEST(Decision, starts_no_round_with_too_many_candidates_of_a_body_that_turns) {
  scene::Scene scene = open_scene();
  scene.motion.rotation = Rotation::finite;
  const auto found = [&](double candidates) {
    std::vector<BodySize> sizes = small;
    sizes[0].candidates = candidates;
    return decide(scene, second_round(scene), round_with({{Cause::mesh, 0.1}}), sizes);
  };
  EXPECT_TRUE(found(1100).next);
  EXPECT_FALSE(found(1200).next);
  // Of two bodies, 600 become 1067, and those of a given mesh stay: both count.
  std::vector<BodySize> two = small;
  two[0].candidates = 600;
  two.push_back(two[0]);
  two[1].body = "other";
  EXPECT_TRUE(decide(scene, second_round(scene), round_with({{Cause::mesh, 0.1}}), two).next);
  two[1].candidates = 1200;
  EXPECT_FALSE(decide(scene, second_round(scene), round_with({{Cause::mesh, 0.1}}), two).next);
  EXPECT_THAT(found(1200).reason, HasSubstr("the response to 2e+03 candidates"));
}

// The same for candidates that face an obstacle. A wider band adds none, so that many may stay.
TEST(Decision, starts_no_round_with_too_many_candidates_that_a_higher_order_makes) {
  const scene::Scene scene = open_scene();
  const auto found = [&](int candidates, Cause cause) {
    contact::Dialled round = round_with({{cause, 0.1}});
    round.model.gap = contact::Vector::LinSpaced(candidates, 0, 1);
    round.model.pairs.push_back({.first_point = 0, .points = candidates, .a = 0, .b = -1, .reach = {}});
    return decide(scene, second_round(scene), round, small);
  };
  EXPECT_TRUE(found(1100, Cause::mesh).next);
  EXPECT_FALSE(found(1200, Cause::mesh).next);
  EXPECT_THAT(found(1200, Cause::mesh).reason, HasSubstr("the response to 2e+03 candidates"));
  EXPECT_TRUE(found(2500, Cause::modes).next);
}

// Without a zone, the next kernels hold the candidates that are out of reach, too.
TEST(Decision, counts_the_candidates_of_the_whole_surface_without_a_zone) {
  const scene::Scene scene = open_scene();
  contact::Dialled round = round_with({{Cause::mesh, 0.1}});
  round.model.gap = contact::Vector::LinSpaced(40, 0, 1);
  round.model.pairs.push_back({.first_point = 0, .points = 40, .a = 0, .b = -1, .reach = {}});
  kernels::Kernel kernel;
  round.model.bodies.emplace_back().kernel = &kernel;
  accuracy::Settings settings = second_round(scene);
  const auto found = [&](std::size_t all) {
    kernel.surface.area.assign(all, 1.0);
    return decide(scene, settings, round, small).next.has_value();
  };
  EXPECT_TRUE(found(1100));
  EXPECT_FALSE(found(1200));
  settings.found.zone = 2;
  EXPECT_TRUE(found(1200));
}

// Finer elements reduce the distance of coarse patches from points that move. Without any, the share stays.
TEST(Decision, reduces_the_share_of_rotation_with_the_elements) {
  scene::Scene scene = open_scene();
  const auto round = round_with({{Cause::mesh, 1e-3}, {Cause::spacing, 1e-3}, {Cause::rotation, 0.1}});
  EXPECT_EQ(decide(scene, second_round(scene), round, small).reason, "mesh");
  scene.bodies[0].order_open = scene.bodies[0].size_open = false;
  const Decision fixed = decide(scene, second_round(scene), round, small);
  EXPECT_FALSE(fixed.next);
  EXPECT_THAT(fixed.reason, HasSubstr("rotation contributes 0.1: "));
}

}  // namespace decision_test
