// SPDX-License-Identifier: BSD-2-Clause
// The summary of a run compared with the mechanics of two rods: contact lasts 2L/c,
// and the rods exchange their velocities.
#include "contact/figures/summary_observer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "contact/figures/quantities.hpp"
#include "contact/files/summary_file.hpp"
#include "contact/table/table_stepper.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/rigid_plate.hpp"
#include "tests/contact/rod_tables.hpp"
#include "tests/contact/sliding.hpp"
#include "tests/support.hpp"

namespace summary_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ::testing::SizeIs;

constexpr double length = 10, step = 0.01;

Model rods(const Kernel& kernel, double gap) {
  return build_model({{"left", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                      {"right", &kernel, Matrix3d::Identity(), {length + gap, 0, 0}}},
                     {}, {{"left", "right", Vector3d(1, 0, 0), {}, {}}}, Vector3d::Zero());
}

Summary run(const Model& model, double duration, double wave_speed = 0, double restitution = -1,
            double dt = step) {
  StepOptions options{.step = dt};
  if (restitution >= 0)
    options = {.contact = {.scheme = Scheme::impulse, .restitution = restitution}, .step = dt};
  const auto stepper = make_stepper(model, options);
  SummaryObserver observer(model, dt, wave_speed);
  for (long k = std::lround(duration / dt); k > 0; --k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  return observer.summary();
}

double largest_force(const Model& model, double duration) {
  const auto stepper = make_stepper(model, {.step = step});
  double largest = 0;
  for (long k = std::lround(duration / step); k > 0; --k) {
    stepper->step();
    largest = std::max(largest, stepper->force().sum());
  }
  return largest;
}

TEST(Summary, of_two_rods_is_what_waves_give) {
  const Kernel kernel = rod(100, length);
  const Summary s = run(rods(kernel, 0.005), 30);
  ASSERT_TRUE(s.contact_start_s && s.contact_end_s && s.restitution);
  EXPECT_DOUBLE_EQ(*s.contact_start_s, 0);  // a gap of 0.005 m closes at 1 m/s within the first step
  EXPECT_NEAR(*s.contact_end_s, 20, 0.3);   // 2L/c, blurred by about the period of the highest of 100 modes
  EXPECT_NEAR(s.impulse_ns, 10, 0.05);      // the entire momentum
  EXPECT_EQ(s.peak_force_n, largest_force(rods(kernel, 0.005), 30));
  EXPECT_GT(s.peak_force_n, 0.5);  // Z v/2 is the mean force
  EXPECT_NEAR(*s.restitution, 1, 0.01);
  EXPECT_NEAR(s.exit_velocity.at("left").x(), 0, 0.005);
  EXPECT_NEAR(s.exit_velocity.at("right").x(), 1, 0.005);
  EXPECT_LT(s.energy_drift, 1e-12);  // round-off of 3000 steps
  EXPECT_LT(s.energy_lost_contact, 0.01);
  EXPECT_LT(s.max_penetration_m, 1e-12);
  EXPECT_EQ(s.modes.at("left"), 100);
  EXPECT_EQ(s.basis.at("left"), "modes");
  EXPECT_EQ(s.candidates, 1);
  EXPECT_EQ(s.unpaired, 1);
  EXPECT_EQ(s.max_active, 1);
  EXPECT_FALSE(s.error_estimate);
  EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("is not resolved"), HasSubstr("times the end of the band")));
  double impulse = 0;
  for (const Episode& episode : s.episodes) impulse += episode.impulse_ns;
  EXPECT_NEAR(impulse, s.impulse_ns, 1e-12);
  EXPECT_EQ(s.episodes.back().end_s, s.contact_end_s);
}

