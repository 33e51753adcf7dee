// SPDX-License-Identifier: BSD-2-Clause
// Supported bodies start at rest in their static equilibrium. The oracle is the clamped bar: under gravity g
// its end moves by ρ g L²/(2 E), under a force F at its end by F L/(E A).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/figures/summary_observer.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/plate.hpp"
#include "tests/kernels/bar.hpp"

namespace static_start_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ricochet::kernels::test::Bar;

constexpr double g = 0.2, force = 0.05, gap = 0.5;

/// The bar with a load "pull" at its end.
Kernel pulled(const Bar& bar) {
  Kernel kernel = bar.kernel();
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  const std::size_t n = kernel.modes.size();
  ricochet::kernels::Load load{
      .name = "pull", .unit = "N", .participation = {}, .total = {}, .moment = {}, .residual = {}};
  load.participation.assign(3 * n, 0);
  std::copy_n(kernel.surface.shape.begin(), n, load.participation.begin());
  load.total = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  load.moment.assign(9, 0);
  load.residual = {kernel.surface.residual_flexibility[0], 0, 0};
  kernel.applied.push_back(load);
  return kernel;
}

Model hung(const Kernel& kernel, const History* history, double gravity = g, double from_wall = gap) {
  std::vector<ForcingRequest> loads;
  if (history != nullptr)
    loads.push_back({.body = "bar", .name = "pull", .vector = Vector3d(force, 0, 0), .history = *history});
  return build_model({{"bar", &kernel}}, {{"wall", {1.7 + from_wall, 0, 0}, {-1, 0, 0}}},
                     {{"bar", "wall", {}, {}, {}}}, Vector3d(gravity, 0, 0), loads);
}

const Bar bar{.at = {1}};
const double sag = bar.density * g * bar.length * bar.length / (2 * bar.young);
const double stretch = force * bar.length / (bar.young * bar.area);

/// Largest deviation of the end from `rest` in 500 steps, and the largest error of the ledger.
std::pair<double, double> motion(const Model& model, StepOptions options, double rest) {
  const auto stepper = make_stepper(model, options);
  double farthest = std::abs(stepper->displacement()(0) - rest), drift = 0;
  const double ledger = stepper->modal()->energy().ledger();
  for (int k = 0; k < 500; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    farthest = std::max(farthest, std::abs(stepper->displacement()(0) - rest));
    drift = std::max(drift, std::abs(stepper->modal()->energy().ledger() - ledger));
  }
  return {farthest, drift};
}

// 1e-9: the residuals of the bar are sums over modes with this accuracy at least; round-off of 500 steps.
TEST(SupportedBody, hangs_at_rest_under_gravity) {
  const Kernel kernel = pulled(bar);
  const Model model = hung(kernel, nullptr);
  EXPECT_NEAR(model.initial_displacement()(0), sag, 1e-9 * sag);
  EXPECT_GT(sag, 0.19);
  // Steps that sample all modes, some, and none but the lowest.
  for (const double step : {1e-3, 0.05, 1.0}) {
    const auto [moved, drift] = motion(model, {.step = step}, sag);
    EXPECT_LT(moved, 1e-9 * sag) << step;
    EXPECT_LT(drift, 1e-12) << step;
  }
  EXPECT_LT(motion(model, {.contact = {.scheme = Scheme::impulse}, .step = 1e-3}, sag).first, 1e-9 * sag);
}

TEST(SupportedBody, hangs_at_rest_under_loads_that_always_acted) {
  const Kernel kernel = pulled(bar);
  const History always{{-1}, {1}}, doubled{{-2, -1, 3}, {0, 2, 2}}, begins{{0}, {1}}, grows{{-1, 1}, {1, 2}};
  for (const auto& [history, factor] : {std::pair{&always, 1.0}, std::pair{&doubled, 2.0}}) {
    EXPECT_TRUE(history->dead());
    const Model model = hung(kernel, history);
    EXPECT_NEAR(model.initial_displacement()(0), sag + factor * stretch, 1e-9);
    const auto [moved, drift] = motion(model, {.step = 1e-3}, sag + factor * stretch);
    EXPECT_LT(moved, 1e-9);
    EXPECT_LT(drift, 1e-12);
  }
  EXPECT_FALSE(begins.dead());
  EXPECT_FALSE(grows.dead());
  // A load that begins at t = 0 overshoots to twice the stretch.
  const auto [moved, drift] = motion(hung(kernel, &begins), {.step = 0.01}, sag);
  EXPECT_NEAR(moved, 2 * stretch, 0.05 * stretch);  // the end of the wave in modes up to n = 40
  EXPECT_LT(drift, 1e-12);
}

