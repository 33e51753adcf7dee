// Loads with histories and supports that move: modes and energy against Runge–Kutta steps of the equation of
// motion itself, bars against their waves and statics.
#include "contact/drives.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/integrator.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/heap_counter.hpp"

namespace {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ricochet::kernels::Kernel;
using ::testing::HasSubstr;

/// Knots at places that no step knows of, several in one step and none in others.
History ragged(double duration, unsigned seed, double start = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  History h{{start}, {start > 0 ? 0.7 : 0.0}};
  while (h.time.back() < 0.8 * duration) {
    h.time.push_back(h.time.back() + duration * (unit(random) < 0.5 ? 0.002 : 0.05) * (0.1 + unit(random)));
    h.value.push_back(2 * unit(random) - 1);
  }
  return h;
}

/// One mode by Runge–Kutta in extended precision, from knot to knot in pieces of at most `pace`:
/// p̈ = force h − 2δ (ṗ − lift h') − ω² (p − lift h), the motion with the support's, not relative to it.
struct Mode {
  long double omega, decay, force, lift;
  long double p = 0, rate = 0;

  void run(const History& h, double from, double to, double pace) {
    while (from < to) {
      const std::size_t knot = h.passed(from);
      const double end = knot < h.time.size() ? std::min(to, h.time[knot]) : to;
      const int pieces = static_cast<int>(std::ceil((end - from) / pace));
      const long double dt = (static_cast<long double>(end) - from) / pieces;
      const long double slope = h.slope(from);
      long double value = h.at(from);
      for (int k = 0; k < pieces; ++k, value += slope * dt) {
        const auto acceleration = [&](long double x, long double v, long double t) {
          const long double factor = value + slope * t;
          return force * factor - 2 * decay * (v - lift * slope) - omega * omega * (x - lift * factor);
        };
        const long double a1 = acceleration(p, rate, 0), v2 = rate + a1 * dt / 2;
        const long double a2 = acceleration(p + rate * dt / 2, v2, dt / 2), v3 = rate + a2 * dt / 2;
        const long double a3 = acceleration(p + v2 * dt / 2, v3, dt / 2), v4 = rate + a3 * dt;
        const long double a4 = acceleration(p + v3 * dt, v4, dt);
        p += dt * (rate + 2 * v2 + 2 * v3 + v4) / 6;
        rate += dt * (a1 + 2 * a2 + 2 * a3 + a4) / 6;
      }
      from = end;
    }
  }
};

/// Modes of one body and no contact: rigid ones with and without decay, and some below, at and above critical.
Model loose(const History& history, bool support, double step) {
  Model model;
  const std::vector<double> omega = {0, 0, 3, 30, 30, 30, 30, 250}, decay = {0, 5, 0, 0.1, 30, 33.5, 400, 25};
  const Eigen::Index N = static_cast<Eigen::Index>(omega.size());
  model.omega = Eigen::Map<const Vector>(omega.data(), N) * (0.01 / step);
  model.decay = Eigen::Map<const Vector>(decay.data(), N) * (0.01 / step);
  model.load = model.q0 = model.v0 = Vector::Zero(N);
  model.B = Matrix::Zero(0, N);
  model.R = Matrix::Zero(0, 0);
  model.gap = model.static_displacement = model.area = Vector::Zero(0);
  model.bodies.resize(1);
  model.bodies[0].modes = static_cast<int>(N);
  Model::Drive drive;
  drive.support = support;
  drive.history = history;
  drive.force = drive.lift = drive.displacement = Vector::Zero(0);
  drive.force.setConstant(N, support ? 0 : 1.5);
  drive.lift.setConstant(N, support ? 0.8 : 0);
  model.drives = {drive};
  return model;
}

// 1e-10: Runge–Kutta of order four with 4000 pieces a step and the highest mode at ωΔ = 2.5, and sums of 100 steps.
TEST(Drives, move_modes_of_any_damping_exactly_whatever_their_knots) {
  const double step = 0.01;
  constexpr int steps = 60;
  for (const bool support : {false, true})
    for (const double start : {-0.0123, 0.0, 0.0437}) {
      if (support && start > 0) continue;  // supports do not jump
      const History history = ragged(steps * step, 3, start);
      const Model model = loose(history, support, step);
      for (const Scheme scheme : {Scheme::compliant, Scheme::impulse}) {
        Integrator integrator(model, {.scheme = scheme, .step = step});
        std::vector<Mode> modes;
        for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
          modes.push_back({model.omega(n), model.decay(n), model.drives[0].force(n), model.drives[0].lift(n)});
          modes.back().p = modes.back().lift * history.at(0);
        }
        for (int k = 1; k <= steps; ++k) {
          ASSERT_EQ(integrator.step(), StepStatus::ok);
          for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
            Mode& mode = modes[n];
            mode.run(history, (k - 1) * step, k * step, step / 400);
            const double lift = model.drives[0].lift(n), size = support ? 1 : 1e-2;
            EXPECT_NEAR(integrator.q()(n) + lift * history.at(k * step), static_cast<double>(mode.p), 1e-9 * size)
                << n << " " << k << " " << support;
            EXPECT_NEAR(integrator.v()(n) + lift * history.slope(k * step), static_cast<double>(mode.rate), 1e-7 * size)
                << n << " " << k << " " << support;
          }
        }
      }
    }
}