TEST(Summary, of_a_run_that_ends_in_contact_has_no_end) {
  const Kernel kernel = rod(100, length);
  const Summary s = run(rods(kernel, 0.005), 10);
  EXPECT_TRUE(s.contact_start_s);
  EXPECT_FALSE(s.contact_end_s);
  EXPECT_FALSE(s.episodes.back().end_s);
  EXPECT_FALSE(s.restitution);
  EXPECT_THAT(s.exit_velocity, IsEmpty());
}

TEST(Summary, of_bodies_that_miss_has_no_contact) {
  const Kernel kernel = rod(10, length);
  const Summary s = run(rods(kernel, 5), 4);
  EXPECT_FALSE(s.contact_start_s);
  EXPECT_FALSE(s.contact_end_s);
  EXPECT_THAT(s.episodes, IsEmpty());
  EXPECT_EQ(s.impulse_ns, 0);
  EXPECT_EQ(s.energy_lost_contact, 0);
}

TEST(Summary, has_the_quantities_that_estimates_compare) {
  const Kernel kernel = rod(20, length);
  const Model model = rods(kernel, 0.005);
  const Summary s = run(model, 30);
  const auto compared = impact_quantities(model, {.step = step}, 3000);
  ASSERT_TRUE(compared);
  EXPECT_THAT(s.quantities, SizeIs(5));  // no spin of rods, and no receivers
  for (const auto& [quantity, figure] : s.quantities) {
    EXPECT_EQ(figure.value, compared->figures.at(quantity).value) << name_of(quantity);
    EXPECT_EQ(figure.scale, compared->figures.at(quantity).scale) << name_of(quantity);
  }
  const Vector& rebound = s.quantities.at(Quantity::rebound).value;
  EXPECT_NEAR(rebound[3], s.exit_velocity.at("right").x(), 1e-12);  // elastic modes carry no momentum
  EXPECT_EQ(s.quantities.at(Quantity::impulse).value[0], s.impulse_ns);
}

TEST(Summary, of_a_supported_body_that_can_still_slide_has_its_rebound) {
  Kernel kernel = rod(100, length);
  const Summary free = run(rods(kernel, 0.005), 30);
  kernel.supported = true;
  const Summary guided = run(rods(kernel, 0.005), 30);
  EXPECT_EQ(guided.restitution, free.restitution);
  EXPECT_EQ(guided.episodes.front().approach_m_per_s, free.episodes.front().approach_m_per_s);
}

TEST(Summary, of_sampled_responses_has_the_restitution_of_the_only_pair_that_touches) {
  const StepOptions options{.step = test::step};
  Table table = test::rods(0.005, 3000);
  const auto figures = [&] {
    TableStepper stepper(table, options);
    SummaryObserver observer({table, nullptr}, options.step, 0);
    for (int k = 0; k < 2500; ++k) {
      EXPECT_EQ(stepper.step(), StepStatus::ok);
      observer.observe(stepper);
    }
    return observer.summary();
  };
  const Summary two = figures();
  EXPECT_NEAR(two.restitution.value(), 1, 1e-3);  // one of the 2000 steps of contact
  EXPECT_THAT(two.quantities, SizeIs(4));         // no energy
  EXPECT_FALSE(two.energy_drift);
  table.bodies.push_back({"aside", 1, {0, 0, 0}, {0, 0, 0}, Matrix::Zero(1, 3)});
  EXPECT_EQ(figures().restitution, two.restitution);
}

/// A mass of 1 kg, pressed by 2 N, on a surface with friction 0.5: 1 N stops or holds it.
Model dragged(double speed, double load) {
  Model model = pressed(1, {0.5, 0.5, 0}, 2, 1e-6);
  model.B(1, 0) = 1;
  model.v0(0) = speed;
  model.load(0) = load;
  return model;
}