TEST(SupportedBody, that_gravity_presses_into_another_is_refused_with_the_depth) {
  const Kernel kernel = pulled(bar);
  EXPECT_NO_THROW(refuse_sag(hung(kernel, nullptr, g, sag * (1 + 1e-6))));
  EXPECT_THAT(complaint_of([&] { refuse_sag(hung(kernel, nullptr, g, sag - 0.01)); }),
              HasSubstr("press \"bar\" 0.01 m into \"wall\" before they start"));
  EXPECT_NO_THROW(refuse_sag(hung(kernel, nullptr, -g, 0)));  // away from the wall
}

// Pulled at its tip, the bar touches the wall from the start: R answers at once, and modes take their time.
TEST(SupportedBody, that_a_sudden_load_presses_into_another_is_refused_with_the_name_of_the_load) {
  const Kernel kernel = pulled(bar);
  const History begins{{0}, {1}}, rises{{0, 1e-4}, {0, 1}}, always{{-1}, {1}};
  const std::string complaint = complaint_of([&] { refuse_sag(hung(kernel, &begins, 0, 0)); });
  EXPECT_THAT(complaint, HasSubstr("loads: \"pull\" begins with the factor 1 at t = 0"));
  EXPECT_THAT(complaint, Not(HasSubstr("gravity")));
  EXPECT_NO_THROW(refuse_sag(hung(kernel, &rises, 0, 0)));
  EXPECT_THAT(complaint_of([&] { refuse_sag(hung(kernel, &always, 0, 0)); }),
              HasSubstr("constant loads press"));
  EXPECT_THAT(complaint_of([&] { refuse_sag(hung(kernel, &begins, g, 0)); }),
              HasSubstr("gravity and constant"));
}

TEST(FreeBody, falls_without_strain) {
  const Bar free{.clamped = false, .at = {1}};
  const Kernel kernel = pulled(free);
  const Model model = hung(kernel, nullptr);
  EXPECT_EQ(model.q0.norm(), 0);
  EXPECT_EQ(model.initial_displacement()(0), 0);
  const auto stepper = make_stepper(model, {.step = 1e-3});
  for (int k = 0; k < 100; ++k) stepper->step();
  EXPECT_NEAR(stepper->displacement()(0), g * 0.01 / 2, 1e-15);  // ½ g t², t = 0.1 s
}

// The energy of the sag is not energy of the impact: a rigid mass that hits a heavy sagging bar.
TEST(Summary, relates_losses_to_the_energy_above_the_start_at_rest) {
  const Kernel hanging = pulled(bar), falling = rod(1, 0.1);
  const Model model = build_model(
      {{"bar", &hanging}, {"rod", &falling, Matrix3d::Identity(), {1.7 + gap, 0.4, 0}, {-1, 0, 0}}}, {},
      {{"bar", "rod", Vector3d(1, 0, 0), {}, {}}}, Vector3d(g, 0, 0));
  const StepOptions options{.contact = {.scheme = Scheme::impulse, .restitution = 0}, .step = 1e-3};
  const auto stepper = make_stepper(model, options);
  SummaryObserver observer(model, options.step, 0);
  for (int k = 0; k < 500; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  const Summary summary = observer.summary();
  ASSERT_FALSE(summary.episodes.empty());
  EXPECT_LT(summary.energy_drift.value(), 1e-12);
  EXPECT_GT(summary.energy_lost_contact.value(), 0);
  EXPECT_LE(summary.energy_lost_contact.value(), 1);
  // The rod had ½ m v² when it arrived; the strain of the sag, ρ² g² A L³/(6 E), is not part of it.
  const double lost = stepper->modal()->energy().contact,
               strain = stepper->modal()->system->stiffness.dot(model.q0.cwiseAbs2()) / 2;
  EXPECT_NEAR(strain, std::pow(bar.density * g, 2) * bar.area * std::pow(bar.length, 3) / (6 * bar.young),
              1e-3 * strain);  // 40 modes
  const double arrived = lost / summary.energy_lost_contact.value();
  EXPECT_GT(arrived, 0.4 * 0.1 * 0.5);
  EXPECT_LT(arrived, 0.5 * 0.1 * 1.0);
}

}  // namespace static_start_test
