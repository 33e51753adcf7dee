// SPDX-License-Identifier: BSD-2-Clause
// Free bodies that turn by any angle: the free rotation, and steps with contact.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/stepping/floating_stepper.hpp"
#include "tests/contact/cloud.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/rigid_body.hpp"
#include "tests/drawn.hpp"
#include "tests/support.hpp"

namespace ricochet::contact::test {
namespace {

using Eigen::Quaterniond;

Vector3d momentum(const Cloud& cloud, const Pose& pose) { return cloud.mass * pose.velocity; }

Vector3d angular_momentum(const Cloud& cloud, const Pose& pose) {
  const Matrix3d A = pose.attitude.toRotationMatrix();
  return A * cloud.inertia * A.transpose() * pose.spin + cloud.mass * pose.position.cross(pose.velocity);
}

/// Dzhanibekov's body, with the moments 1, 2 and 3, spins about its second axis and a little about the first.
/// With ω₂ = a tn-like functions of Jacobi, ω₁ keeps a sign and ω₂ has the period 4K(k)/p.
TEST(FreeRotation, of_an_unstable_axis_flips_when_elliptic_functions_say) {
  const Inertia inertia = Inertia::of(Vector3d(1, 2, 3).asDiagonal());
  const Vector3d spin(1e-2, 1, 0);
  const Vector3d momentum = inertia.tensor * spin;
  const double energy = 0.5 * spin.dot(momentum), square = momentum.squaredNorm();
  // Landau & Lifshitz, Mechanics, §37, for M² < 2 E I₂ (I₁ < I₂ < I₃): 1 and 3 exchange their roles.
  const double I1 = 1, I2 = 2, I3 = 3;
  ASSERT_LT(square, 2 * energy * I2);
  const double p = std::sqrt((I2 - I1) * (2 * energy * I3 - square) / (I1 * I2 * I3)),
               modulus = std::sqrt((I3 - I2) * (square - 2 * energy * I1) /
                                   ((I2 - I1) * (2 * energy * I3 - square)));
  const double period = 4 * std::comp_ellint_1(modulus) / p;
  constexpr int steps = 1'000'000;
  const double step = 8 * period / steps;
  Quaterniond attitude = Quaterniond::Identity();
  std::vector<double> flips;
  double before = 1, worst = 0;
  for (int k = 1; k <= steps; ++k) {
    turn_freely(attitude, momentum, inertia, step, 0.25);
    const Vector3d own = inertia.inverse * (attitude.conjugate() * momentum);
    worst = std::max(worst, std::abs(0.5 * own.dot(inertia.tensor * own) / energy - 1));
    if (own.y() * before < 0) flips.push_back(step * (k - 1 + before / (before - own.y())));
    before = own.y();
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_NEAR(attitude.norm(), 1, 1e-15);
  ASSERT_EQ(flips.size(), 16);
  // ω₂ begins at its largest value, so that it is 0 after a quarter of the period. A step turns by 1e-4, and
  // the error of the rule is a twelfth of its square.
  for (std::size_t k = 0; k < flips.size(); ++k)
    EXPECT_NEAR(flips[k], (static_cast<double>(k) + 0.5) * period / 2, 1e-6 * flips[k]) << k;
}

TEST(FreeRotation, of_a_flight_does_not_depend_on_its_parts) {
  const Inertia inertia = Inertia::of(Vector3d(1, 2, 3).asDiagonal());
  const Vector3d momentum(0.3, 2, -1);
  Quaterniond parts = Quaterniond::Identity();
  for (int k = 0; k < 50'000; ++k) turn_freely(parts, momentum, inertia, 2e-4, 0.25);
  std::vector<double> errors;
  for (const double angle : {0.2, 0.1}) {
    Quaterniond whole = Quaterniond::Identity();
    fly_freely(whole, momentum, inertia, 10, angle);
    errors.push_back(whole.angularDistance(parts));
  }
  // Of a turn by 10 rad; with an error of second order, the first one were 1e-2.
  EXPECT_LT(errors[0], 4e-6);
  EXPECT_LT(errors[1], 3e-7);
}

/// With an inertia that is too large to turn it, the body moves as with linear rotations.
TEST(Floating, without_a_turn_is_the_compliant_step) {
  Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
  cloud.hold_attitude();
  using Case = std::pair<double, std::optional<Friction>>;
  for (const auto& [rate, friction] :
       {Case(1e5, std::nullopt), Case(1e5, Friction{0.4, 0.4, 0}), Case(1e4, Friction{0.4, 0.4, 0})}) {
    Drop drop{
        .rotation = turn(0.3, {1, 2, 0}), .velocity = {0.3, 0, -1}, .height = 1e-5, .friction = friction};
    const auto turning = over_floor(cloud, drop);
    drop.turns = false;
    const auto fixed = over_floor(cloud, drop);
    auto finite = make_stepper(turning, stepping(rate)),
         linear = make_stepper(fixed, stepping(rate, Rotation::linear));
    EXPECT_EQ(finite->modal()->modes_in_residual() > 0, rate < 1e5);
    double peak = 0, most = 0;
    for (int k = 0; k < 400; ++k) {
      ASSERT_EQ(finite->step(), StepStatus::ok);
      ASSERT_EQ(linear->step(), StepStatus::ok);
      peak = std::max(peak, linear->force().cwiseAbs().maxCoeff());
      most = std::max(most, std::abs(finite->force().sum() - linear->force().sum()));
      for (Eigen::Index i = 0; i < fixed->points(); ++i)  // the points that face the floor, in the same order
        for (Eigen::Index j = 0; j < turning->points(); ++j)
          if (turning->point_a.row(j) == fixed->point_a.row(i))
            most = std::max(most, std::abs(finite->force()(j) - linear->force()(i)));
    }
    EXPECT_GT(peak, 10);
    EXPECT_LT(most, 1e-9 * peak);
    EXPECT_NEAR(finite->modal()->energy().total(), linear->modal()->energy().total(),
                1e-11 * linear->modal()->energy().kinetic);
  }
}

/// A rigid body that falls on one of its points leaves with v⁺ = v + P n/m, ω⁺ = ω + J⁻¹(r × P n), and
/// without loss P = −2 v_n/(1/m + (r × n)·J⁻¹(r × n)). A spring at the point approaches this like its root.
TEST(Floating, a_rigid_body_on_one_point_rebounds_by_the_closed_form) {
  std::vector<double> errors;
  for (const double flexibility : {1e-6, 1e-8, 1e-10}) {
    const Cloud cloud({0.1, 0.08, 0.06}, 1, flexibility, 5, false);
    const Drop drop{
        .rotation = turn(0.5, {1, 0.6, 0}), .velocity = {0, 0, -1}, .height = 1e-4, .gravity = {0, 0, 0}};
    const auto model = over_floor(cloud, drop);
    auto stepper = make_stepper(model, stepping(2e6 / std::sqrt(flexibility / 1e-10) + 1e5));
    const Pose start = stepper->poses()[0];
    // Its lowest point, and the law of a rigid impact.
    Vector3d low = Vector3d::Constant(1);
    for (std::size_t k = 0; k < 27; ++k)
      if (const Vector3d arm = drop.rotation * (cloud.place[k] - cloud.centre); k != 13 && arm.z() < low.z())
        low = arm;
    const Matrix3d J = drop.rotation * cloud.inertia * drop.rotation.transpose();
    const Vector3d n = Vector3d::UnitZ(), lever = low.cross(n);
    const double impulse = 2 / (1 / cloud.mass + lever.dot(J.inverse() * lever));
    const Vector3d velocity = start.velocity + impulse / cloud.mass * n, spin = J.inverse() * lever * impulse;
    while (stepper->time() < 2e-4 || stepper->active() > 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Pose end = stepper->poses()[0];
    errors.push_back(
        std::max((end.velocity - velocity).norm() / velocity.norm(), (end.spin - spin).norm() / spin.norm()));
    EXPECT_GT(spin.norm(), 1);
  }
  EXPECT_LT(errors[2], 2e-3);
  // The body turns by ω T/2 in a contact of T ~ R^½. The third error contains the step.
  EXPECT_NEAR(errors[0] / errors[1], 10, 3);
}

/// Housner's block, released on two of its corners at a tilt, is upright when ½ I φ̇² has grown to
/// m g R (cos(α − φ₀) − cos(α − φ)): a quarter of its period. It then lands on its other corners.
TEST(Floating, a_block_on_its_edge_rocks_with_the_period_of_Housner) {
  const double half_width = 0.1, half_height = 0.4, mass = 8, g = 9.81;
  const double R = std::hypot(half_width, half_height), alpha = std::atan2(half_width, half_height);
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back(half_width * (k % 2 * 2 - 1), 0.05 * (k / 2 % 2 * 2 - 1),
                         half_height * (k / 4 * 2 - 1));
  const double about = mass / 3 * R * R, own = mass * (0.05 * 0.05 + R * R) / 3;
  const kernels::Kernel kernel = rigid_body(mass, {own, about, own}, corners, 1e-9);
  const double start = 0.6 * alpha;
  // φ = φ₀ (1 − s²) takes the singularity out of the integral.
  double quarter = 0;
  constexpr int parts = 20'000;
  for (int k = 0; k < parts; ++k) {
    const double s = (k + 0.5) / parts, phi = start * (1 - s * s);
    const double rate = std::sqrt(2 * mass * g * R / (about + mass * R * R) *
                                  (std::cos(alpha - start) - std::cos(alpha - phi)));
    quarter += 2 * start * s / rate / parts;
  }
  PlacedBody body;
  body.rotation = turn(start, Vector3d::UnitY());
  auto stepper = make_stepper(over_floor(kernel, body, {1, 1, 0}, {0, 0, -g}), stepping(2e4));
  double before = start;
  while (before > 0 && stepper->time() < 2 * quarter) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Vector3d axis = stepper->poses()[0].attitude * Vector3d::UnitX();
    before = -std::asin(axis.z());
    ASSERT_GT(stepper->active(), 0);
  }
  EXPECT_NEAR(stepper->time(), quarter, 5e-3 * quarter);
}

/// A spinning ball that slips throughout its impact: Δv_t = μ Δv_n, and the torque of friction turns it.
TEST(Floating, a_ball_in_gross_slip_gains_the_speed_of_Coulomb) {
  constexpr double mass = 0.5, radius = 0.02, mu = 0.2, inertia = 0.4 * mass * radius * radius;
  const kernels::Kernel kernel = rigid_body(mass, Vector3d::Constant(inertia), {{0, 0, -radius}}, 1e-13);
  PlacedBody body;
  body.velocity = {0, 0, -1};
  body.angular_velocity = {0, 400, 0};
  auto stepper = make_stepper(over_floor(kernel, body, {mu, mu, 0}, {0, 0, 0}), stepping(5e8));
  while (stepper->time() < 1e-7 || stepper->active() > 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const Pose end = stepper->poses()[0];
  const double normal = end.velocity.z() + 1;
  EXPECT_GT(end.velocity.z(), 0.9);
  EXPECT_NEAR(std::abs(end.velocity.x()) / (mu * normal), 1, 1e-6);
  EXPECT_NEAR(end.velocity.y(), 0, 1e-12);
  // The arm of friction is the radius, but for the angle by which the ball turns, 400 rad/s · 0.7 µs.
  EXPECT_NEAR(inertia * (400 - end.spin.y()) / (mass * std::abs(end.velocity.x()) * radius), 1, 1e-3);
  EXPECT_GT(end.velocity.x(), 0);  // its lowest point slips along −x
}

#if RICOCHET_HEAP_COUNTED
TEST(Floating, a_step_does_not_touch_the_heap) {
  Cloud cloud({0.05, 0.04, 0.03}, 2000, 1e-7, 8);
  cloud.couple();
  for (const double rate : {2e3, 1e5}) {  // with folded modes, and without
    const auto model = over_floor(cloud, {.rotation = turn(0.2, {1, 0.3, 0}),
                                          .velocity = {0.3, 0, -1},
                                          .height = 1e-3,
                                          .friction = Friction{0.5, 0.5, 0}});
    auto stepper = make_stepper(model, stepping(rate, Rotation::finite, 4));
    const long before = heap_counter::calls + heap_counter::returns;
    int touches = 0;
    for (int k = 0; k < 20'000; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      touches += stepper->active() > 0 ? 1 : 0;
    }
    EXPECT_EQ(heap_counter::calls + heap_counter::returns, before);
    EXPECT_GT(touches, 100);
  }
}
#endif

/// What turns cost is paid from the bank of a pair; the forces of the pair alone are reduced for the rest.
TEST(MeanForce, pays_from_the_bank_of_a_pair_and_reduces_its_forces) {
  const Cloud cloud({0.1, 0.08, 0.06}, 500, 1e-8, 3);
  const auto model = over_floor(cloud, {});
  MeanForce mean(*model, true);
  EXPECT_EQ(mean.draw(0, 1), 1) << "the bank is empty";
  EXPECT_EQ(mean.draw(0, -2), 0);
  EXPECT_EQ(mean.draw(0, 1.5), 0);
  EXPECT_EQ(mean.draw(0, 1), 0.5);
  mean.advance(Vector::Constant(model->rows(), 4), mean.pairs());
  mean.reduce(0, 0.5);
  EXPECT_EQ(mean.end(), Vector(Vector::Constant(model->rows(), 2)));
}

/// A damped body comes to rest, and then stays where it is, bears its weight, and is woken by a push.
TEST(Floating, that_has_come_to_rest_stays_there_until_it_is_pushed) {
  Cloud cloud({0.05, 0.04, 0.03}, 2000, 1e-7, 8);
  for (std::size_t n = 6; n < 81; ++n)
    cloud.kernel.modes.decay_rate[n] = 0.2 * cloud.kernel.modes.angular_frequency[n];
  const auto model = over_floor(cloud, {.rotation = turn(0.2, {1, 0.3, 0}),
                                        .velocity = {0.1, 0, 0},
                                        .height = 1e-3,
                                        .friction = Friction{0.5, 0.5, 0}});
  auto stepper = make_stepper(model, stepping(5e4));
  Vector3d before = stepper->poses()[0].position;
  int still = 0, steps = 0;
  for (; still < 1000 && steps < 200'000; ++steps) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    still = stepper->poses()[0].position == before ? still + 1 : 0;
    before = stepper->poses()[0].position;
  }
  ASSERT_EQ(still, 1000);
  EXPECT_GT(steps, 5000);
  EXPECT_NEAR(stepper->force().head(26).sum(), cloud.mass * 9.81, 1e-3 * cloud.mass * 9.81);
  EXPECT_GE(stepper->active(), 3);
  ASSERT_TRUE(stepper->push(0, {0, 0, 2 * cloud.mass * 9.81}, Vector3d::Zero()));
  for (int k = 0; k < 5000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->poses()[0].position.z() - before.z(), 0.5 * 9.81 * 0.01, 0.05 * 0.5 * 9.81 * 0.01);
}

/// Points that start inside the floor would be pushed out for nothing; no contact has filled the bank.
TEST(Floating, that_starts_inside_the_floor_gains_nothing_and_sinks_no_further) {
  const Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
  const auto model = over_floor(cloud, {.rotation = turn(0.3, {1, 2, 0}), .gravity = {0, 0, 0}});
  model->gap.array() -= 1e-5;
  auto stepper = make_stepper(model, stepping(1e5));
  for (int k = 0; k < 200; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    ASSERT_LE(stepper->modal()->energy().total(), 1e-20);
    ASSERT_LE((stepper->displacement().head(26) - model->gap).maxCoeff(), 1e-5 * (1 + 1e-9));
  }
}

/// Only the vibration of the body closes the gap, which its frame would not in the time between two searches.
TEST(Floating, that_vibrates_into_the_floor_is_kept_out) {
  const Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
  const auto model = over_floor(cloud, {.height = 1e-5, .gravity = {0, 0, 0}});
  for (int n = 6; n < 20; ++n) model->v0(n) = 0.05;
  auto stepper = make_stepper(model, stepping(1e7));
  const kernels::Surface& surface = cloud.kernel.surface;
  const Eigen::Map<const Matrix> shape(surface.shape.data(), 78, 81);
  double lowest = 1;
  int touches = 0;
  for (int k = 0; k < 10'000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    touches += stepper->active() > 0 ? 1 : 0;
    const Vector w = shape * stepper->modal()->q;
    for (Eigen::Index i = 0; i < 26; ++i) {
      const Vector3d arm = Eigen::Map<const Vector3d>(&surface.node[static_cast<std::size_t>(3 * i)]) -
                           cloud.centre + w.segment<3>(3 * i);
      lowest = std::min(lowest, stepper->poses()[0].at(arm).z());
    }
  }
  EXPECT_GT(touches, 100);
  // Contact flattens the points by R λ, which w does not contain; 3e-5 without contact.
  EXPECT_GT(lowest, -1e-5);
}

TEST(Floating, that_turns_too_far_in_a_step_is_refused) {
  const Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
  const auto model = over_floor(cloud, {.spin = {0, 3e9, 0}, .height = 1});
  EXPECT_THAT(
      ricochet::test::complaint_of([&] { make_stepper(model, stepping(1e6)); }),
      testing::StartsWith("bodies.cloud.angular_velocity: turns the body by 3e+03 rad in a contact step, "
                          "above 1. Raise time.contact_rate_hz"));
}

/// A constant torque about a principal axis, and a force, far from the floor.
TEST(Floating, that_is_pushed_from_outside_accelerates_as_Newton_says) {
  const Cloud cloud({0.1, 0.08, 0.06}, 500, 1e-8, 3);
  auto stepper = make_stepper(over_floor(cloud, {.height = 5, .gravity = {0, 0, 0}}), stepping(1e4));
  const Vector3d force(0.3, -0.2, 0.1);
  ASSERT_TRUE(stepper->push(0, force, Vector3d::Zero()));
  const Pose start = stepper->poses()[0];
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_LT((stepper->poses()[0].velocity - 0.1 * force / cloud.mass).norm(), 1e-12);
  EXPECT_LT((stepper->poses()[0].position - start.position - 0.005 * force / cloud.mass).norm(), 1e-12);
  EXPECT_NEAR(stepper->modal()->energy().loads, 0.5 * 0.01 * force.squaredNorm() / cloud.mass, 1e-13);
  // From rest, L = τ t, whatever the attitude; the work is the energy of the rotation.
  const Vector3d torque(1e-2, 2e-2, -1e-2);
  ASSERT_TRUE(stepper->push(0, Vector3d::Zero(), torque));
  const Energy before = stepper->modal()->energy();
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const Pose end = stepper->poses()[0];
  const Matrix3d A = end.attitude.toRotationMatrix();
  EXPECT_LT((A * cloud.inertia * A.transpose() * end.spin - 0.1 * torque).norm(), 1e-12 * torque.norm());
  EXPECT_GT(end.attitude.angularDistance(start.attitude), 0.1);
  const Energy after = stepper->modal()->energy();
  EXPECT_NEAR(after.ledger(), before.ledger(), 1e-12);
  EXPECT_NEAR(after.loads - before.loads, 0.05 * torque.dot(end.spin), 1e-9 * torque.dot(end.spin));
}

/// Tumbles on a floor with random settings: contact never adds energy, the impulses of the forces and of the
/// weight account for momentum and angular momentum, and nothing sinks in.
TEST(Floating, tumbling_keeps_the_balances) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> spread(-1, 1), unit(0, 1);
  int touches = 0;
  double turned = 0, deepest = 0;
  for (int scene = 0; scene < 24; ++scene) {
    const double size = std::pow(10, -2 + 1.5 * unit(random));
    const Cloud cloud({size, 0.7 * size, 0.4 * size}, 100 / size, scene % 4 == 3 ? 0 : 1e-8,
                      static_cast<unsigned>(100 + scene));
    Drop drop;
    drop.rotation = turn(3 * spread(random), {spread(random), spread(random), spread(random)});
    drop.velocity = {spread(random), spread(random), -1 - unit(random)};
    drop.spin = (scene % 3 == 2 ? 100 : 2) / size * ricochet::test::drawn(spread, random);
    drop.height = 0.2 * size;
    if (scene % 2 == 0) drop.friction = Friction{2 * unit(random), 0, 0};
    if (drop.friction) drop.friction->dynamic_coefficient = drop.friction->static_coefficient;
    const auto model = over_floor(cloud, drop);
    // Δ over six decades, from three periods of the lowest mode on
    const double rate = 100 / size * std::pow(10, -0.5 + 6 * unit(random));
    auto stepper = make_stepper(model, stepping(rate));
    const Pose start = stepper->poses()[0];
    Vector3d p = momentum(cloud, start);
    const double about_z = angular_momentum(cloud, start).z();
    double momentum_of_parts =
        cloud.mass * start.position.cross(start.velocity).norm() + (cloud.inertia.norm() * start.spin.norm());
    const double energy = stepper->modal()->energy().total(), scale = energy + cloud.mass * 9.81 * size;
    const double largest = p.norm();
    for (int k = 0; k < 25'000; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Pose now = stepper->poses()[0];
      const Energy& ledger = stepper->modal()->energy();
      ASSERT_LE(ledger.total(), energy + 1e-12 * scale) << scene << " " << k;
      ASSERT_NEAR(ledger.ledger(), energy, 1e-11 * scale) << scene << " " << k;
      const Vector3d push = -model->resultant(model->pairs[0], stepper->force(), *model),
                     weight = cloud.mass * drop.gravity;
      const Vector3d after = momentum(cloud, now), impulse = (push + weight) / rate;
      // Round-off. A body that falls asleep loses up to 1e-6 of the speed of a fall by its own size, and the
      // forces on it balance its weight to 1e-3.
      const bool asleep = now.velocity.isZero(0) && now.spin.isZero(0);
      const double at_rest = 1e-6 * cloud.mass * std::sqrt(2 * 9.81 * size) + 1e-3 * weight.norm() / rate;
      ASSERT_LT((after - p - impulse).norm(),
                1e-14 * (largest + after.norm() + impulse.norm()) + (asleep ? at_rest : 0))
          << scene << " " << k;
      p = after;
      if (push.z() > 0) ++touches;
      // Vertical forces have no moment about a vertical axis.
      momentum_of_parts = std::max(momentum_of_parts, cloud.mass * now.position.cross(now.velocity).norm() +
                                                          cloud.inertia.norm() * now.spin.norm());
      if (!drop.friction) {
        ASSERT_NEAR(angular_momentum(cloud, now).z(), about_z, 1e-12 * momentum_of_parts)
            << scene << " " << k;
      }
      turned = std::max(turned, now.attitude.angularDistance(start.attitude));
      deepest = std::max(deepest, (stepper->displacement().head(26) - model->gap).maxCoeff() / size);
    }
  }
  EXPECT_GT(touches, 1000);
  EXPECT_GT(turned, 2);
  // The drifts are rotations, which the step takes for straight lines. The longest step turns a body by half
  // a radian.
  EXPECT_LT(deepest, 5e-3);
}

TEST(Floating, refuses_a_body_whose_pieces_move_by_themselves) {
  Cloud cloud({0.1, 0.07, 0.04}, 1000, 1e-8, 3);
  cloud.kernel.piece_elements = {5, 7};
  const auto start = [&] { make_stepper(over_floor(cloud, {}), stepping(1e5)); };
  const auto complaint = [&] { return ricochet::test::complaint_of(start); };
  EXPECT_THAT(complaint(),
              testing::HasSubstr("2 pieces that are not joined at faces, which have 6 rigid modes"));
  cloud.kernel.parts = 2;
  EXPECT_THAT(complaint(), testing::HasSubstr("2 parts that are not joined, which have 6 rigid modes"));
  cloud.kernel.piece_elements.clear();
  EXPECT_NO_THROW(start());
}

}  // namespace
}  // namespace ricochet::contact::test