/// A body with a load and a moving support over a floor, both with ragged histories, every mode damped.
Model busy(double step, double gap, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  Model model = loose(ragged(300 * step, seed), false, step);
  const Eigen::Index N = model.omega.size(), m = 3;
  model.load.setConstant(0.4);
  model.B = Matrix::NullaryExpr(m, N, [&] { return spread(random); });
  model.R = 1e-4 * step * step * Matrix::Identity(m, m) + Matrix::Constant(m, m, 2e-5 * step * step);
  model.has_residual = true;
  model.gap = Vector::Constant(m, gap);
  model.static_displacement = Vector::Zero(m);
  model.area = Vector::Ones(m);
  model.drives[0].displacement = Vector::Constant(m, 1e-4 * gap);
  Model::Drive support = loose(ragged(300 * step, seed + 1), true, step).drives[0];
  support.lift = 0.05 * gap * Vector::NullaryExpr(N, [&] { return spread(random); });
  support.displacement = model.B * support.lift + 0.3 * gap * Vector::Ones(m);
  model.drives.push_back(support);
  return model;
}

// Round-off of 400 steps; the theorem of the compliant scheme with drives that work.
TEST(Ledger, closes_with_loads_and_supports_that_change_within_steps) {
  const double step = 0.01;
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const StepOptions& options :
         {StepOptions{.scheme = Scheme::compliant, .step = step},
          StepOptions{.scheme = Scheme::impulse, .restitution = 0.3, .step = step},
          StepOptions{.scheme = Scheme::impulse, .admittance = Admittance::difference, .step = step}}) {
      Integrator integrator(busy(step, 1e-3, seed), options);
      const double start = integrator.energy().ledger();
      double size = 0, worst = 0, before = integrator.energy().total(), growth = 0;
      int touching = 0;
      for (int k = 0; k < 400; ++k) {
        ASSERT_EQ(integrator.step(), StepStatus::ok);
        const Energy& e = integrator.energy();
        size = std::max({size, e.kinetic + e.strain, std::abs(e.loads)});
        worst = std::max(worst, std::abs(e.ledger() - start));
        growth = std::max(growth, e.total() - before);
        before = e.total();
        touching += integrator.active() > 0;
      }
      EXPECT_GT(touching, 10);
      EXPECT_LT(worst, 1e-12 * size) << seed;
      if (options.admittance == Admittance::jump) EXPECT_LT(growth, 1e-12 * size) << seed;
    }
}

// E(t) and the work ∫ f q̇ dt by quadrature of the Runge–Kutta solution.
TEST(Ledger, counts_the_work_of_a_load_as_its_integral) {
  const double step = 0.01;
  const History history = ragged(20 * step, 8);
  const Model model = loose(history, false, step);
  Integrator integrator(model, {.step = step});
  for (int k = 0; k < 20; ++k) ASSERT_EQ(integrator.step(), StepStatus::ok);
  long double work = 0, lost = 0;
  for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
    Mode mode{model.omega(n), model.decay(n), 1.5L, 0};
    for (double t = 0; t < 20 * step - 1e-9;) {  // midpoint rule; knots bound the pieces
      const std::size_t knot = history.passed(t);
      const double end = std::min({t + step / 2000, 20 * step, knot < history.time.size() ? history.time[knot] : 1.0});
      const double middle = 0.5 * (t + end);
      mode.run(history, t, middle, step);
      work += (end - t) * 1.5L * history.at(middle) * mode.rate;
      lost += (end - t) * 2 * mode.decay * mode.rate * mode.rate;
      mode.run(history, middle, end, step);
      t = end;
    }
  }
  // the midpoint rule of 2000 pieces a step, the highest mode at ωΔ = 2.5: 1e-7
  EXPECT_NEAR(integrator.energy().loads, static_cast<double>(work), 1e-6 * std::abs(static_cast<double>(work)));
  EXPECT_NEAR(integrator.energy().damping, static_cast<double>(lost), 1e-6 * static_cast<double>(lost));
}