TEST(Summary, of_a_sliding_mass_has_its_heat_over_the_energy_put_in) {
  const auto lost = [](double speed, double load) {
    return run(dragged(speed, load), 2).energy_lost_friction;
  };
  // It stops after 1 s; its heat is its kinetic energy. The slip of the flexibility is 1e-6 of the way.
  EXPECT_NEAR(lost(1, 0).value(), 1, 1e-5);
  EXPECT_EQ(lost(0, 0), 0);                           // no heat of no energy
  EXPECT_NEAR(lost(0, 3).value(), 1.0 / 3, 1e-5);     // a third of what the load of 3 N does
  EXPECT_NEAR(lost(2, 3).value(), 8.0 / 26, 1e-5);    // over 8 m, on top of 2 J
  EXPECT_NEAR(lost(2, -0.5).value(), 2.0 / 3, 1e-5);  // 1.5 N stop it after 4/3 m; the load puts nothing in
  Model open = dragged(1, 0);
  open.gap(0) = 1;
  EXPECT_EQ(run(open, 2).energy_lost_friction, 0);
}

/// The impulse scheme stops a rigid rod at every t_k while its weight pulls it
/// down, so it is never observed to move.
TEST(Summary, of_a_rod_that_sinks_at_rest_measures_drift_by_what_loads_and_contact_did) {
  const Kernel kernel = rod(1, length, false);
  const Model model =
      build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero()}},
                  {{"floor", {length, 0, 0}, {-1, 0, 0}}}, {{"rod", "floor", {}, {}, {}}}, {1, 0, 0});
  const Summary s = run(model, 10, 0, 0);
  EXPECT_GT(s.contact_steps, 990);
  EXPECT_LT(s.energy_drift.value(), 1e-12);             // round-off of 1000 steps
  EXPECT_NEAR(s.energy_lost_contact.value(), 1, 1e-9);  // all that its weight does
}

/// A rigid rod with a single mode falls on a floor. Each bounce is a single step
/// and retains the fraction e of the speed.
TEST(Summary, lists_each_bounce) {
  const Kernel kernel = rod(1, length, false);
  const double g = 10, height = 5, e = 0.5;
  const Model model = build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero()}},
                                  {{"floor", {length + height, 0, 0}, {-1, 0, 0}}},
                                  {{"rod", "floor", {}, {}, {}}}, {g, 0, 0});
  const Summary s = run(model, 2.25, 0, e, 1e-4);
  ASSERT_EQ(s.episodes.size(), 2U);  // at t = 1 at speed 10, and 2·5/10 = 1 s later at speed 5
  // 2e-3: times are rounded to steps, and the motion within the step adds to this.
  EXPECT_NEAR(s.episodes[0].start_s, 1, 2e-3);
  EXPECT_NEAR(s.episodes[1].start_s, 2, 2e-3);
  EXPECT_NEAR(s.episodes[0].impulse_ns, 10 * 10 * (1 + e), 0.1);
  EXPECT_NEAR(s.episodes[1].impulse_ns, 10 * 5 * (1 + e), 0.1);
  EXPECT_NEAR(s.episodes[0].peak_force_n, 1500 / 10 / 1e-4, 2e3);  // an impulse within one step
  EXPECT_EQ(s.contact_steps, 2);
  EXPECT_NEAR(*s.restitution, e * e, 2e-3);  // from the first approach to the last exit
  EXPECT_NEAR(s.energy_lost_contact.value(), 1 - e * e * e * e, 0.01);
  EXPECT_LT(s.energy_drift, 1e-12);
}

/// A mass of 0.02 kg on a spring of 1e6 N/m, which moves along x and faces along x.
Kernel mallet() {
  Kernel kernel;
  kernel.mass = 0.02;
  add_candidate(kernel, {0, 0, 0}, {1, 0, 0}, 1e-4);
  kernel.surface.components = 1;
  kernel.surface.direction = ricochet::Vector3{1, 0, 0};
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  kernel.surface.shape = {1 / std::sqrt(kernel.mass)};
  kernel.surface.residual_flexibility = {1e-6};
  kernel.modes.angular_frequency = kernel.modes.decay_rate = {0};
  kernel.loads.body_force = {std::sqrt(kernel.mass), 0, 0};
  kernel.loads.rotation = {0, 0, 0};
  kernel.loads.body_force_residual = {0, 0, 0};
  return kernel;
}

