// SPDX-License-Identifier: BSD-2-Clause
// A scene drawn at random: 2 to 20 bodies that turn and meet, with and without R, friction and a floor.
//
//   random_meetings SEED STEPS    one line of JSON: what was drawn, and how far the balances are from exact
//
// Of more than 5 bodies, fewer steps are made, because a step takes the time of their pairs.
// Energies are relative to that of the start, or to the work of gravity if it is larger.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact/stepping/floating_stepper.hpp"
#include "tests/contact/meeting.hpp"
#include "tests/drawn.hpp"

namespace {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;

struct Drawn {
  std::vector<std::unique_ptr<Cloud>> clouds;
  Meeting scene;
  double rate = 0;  // Hz
};

Drawn draw(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> between(-1, 1);
  const auto any = [&] { return ricochet::test::drawn(between, random); };
  const auto decades = [&](double from, double to) {
    return std::pow(10.0, from + (to - from) * (between(random) + 1) / 2);
  };
  Drawn out;
  const auto bodies = static_cast<int>(std::lround(2 * decades(0, 1)));
  out.rate = decades(3, 9);
  const double irregular = random() % 2 ? 0 : 0.2;  // share by which boxes are not regular
  const double flexibility = random() % 4 ? decades(-9, -7) : 0;
  const int side = static_cast<int>(std::ceil(std::cbrt(bodies)));
  const Vector3d middle(0.15 * (side - 1), 0.15 * (side - 1), 0.15 * side);
  for (int k = 0; k < bodies; ++k) {
    const double size = std::exp(0.5 * between(random));
    out.clouds.push_back(std::make_unique<Cloud>(size * Vector3d(0.1, 0.08, 0.06), decades(2, 4), flexibility,
                                                 100 * seed + static_cast<unsigned>(k), true, irregular));
    out.scene.clouds.push_back(out.clouds.back().get());
    PlacedBody body;
    body.rotation = turn(3 * between(random), any());
    body.translation = 0.3 * Vector3d(k % side, k / side % side, 0.8 + k / (side * side)) + 0.02 * any();
    body.velocity = -6 * (body.translation - middle) + any();
    body.angular_velocity = 60 * any();
    out.scene.bodies.push_back(body);
  }
  if (random() % 3) {
    const double friction = 1 + between(random);
    out.scene.friction = Friction{friction, friction, 0};
  }
  if (random() % 2) {
    out.scene.floor = true;
    out.scene.gravity = {0, 0, -9.81};
  }
  return out;
}

/// Lets the bodies fly until the last step of 1/rate before the first touch, at most for 0.3 s.
void approach(Meeting& scene, double rate) {
  const auto stepper = make_stepper(meet(scene), stepping(rate));
  std::vector<Pose> before;
  for (int k = 0; k < 0.3 * rate; ++k) {
    before.assign(stepper->poses().begin(), stepper->poses().end());
    if (stepper->step() != StepStatus::ok) throw std::runtime_error("a step of the approach failed");
    if (stepper->active() > 0) break;
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    PlacedBody& body = scene.bodies[k];
    body.rotation = before[k].attitude.toRotationMatrix();
    body.translation = before[k].position - body.rotation * scene.clouds[k]->centre;
    body.velocity = before[k].velocity;
    body.angular_velocity = before[k].spin;
  }
}

void run(unsigned seed, long steps) {
  Drawn drawn = draw(seed);
  Meeting& scene = drawn.scene;
  for (const double rate : {2e3, 4e4, 1e6})
    if (rate < drawn.rate) approach(scene, rate);
  const auto stepper = make_stepper(meet(scene), stepping(drawn.rate));
  const Energy start = stepper->modal()->energy();
  const auto stored = [](const Energy& energy) { return energy.kinetic + energy.strain + energy.residual; };
  const Vector3d p = momentum(scene, *stepper), L = angular_momentum(scene, *stepper);
  double mass = 0, above = 0, ledger = 0;
  for (const Cloud* cloud : scene.clouds) mass += cloud->mass;
  const auto bodies = static_cast<double>(scene.bodies.size());
  const auto most = static_cast<long>(
      std::min(static_cast<double>(steps) * std::min(1.0, 5 / bodies), 0.3 * drawn.rate + 50));
  long made = 0, touching = 0;
  int points = 0;
  std::string complaint;
  for (; made < most && complaint.empty(); ++made) {
    if (const StepStatus status = stepper->step(); status != StepStatus::ok)
      complaint = fmt::format("step {} ends with status {}", made, static_cast<int>(status));
    touching += stepper->active() > 0;
    points = std::max(points, stepper->active());
    const Energy now = stepper->modal()->energy();
    const double scale = std::max(stored(start), std::abs(now.loads));
    above = std::max(above, (stored(now) - now.loads - stored(start)) / scale);
    ledger = std::max(ledger, std::abs(now.ledger() - start.ledger()) / scale);
    if (!std::isfinite(stored(now))) complaint = fmt::format("step {}: no finite energy", made);
  }
  // Of the system, which a floor and gravity change
  const double unit = std::sqrt(2 * stored(start) * mass), arm = 0.3;
  const double of_momentum = scene.floor ? 0 : (momentum(scene, *stepper) - p).norm() / unit;
  const double of_spin = scene.floor ? 0 : (angular_momentum(scene, *stepper) - L).norm() / (unit * arm);
  fmt::print(
      R"({{"seed":{},"bodies":{},"rate":{},"friction":{},"floor":{},"steps":{},"touching":{},"points":{},)"
      R"("energy":{},"ledger":{},"momentum":{},"angular":{},"complaint":"{}"}})"
      "\n",
      seed, scene.bodies.size(), drawn.rate, scene.friction ? scene.friction->static_coefficient : 0,
      scene.floor, made, touching, points, above, ledger, of_momentum, of_spin, complaint);
}

}  // namespace

int main(int count, char** words) {
  try {
    if (count != 3) throw std::invalid_argument("give SEED STEPS");
    run(static_cast<unsigned>(std::stoul(words[1])), std::stol(words[2]));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "random_meetings: {}\n", error.what());
    return 2;
  }
}
