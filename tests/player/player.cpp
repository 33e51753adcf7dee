// SPDX-License-Identifier: BSD-2-Clause
#include "player/player.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/stepping/stepper.hpp"
#include "ricochet/ricochet.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/player/instruments.hpp"

namespace player_test {

using namespace ricochet;
using player::Instrument;
using player::Player;
using player::test::instrument_of;
using player::test::plates;
using ricochet::test::complaint_of;

constexpr double rate = 48e3;

struct Sound {
  std::vector<float> left, right;
};

Sound render(Player& player, std::size_t samples) {
  Sound out{std::vector<float>(samples), std::vector<float>(samples)};
  player.process(out.left, out.right);
  return out;
}

/// Forces of all contact steps, and the velocities of the pickups after each sample, by the library.
struct Reference {
  std::vector<double> force, velocity, right;
  double peak = 0;
  Reference(Scene scene, double contact_rate_hz, std::int64_t samples) {
    scene.rate_hz = contact_rate_hz;
    const auto per_sample = static_cast<std::int64_t>(std::lround(contact_rate_hz / rate));
    force.resize(static_cast<std::size_t>(samples * per_sample));
    std::vector<double> every(2 * force.size());
    Simulation simulation(scene);
    const BlockResult done =
        simulation.step_block(std::ssize(force), {.velocity = every.data(), .total_force = force.data()});
    EXPECT_EQ(done.status, StepStatus::ok);
    for (std::size_t k = static_cast<std::size_t>(per_sample); k <= force.size();
         k += static_cast<std::size_t>(per_sample)) {
      velocity.push_back(every[2 * (k - 1)]);
      right.push_back(every[2 * (k - 1) + 1]);
    }
    for (const double f : force) peak = std::max(peak, f);
  }
};

// 1e-12 of the peak: round-off. The library steps in blocks, the player step by step.
TEST(Player, has_the_forces_and_the_sound_of_the_library) {
  for (const double speed : {0.1, 1.0, 30.0}) {
    const Scene scene = plates(speed, 2);
    const Instrument instrument = instrument_of({scene});
    Player player(instrument, rate);
    ASSERT_TRUE(player.strike({.speed = speed}));
    const Sound sound = render(player, 400);
    const Reference library(scene, player.contact_rate_hz(), 400);
    ASSERT_GT(library.peak, 0);
    const std::span<const double> forces = player.forces();
    ASSERT_GT(forces.size(), 100);
    for (std::size_t k = 0; k < forces.size(); ++k)
      ASSERT_NEAR(forces[k], library.force[k], 1e-12 * library.peak) << k;
    for (std::size_t k = forces.size(); k < library.force.size(); ++k) ASSERT_EQ(library.force[k], 0) << k;
    const double loudest = *std::ranges::max_element(library.velocity);
    for (std::size_t k = 0; k < 400; ++k)  // 1e-6: single precision of the sound
    {
      ASSERT_NEAR(sound.left[k], library.velocity[k], 1e-6 * loudest) << k;
      ASSERT_NEAR(sound.right[k], library.right[k], 1e-6 * loudest) << k;
    }
    EXPECT_EQ(player.mallets(), 0);
    EXPECT_EQ(player.failures(), 0);
  }
}

// As above, with the bulges of a rounded tip, which an instrument from a scene of flat plates lacks.
TEST(Player, flattens_bulges_as_the_library_does) {
  const double speed = 0.3;
  const Scene scene = plates(speed, 2);
  Instrument instrument = instrument_of({scene});
  contact::Model model = model_of(scene);
  model.bulge = instrument.places[0].bulge = contact::Vector::LinSpaced(model.points(), 0, 4e-6);
  Player player(instrument, rate);
  ASSERT_TRUE(player.strike({.speed = speed}));
  render(player, 400);
  const auto stepper = contact::make_stepper(model, {.step = 1 / player.contact_rate_hz(), .block = 1});
  const auto springs = model.springs();
  std::vector<double> expected;
  int partial = 0;
  for (std::size_t k = 0; k < player.forces().size(); ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    expected.push_back(stepper->force().sum());
    for (Eigen::Index i = 0; i < model.points(); ++i)
      partial += stepper->end_force()(i) > 0 && stepper->end_force()(i) < springs[i].limit ? 1 : 0;
  }
  const double peak = *std::ranges::max_element(expected);
  ASSERT_GT(peak, 0);
  EXPECT_GT(partial, 10);
  for (std::size_t k = 0; k < expected.size(); ++k)
    ASSERT_NEAR(player.forces()[k], expected[k], 1e-11 * peak) << k;
}

// The library sees both mallets from the start: the second one flies until the first one has left. The player
// brings it when it arrives. The body has then moved away from both. 1e-11: round-off of the longer flight.
TEST(Player, strikes_a_ringing_body_as_the_library_does) {
  const Scene first = plates(1, 0, 1e-3, 1), second = plates(0.5, 0, 1e-3, 1);
  const Instrument instrument = instrument_of({first, second});
  Player player(instrument, rate);
  constexpr int later = 60;  // samples
  ASSERT_TRUE(player.strike({.place = 0, .speed = 1}));
  ASSERT_TRUE(player.strike({.place = 1, .speed = 0.5, .after = later}));
  const Sound sound = render(player, 400);

  Scene both = first;
  both.bodies.push_back(second.bodies[1]);
  both.bodies[2].name = "other";
  both.pairs.push_back(second.pairs[0]);
  both.pairs[1].a = "other";
  both.pairs[1].gap = 0.5 * later / rate;
  const Reference library(both, player.contact_rate_hz(), 400);
  const auto skipped = static_cast<std::size_t>(later * std::lround(player.contact_rate_hz() / rate));
  const std::span<const double> forces = player.forces();  // of the second blow
  ASSERT_GT(forces.size(), 100);
  for (std::size_t k = 0; k < forces.size(); ++k)
    ASSERT_NEAR(forces[k], library.force[skipped + k], 1e-11 * library.peak) << k;
  const double loudest = *std::ranges::max_element(library.velocity);
  for (std::size_t k = 0; k < 400; ++k) ASSERT_NEAR(sound.left[k], library.velocity[k], 1e-6 * loudest) << k;
}

TEST(Player, adds_more_than_a_copy_of_the_sound_with_the_second_blow) {
  const Instrument instrument = instrument_of({plates(1, 2)});
  Player twice(instrument, rate), once(instrument, rate);
  once.strike({});
  twice.strike({});
  twice.strike({.after = 200});
  const Sound one = render(once, 600), two = render(twice, 600);
  double difference = 0, loudest = 0;
  for (std::size_t k = 200; k < 600; ++k) {
    difference = std::max<double>(difference, std::abs(two.left[k] - one.left[k] - one.left[k - 200]));
    loudest = std::max<double>(loudest, std::abs(one.left[k]));
  }
  EXPECT_GT(difference, 0.01 * loudest);
  for (std::size_t k = 0; k < 200; ++k) EXPECT_EQ(two.left[k], one.left[k]);
}

// 1e-12 of the energy put in: round-off of some thousand steps.
TEST(Player, keeps_its_energy_through_blow_and_second_blow) {
  const Instrument instrument = instrument_of({plates(1, 2, 0)});
  Player player(instrument, rate);
  const double mallet = 0.5 * 0.1 * 1 * 1;  // ½ m v²
  double before = 0;
  for (int blow = 0; blow < 3; ++blow) {
    player.strike({});
    for (int sample = 0; sample < 500; ++sample) {
      render(player, 1);
      const player::Energies now = player.energies();
      if (player.mallets() == 0) break;
      ASSERT_NEAR(now.body + now.mallets + now.residual + now.contact, before + mallet, 1e-12 * mallet)
          << blow << " " << sample;
    }
    ASSERT_EQ(player.mallets(), 0);
    const player::Energies after = player.energies();
    EXPECT_GT(after.body, 0);
    EXPECT_GE(after.contact, -1e-15);
    before = after.body + after.contact;
  }
}

// A mass on a spring against a body that hardly moves: half a sine, which lasts π √(m r), of peak v √(m/r).
// 1e-3: the step is a thousandth of the contact, and the body yields by 1e-4 of the layer.
TEST(Player, meets_a_soft_layer_as_a_mass_on_a_spring) {
  Instrument instrument = instrument_of({plates(1, 2)});
  instrument.omega *= 100;
  instrument.contact_rate_hz = 0;
  instrument.places[0].B = instrument.places[0].B.topRows(1).eval();
  instrument.places[0].gap = instrument.places[0].bulge = contact::Vector::Zero(1);
  instrument.places[0].area = contact::Vector::Constant(1, 0.5);
  instrument.places[0].flexibility = contact::Matrix::Zero(1, 1);
  instrument.places[0].B.rightCols(5).setZero();  // a rigid mallet
  instrument.mallets = {{"layer", 3, 1e-5}};
  Player player(instrument, rate);
  player.strike({.speed = 2});
  render(player, 400);
  const double mass = 3 * 0.1, compliance = 1e-5 / 0.5;
  double impulse = 0;
  std::size_t last = 0;
  for (std::size_t k = 0; k < player.forces().size(); ++k) {
    impulse += player.forces()[k] / player.contact_rate_hz();
    if (player.forces()[k] > 0) last = k + 1;
  }
  EXPECT_NEAR(player.take_peak_force(), 2 * std::sqrt(mass / compliance),
              1e-3 * 2 * std::sqrt(mass / compliance));
  EXPECT_NEAR(static_cast<double>(last) / player.contact_rate_hz(),
              std::numbers::pi * std::sqrt(mass * compliance),
              1e-3 * std::numbers::pi * std::sqrt(mass * compliance));
  EXPECT_NEAR(impulse, 2 * mass * 2, 1e-3 * 2 * mass * 2);  // it leaves as fast as it came
}

// Decay rates are from 0.3 /s on: e^{−2 · 300 · 0.1} < 1e-12 with a factor of 1000. 1e-9: round-off.
TEST(Player, rings_shorter_with_more_damping) {
  const Instrument instrument = instrument_of({plates(1, 2)});
  Player player(instrument, rate);
  player.strike({});
  render(player, 300);
  ASSERT_EQ(player.mallets(), 0);
  Player free = player;
  free.set_damping(0);
  const double before = free.energies().body;
  render(free, 4800);
  EXPECT_NEAR(free.energies().body, before, 1e-9 * before);
  player.set_damping(1000);
  render(player, 4800);
  EXPECT_LT(player.energies().body, 1e-12 * before);
}

// The second mallet takes the place of the first one. 1e-11 of the peak: contact may spend, as it opens,
// energy that it removed in the first blow.
TEST(Player, becomes_silent_and_sounds_again) {
  const Instrument instrument = instrument_of({plates(1, 2)});
  Player player(instrument, rate);
  EXPECT_TRUE(player.silent());
  player.set_damping(100);
  std::vector<double> before;
  for (int blow = 0; blow < 2; ++blow) {
    player.strike({});
    EXPECT_NE(render(player, 10).left[9], 0);
    EXPECT_FALSE(player.silent());
    for (int block = 0; block < 100; ++block) render(player, 480);
    EXPECT_TRUE(player.silent());
    EXPECT_EQ(render(player, 10).right[0], 0);
    const std::vector<double> forces(player.forces().begin(), player.forces().end());
    const double peak = *std::ranges::max_element(forces);
    if (blow == 1) {
      ASSERT_EQ(forces.size(), before.size());
    }
    for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(forces[k], before[k], 1e-11 * peak) << k;
    before = forces;
  }
}

TEST(Player, never_allocates_while_it_plays) {
  const Instrument instrument = instrument_of({plates(1, 0), plates(1, 2), plates(1, 4)});
  Player player(instrument, rate);
  std::vector<float> left(128), right(128);
  const long before = heap_counter::calls + heap_counter::returns;
  for (int block = 0; block < 2000; ++block) {
    if (block % 7 == 0)
      player.strike(
          {.place = block % 3, .mallet = block % 2, .speed = 0.5 + block % 5, .after = block % 128});
    if (block % 50 == 0) player.set_damping(1 + block % 3);
    if (block == 1900) player.reset();
    player.process(left, right);
  }
  EXPECT_EQ(heap_counter::calls + heap_counter::returns, before);
  EXPECT_EQ(player.failures(), 0);
}

TEST(Player, refuses_blows_out_of_range_and_more_mallets_than_it_has) {
  const Instrument instrument = instrument_of({plates(1, 2)});
  Player player(instrument, rate);
  for (const player::Strike& bad :
       {player::Strike{.place = 1}, player::Strike{.place = -1}, player::Strike{.mallet = 2},
        player::Strike{.speed = 0}, player::Strike{.speed = std::nan("")}, player::Strike{.after = -1}})
    EXPECT_FALSE(player.strike(bad));
  for (int k = 0; k < Player::most_mallets; ++k) EXPECT_TRUE(player.strike({.after = k}));
  EXPECT_FALSE(player.strike({}));
  render(player, 600);
  EXPECT_TRUE(player.strike({}));
}

TEST(Player, refuses_rates_that_need_too_many_contact_steps) {
  Instrument instrument = instrument_of({plates(1, 2)});
  EXPECT_THAT(complaint_of([&] { Player(instrument, 10); }), testing::HasSubstr("must be from 8000"));
  instrument.omega(39) = 1e9;
  EXPECT_THAT(complaint_of([&] { Player(instrument, rate); }),
              testing::HasSubstr("more than 256 contact steps"));
}

}  // namespace player_test