/// Two mallets 1 mm in front of a wall: one at 1 m/s, and one at 2 m/s that is at this place at t = 0.05 s.
Model two_strikes(const Kernel& kernel) {
  const Matrix3d unturned = Matrix3d::Identity();
  return build_model(
      {{"mallet", &kernel, unturned, Vector3d::Zero(), {1, 0, 0}},
       {"mallet.2", &kernel, unturned, Vector3d::Zero(), {2, 0, 0}, Vector3d::Zero(), {-0.1, 0, 0}}},
      {{"wall", {1e-3, 0, 0}, {-1, 0, 0}}},
      {{"mallet", "wall", {}, {}, {}}, {"mallet.2", "wall", {}, {}, {}}}, Vector3d::Zero());
}

// A mass on a spring touches for π √(m/k) = 0.444 ms and reverses its velocity. Touch and opening are known
// to a step of 5 µs; the error of the conserving law is of second order.
TEST(Episodes, have_their_own_approach_and_restitution) {
  const Kernel kernel = mallet();
  const Model model = two_strikes(kernel);
  EXPECT_NEAR(model.initial_displacement()(1), -0.1, 1e-15);
  const Summary s = run(model, 0.06, 0, -1, 5e-6);
  ASSERT_EQ(s.episodes.size(), 2U);
  EXPECT_FALSE(s.restitution);  // two pairs touched
  const double start[] = {1e-3, 0.05 + 0.5e-3}, speed[] = {1, 2};
  for (std::size_t k = 0; k < 2; ++k) {
    const Episode& episode = s.episodes[k];
    EXPECT_NEAR(episode.start_s, start[k], 6e-6);
    ASSERT_TRUE(episode.end_s && episode.approach_m_per_s && episode.restitution);
    EXPECT_NEAR(*episode.end_s - episode.start_s, std::numbers::pi * std::sqrt(0.02 / 1e6), 15e-6);
    EXPECT_NEAR(*episode.approach_m_per_s, speed[k], 1e-12);
    EXPECT_NEAR(*episode.restitution, 1, 1e-3);
    EXPECT_NEAR(episode.impulse_ns, 2 * 0.02 * speed[k], 1e-3 * 0.08);
  }
  EXPECT_NEAR(s.exit_velocity.at("mallet").x(), -1, 1e-3);
  EXPECT_NEAR(s.exit_velocity.at("mallet.2").x(), -2, 2e-3);
}

TEST(Episodes, that_do_not_end_have_an_approach_only) {
  const Kernel kernel = mallet();
  const Summary s = run(two_strikes(kernel), 0.0507, 0, -1, 5e-6);
  ASSERT_EQ(s.episodes.size(), 2U);
  EXPECT_TRUE(s.episodes[0].restitution);
  EXPECT_NEAR(s.episodes[1].approach_m_per_s.value(), 2, 1e-12);
  EXPECT_FALSE(s.episodes[1].restitution);
}

// Two per cent of 75 m/s is 1.5 m/s, which only the second strike exceeds.
TEST(Warnings, name_the_speed_of_the_fastest_episode) {
  const Kernel kernel = mallet();
  const Summary s = run(two_strikes(kernel), 0.06, 75, -1, 5e-6);
  EXPECT_THAT(s.warnings, ::testing::Contains(HasSubstr("approach speed 2 m/s is 2.67 % of the wave speed")));
}

TEST(Warnings, name_a_speed_above_two_per_cent_of_the_waves) {
  const Kernel kernel = rod(10, length);
  EXPECT_THAT(run(rods(kernel, 0.005), 1, 51).warnings, IsEmpty());
  EXPECT_THAT(run(rods(kernel, 0.005), 1, 40).warnings,
              ElementsAre(HasSubstr("approach speed 1 m/s is 2.5 % of the wave speed 40 m/s")));
}

