// SPDX-License-Identifier: BSD-2-Clause
// Warnings on the figures of a run, at both sides of each bound.
#include "src/impact/warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "src/impact/report.hpp"
#include "src/scene/scene.hpp"

namespace impact_warnings_test {

using namespace ricochet;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Figures {
  double lost = 0, restitution = 0.9, duration = 1e-3;
};

std::vector<std::string> warnings(const Figures& figures, const scene::Scene& scene = {}) {
  contact::Summary summary;
  summary.energy_lost_contact = figures.lost;
  summary.restitution = figures.restitution;
  summary.episodes = {{.start_s = 0, .end_s = figures.duration, .impulse_ns = 1, .peak_force_n = 1}};
  impact::add_warnings(scene, summary);
  return summary.warnings;
}

TEST(Energy, lost_to_contact_above_one_per_cent_is_warned_of) {
  EXPECT_THAT(warnings({.lost = 0.011}),
              ElementsAre(HasSubstr("contact removed 1.1 % of the energy (above 1 %)")));
  EXPECT_THAT(warnings({.lost = 0.009}), IsEmpty());
}

TEST(Energy, lost_within_the_accuracy_of_the_scene_is_not_warned_of) {
  scene::Scene scene;
  scene.accuracy = 0.1;
  EXPECT_THAT(warnings({.lost = 0.09}, scene), IsEmpty());
  EXPECT_THAT(warnings({.lost = 0.11}, scene), ElementsAre(HasSubstr("11 % of the energy (above 10 %)")));
}

TEST(Energy, that_the_impulse_scheme_removes_by_definition_is_not_warned_of) {
  scene::Scene scene;
  scene.contact.scheme = Scheme::impulse;
  EXPECT_THAT(warnings({.lost = 0.75, .restitution = 0.5}, scene), IsEmpty());
}

TEST(Restitution, outside_0_to_1_is_warned_of) {
  EXPECT_THAT(warnings({.restitution = 1.02}), ElementsAre(HasSubstr("restitution 1.02 is above 1")));
  EXPECT_THAT(warnings({.restitution = -0.02}), ElementsAre(HasSubstr("restitution -0.02 is below 0")));
  for (const double e : {-0.005, 0.0, 0.5, 1.0, 1.005}) EXPECT_THAT(warnings({.restitution = e}), IsEmpty());
}

// Touches of 1e-3 s at 0.1 m/s, of a spring: 3.18e-5 m deep, of which 25 % are 8e-6 m.
TEST(Obstacles, with_triangles_off_their_drawing_by_more_than_a_share_of_the_indentation_are_warned_of) {
  contact::Summary summary;
  summary.episodes = {{.start_s = 0.5, .end_s = 0.501, .approach_m_per_s = 0.1}};
  summary.touches = {{.start_s = 0.5, .end_s = 0.501, .a = "ball", .b = "anvil"}};
  scene::Obstacle anvil;
  anvil.name = "anvil";
  const auto found = [&](double deviation) {
    scene::Scene scene;
    anvil.deviation = deviation;
    scene.obstacles = {anvil};
    contact::Summary made = summary;
    impact::add_warnings(scene, made);
    return made.warnings;
  };
  EXPECT_THAT(found(1e-5),
              ElementsAre(HasSubstr("the triangles of obstacles.anvil are up to 1e-05 m from its "
                                    "drawing, 31 % of the indentation of about 3.2e-05 m")));
  EXPECT_THAT(found(7e-6), IsEmpty());
  summary.touches[0].b = "another";
  EXPECT_THAT(found(1e-5), IsEmpty());
}

TEST(Touches, of_fewer_than_twenty_steps_are_warned_of) {
  EXPECT_THAT(warnings({.duration = 19 / 44100.0}), ElementsAre(HasSubstr("the longest touch has 19 steps")));
  EXPECT_THAT(warnings({.duration = 20 / 44100.0}), IsEmpty());
}

// Elastic bodies keep their energy; with friction, all but its heat.
TEST(Energy, lost_to_contact_is_told_from_the_heat_of_friction) {
  contact::Summary summary;
  summary.energy_lost_contact = 0.02;
  summary.energy_lost_friction = 0.4;
  impact::add_warnings({}, summary);
  EXPECT_THAT(summary.warnings,
              ElementsAre(HasSubstr("which elastic bodies keep but for the heat of friction: ")));
  summary.warnings.clear();
  summary.energy_lost_contact = 0.001;
  impact::add_warnings({}, summary);
  EXPECT_THAT(summary.warnings, IsEmpty());
}

TEST(Steps, with_several_solutions_are_counted) {
  contact::Summary summary;
  summary.contact_steps = 40;
  summary.ambiguous_steps = 3;
  impact::add_warnings({}, summary);
  EXPECT_THAT(summary.warnings, ElementsAre(HasSubstr("3 of 40 contact steps had more than one solution")));
  summary.warnings.clear();
  summary.ambiguous_steps = 0;
  impact::add_warnings({}, summary);
  EXPECT_THAT(summary.warnings, IsEmpty());
}

// A bounce during which the surfaces open once and meet again, by vibration, while the bodies part.
TEST(Episodes, state_what_each_of_them_is) {
  contact::Summary summary;
  summary.contact_start_s = 0;
  summary.contact_end_s = 3;
  summary.restitution = 0.97;
  summary.episodes = {{.start_s = 0, .end_s = 1, .approach_m_per_s = 1.094, .restitution = 0.9746},
                      {.start_s = 2, .end_s = 3, .approach_m_per_s = -1.065}};
  const std::string text = impact::report(summary, {});
  EXPECT_THAT(text, HasSubstr("0.97, from the first touch to the last\n"));
  EXPECT_THAT(text,
              HasSubstr("1: approach 1.094 m/s, restitution 0.9746; 2: again by vibration, while parting at "
                        "1.065 m/s\n"));
  summary.episodes[1].approach_m_per_s.reset();
  EXPECT_THAT(impact::report(summary, {}), HasSubstr("; 2: several pairs, or an obstacle that turns\n"));
  summary.episodes.pop_back();
  EXPECT_THAT(impact::report(summary, {}), HasSubstr("0.97\n"));
}

// Under gravity a body may rest on another one: only if it parts is the run too short.
TEST(Contact, that_does_not_end_is_warned_of_unless_loads_press) {
  scene::Scene scene;
  contact::Summary summary;
  const auto warnings = [&] {
    summary.warnings.clear();
    impact::add_warnings(scene, summary);
    return summary.warnings;
  };
  EXPECT_THAT(warnings(), IsEmpty());  // nothing touched
  summary.contact_start_s = 0;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("they do not part soon afterwards")));
  scene.loads.gravity = {0, 0, -9.81};
  EXPECT_THAT(warnings(), IsEmpty());
  summary.parted_s = 0.00301;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("parted at t = 0.00301 s. Set time.duration = 0.0031")));
  summary.contact_end_s = 0.002;
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST(Contact, that_does_not_end_within_the_longest_run_is_warned_of_even_if_loads_press) {
  scene::Scene scene;
  scene.time.until_parted = true;
  scene.time.duration = 0.5;
  contact::Summary summary;
  summary.contact_start_s = 0;
  const auto warnings = [&] {
    summary.warnings.clear();
    impact::add_warnings(scene, summary);
    return summary.warnings;
  };
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("Set a longer time.longest")));
  scene.loads.gravity = {0, 0, -9.81};
  EXPECT_THAT(warnings(),
              ElementsAre(HasSubstr("until time.longest = 0.5 s. Give time.duration in seconds")));
  summary.parted_s = 0.61;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("parted at t = 0.61 s. Set time.longest = 0.61")));
}

TEST(ObstaclesThatMove, without_friction_are_warned_of) {
  scene::Scene scene;
  for (const char* name : {"belt", "floor", "table"})
    scene.obstacles.push_back({{.name = name, .normal = {0, 0, 1}}});
  scene.obstacles[0].velocity = {1, 0, 0};
  scene.loads.motions.emplace_back().obstacle = "table";
  scene.contact.pairs.resize(2);
  scene.contact.pairs[0].a = scene.contact.pairs[1].a = "box";
  scene.contact.pairs[0].b = "belt";
  scene.contact.pairs[1].b = "table";
  EXPECT_THAT(impact::motions_without_friction(scene),
              ElementsAre(HasSubstr("obstacles.belt moves along its surface, which has no effect without "
                                    "friction: give contact.friction, or leave velocity out"),
                          HasSubstr("obstacles.table moves along its surface")));
  scene.contact.pairs[0].friction = Friction{0.3, 0.3, 0};
  EXPECT_THAT(impact::motions_without_friction(scene), ElementsAre(HasSubstr("obstacles.table")));
}

}  // namespace impact_warnings_test