// A unit mass on a support that lifts it at speed 2 from t = 0: the lift is rigid, and the ledger must find
// ½ m v² of work, although the mass vibrates against the lift before its damper stops it.
TEST(Ledger, counts_the_work_of_a_support_that_gets_a_body_moving) {
  Model model = loose({{0, 100}, {0, 200}}, true, 0.01);
  for (Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->conservativeResize(1);
  model.omega << 50;
  model.decay << 20;
  model.B.resize(0, 1);
  model.bodies[0].modes = 1;
  model.drives[0].force = Vector::Zero(1);
  model.drives[0].lift = Vector::Ones(1);
  Integrator integrator(model, {.step = 0.01});
  EXPECT_EQ(integrator.energy().kinetic, 0);
  for (int k = 0; k < 500; ++k) ASSERT_EQ(integrator.step(), StepStatus::ok);
  EXPECT_NEAR(integrator.energy().kinetic, 2, 1e-12);
  EXPECT_NEAR(integrator.energy().strain, 0, 1e-12);
  // the support works 2 J on the mass and 2 J on the damper: seen from the support, the mass starts at speed −2
  EXPECT_NEAR(integrator.energy().damping, 2, 1e-12);
  EXPECT_NEAR(integrator.energy().loads, 4, 1e-12);
}

constexpr double length = 10;

/// Bar along x, clamped at x = 0, with ρA = EA = c = 1: candidates are both ends.
/// φ_n = √(2/L) sin((n + ½)πx/L), residuals by 2e5 further modes. Γ = ∫ φ_n, Ψ = 1. A receiver in the middle.
Kernel clamped_bar(int modes) {
  Kernel kernel = rod(1, length, false);
  kernel.supported = true;
  const auto wave = [](int n) { return (n + 0.5) * std::numbers::pi / length; };
  const auto phi = [&](int n, double x) { return std::sqrt(2 / length) * std::sin(wave(n) * x); };
  const auto sum = [&](double x) { return std::sqrt(2 / length) / wave(0) * 0 + std::sqrt(2 / length) / wave(static_cast<int>(x)); };
  kernel.modes.angular_frequency.clear();
  kernel.surface.shape.clear();
  kernel.loads.body_force.assign(3 * static_cast<std::size_t>(modes), 0);
  kernel.loads.rotation.assign(3 * static_cast<std::size_t>(modes), 0);
  for (int n = 0; n < modes; ++n) {
    kernel.modes.angular_frequency.push_back(wave(n));
    kernel.loads.body_force[n] = sum(n);
  }
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), 0);
  for (const double x : {0.0, length})
    for (int n = 0; n < modes; ++n) kernel.surface.shape.push_back(phi(n, x));
  // statics: a force at y displaces x by min(x, y); its own weight by x (2L − x)/2; the lift is 1
  const auto rest = [&](double x, double y) {
    double out = std::min(x, y);
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * phi(n, y) / (wave(n) * wave(n));
    return out;
  };
  const auto sag = [&](double x) {
    double out = x * (2 * length - x) / 2;
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * sum(n) / (wave(n) * wave(n));
    return out;
  };
  const auto lift = [&](double x) {
    double out = 1;
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * sum(n);
    return out;
  };
  kernel.surface.residual_flexibility = {0, 0, 0, rest(length, length)};
  kernel.loads.body_force_residual = {0, 0, 0, sag(length), 0, 0};
  double momentum = length;
  for (int n = 0; n < modes; ++n) momentum -= sum(n) * sum(n);
  ricochet::kernels::Motion foot{"foot", kernel.loads.body_force, {lift(0), 0, 0, lift(length), 0, 0}, {}};
  foot.momentum = {momentum, 0, 0, 0, 0, 0, 0, 0, 0};
  kernel.motions = {foot};
  // a force along x at the tip
  ricochet::kernels::Load tip{"tip", "N", {}, {1, 0, 0, 0, 0, 0, 0, 0, 0}, std::vector<double>(9, 0), {}};
  for (int n = 0; n < modes; ++n) tip.participation.push_back(phi(n, length));
  tip.participation.resize(3 * static_cast<std::size_t>(modes), 0);
  tip.residual = {0, 0, 0, rest(length, length), 0, 0};
  kernel.applied = {tip};
  const double middle = length / 2;
  ricochet::kernels::Receiver mic{"mic", {middle, 0, 0}, {}, {}, {}, {}, {}};
  for (int n = 0; n < modes; ++n) mic.shape.push_back(phi(n, middle));
  mic.shape.resize(3 * static_cast<std::size_t>(modes), 0);
  mic.residual_flexibility = {0, rest(middle, length), 0, 0, 0, 0};
  mic.body_force_residual = {sag(middle), 0, 0, 0, 0, 0, 0, 0, 0};
  mic.load_residual = {rest(middle, length), 0, 0, 0, 0, 0, 0, 0, 0};
  mic.motion_residual = {lift(middle), 0, 0, 0, 0, 0, 0, 0, 0};
  kernel.receivers = {mic};
  return kernel;
}

}  // namespace