std::vector<std::string> warnings_of_plate(const Vector3d& velocity, const Vector3d& spin) {
  const Kernel kernel = rigid_plate();
  Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {3, 0, 0.5}, velocity}},
                            {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}},
                            {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
  model.v0.tail(3) = spin;
  return run(model, 1, 0, 0.5).warnings;
}

/// A plate that meets another one, which lies upside down.
std::vector<std::string> warnings_of_pair(const Vector3d& velocity) {
  const Kernel kernel = rigid_plate();
  const Matrix3d turned = Vector3d(1, -1, -1).asDiagonal();
  Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {3, 0, 0.5}, velocity},
                             {"other", &kernel, turned, {3, 1, 0}}},
                            {}, {{"plate", "other", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  return run(model, 1, 0, 0.5).warnings;
}

TEST(Warnings, name_tangential_motion_of_two_bodies_beyond_half_the_spacing) {
  EXPECT_THAT(warnings_of_pair({0.3, 0.2, -1}), IsEmpty());
  // They touch after 0.5 s (or a step later), after a tangential motion of 0.5 · |(1, 0.2)| = 0.51 m.
  EXPECT_THAT(warnings_of_pair({1, 0.2, -1}),
              ElementsAre(HasSubstr("times the candidate spacing (above 0.5)")));
}

TEST(Warnings, do_not_name_tangential_motion_along_a_half_space) {
  EXPECT_THAT(warnings_of_plate({1, 0.2, -1}, Vector3d::Zero()), IsEmpty());
}

TEST(Warnings, name_rotation_beyond_five_degrees) {
  EXPECT_THAT(warnings_of_plate({0, 0, -1}, {0, 0, 0.08}),
              IsEmpty());  // turned by 2.3 degrees about z at touch, and by 4.6 at the end
  const auto warnings = warnings_of_plate({0, 0, -1}, {0, 0, 0.2});
  EXPECT_THAT(warnings, ElementsAre(::testing::ContainsRegex("plate turned by 5.[78][0-9]* degrees")));
}

/// Two plates: one falls, and the other turns far from its own floor.
std::vector<std::string> warnings_of_two(double spin_of_falling, double spin_of_other) {
  const Kernel kernel = rigid_plate();
  const Vector3d up(0, 0, 1);
  Model model =
      build_model({{"plate", &kernel, Matrix3d::Identity(), {3, 0, 0.5}, {0, 0, -1}},
                   {"other", &kernel, Matrix3d::Identity(), {9, 0, 50}}},
                  {{"floor", Vector3d::Zero(), up}, {"deep", {0, 0, -9}, up}},
                  {{"plate", "floor", {}, {}, {}}, {"other", "deep", {}, {}, {}}}, Vector3d::Zero());
  model.v0(5) = spin_of_falling;
  model.v0(11) = spin_of_other;
  return run(model, 1, 0, 0.5).warnings;
}

// 5 degrees are 0.0873 rad, which a spin of 0.2 reaches after 0.436 s, and one of 0.08 never in 1 s.
TEST(Warnings, name_rotation_of_a_body_that_does_not_touch) {
  EXPECT_THAT(warnings_of_two(0, 0.08), IsEmpty());
  EXPECT_THAT(warnings_of_two(0, 0.2),
              ElementsAre(HasSubstr("other turned by 11.5 degrees in flight, beyond 5 after 0.44 s")));
  EXPECT_THAT(warnings_of_two(0.2, 0.3), ElementsAre(HasSubstr("plate turned by 5."),
                                                     HasSubstr("other turned by 17.2 degrees in flight")));
  // The plate touches at 0.5 s, turned by 2.9 degrees, and turns by 5.7 until the end.
  EXPECT_THAT(warnings_of_two(0.1, 0), ElementsAre(HasSubstr("plate turned by 5.73 degrees in flight")));
}

TEST(Warnings, name_no_rotation_that_only_the_last_output_shows) {
  EXPECT_THAT(warnings_of_two(0, 0.0875), IsEmpty());  // 5.01 degrees after 1 s, 4.96 a step before
}

TEST(Json, holds_what_the_summary_holds_and_null_for_what_is_not_known) {
  const ricochet::test::Folder folder;
  Summary s;
  s.contact_start_s = 0.25;
  s.episodes = {{.start_s = 0.25, .end_s = 0.5, .impulse_ns = 2, .peak_force_n = 3},
                {.start_s = 1, .end_s = {}}};
  s.exit_velocity["upper"] = {1, 2, 3};
  s.modes["upper"] = 50;
  s.basis["upper"] = "imported";
  s.sounds["mic"] = {"x.mic.wav", 0.25, 48000};
  s.warnings = {"too fast"};
  s.quantities[Quantity::rebound] = {Eigen::Vector3d(1, 2, 3), 4};
  write_json(s, folder / "x.summary.json");
  std::ifstream file(folder / "x.summary.json");
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json["contact_start_s"], 0.25);
  for (const char* key :
       {"contact_end_s", "restitution", "energy_drift", "energy_lost_contact", "error_estimate"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
  s.error_estimate =
      ErrorEstimate{.requested = {Quantity::impulse},
                    .by_cause = {{Cause::mesh, std::nullopt},
                                 {Cause::modes, Errors{{Quantity::impulse, 3}, {Quantity::spin, 6}}},
                                 {Cause::step, Errors{{Quantity::impulse, 4}, {Quantity::spin, 8}}}}};
  s.error_estimate->until_s = 0.5;
  write_json(s, folder / "x.summary.json");
  std::ifstream again(folder / "x.summary.json");
  const auto estimate = nlohmann::json::parse(again)["error_estimate"];
  const nlohmann::json impulse{{"total", 5.0}, {"mesh", nullptr}, {"modes", 3.0}, {"step", 4.0}},
      spin{{"total", 10.0}, {"mesh", nullptr}, {"modes", 6.0}, {"step", 8.0}};
  nlohmann::json expected = impulse;
  expected["quantity"] = "impulse";
  expected["until_s"] = 0.5;
  expected["quantities"] = {{"impulse", impulse}, {"spin", spin}};
  EXPECT_EQ(estimate, expected);
  EXPECT_EQ(json["episodes"].size(), 2U);
  EXPECT_EQ(json["episodes"][0]["end_s"], 0.5);
  EXPECT_TRUE(json["episodes"][1]["end_s"].is_null());
  EXPECT_EQ(json["exit_velocity"]["upper"], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(json["quantities"]["rebound"], (nlohmann::json{{"value", {1.0, 2.0, 3.0}}, {"scale", 4.0}}));
  EXPECT_EQ(json["modes"]["upper"], 50);
  EXPECT_EQ(json["basis"]["upper"], "imported");
  EXPECT_EQ(json["sounds"]["mic"]["file"], "x.mic.wav");
  EXPECT_EQ(json["sounds"]["mic"]["full_scale_m_per_s"], 0.25);
  EXPECT_EQ(json["warnings"], std::vector<std::string>{"too fast"});
  for (const char* key :
       {"contact_steps", "peak_force_n", "impulse_ns", "max_penetration_m", "limited_steps",
        "limited_residual", "candidates", "unpaired", "max_active", "real_time_factor", "wall_s"})
    EXPECT_EQ(json.at(key), 0) << key;
  EXPECT_EQ(folder.entries(), 1U);  // no temporary file remains
  EXPECT_THAT(complaint_of([&] { write_json(s, folder / "not" / "there.json"); }), HasSubstr("--out"));
}

}  // namespace summary_test
