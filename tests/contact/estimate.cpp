// SPDX-License-Identifier: BSD-2-Clause
// Error estimates compared with true errors, each with a single source of error. Two rods collide,
// represented by their exact modes. D'Alembert's solution is the reference: the rods exchange their
// velocities, and the impulse is the momentum of one rod.
#include "contact/accuracy/estimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/accuracy/dial.hpp"
#include "contact/accuracy/error_report.hpp"
#include "contact/accuracy/inertia.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/rigid_plate.hpp"
#include "tests/contact/sphere_on_patches.hpp"

namespace estimate_test {

using namespace ricochet::contact;
using ricochet::RadPerSecond;
using namespace ricochet::contact::test;

constexpr double length = 10, speed = 1, duration = 30;

Model collision(const std::vector<Kernel>& rods) {
  return build_model(
      {{.name = "a", .kernel = rods.data(), .translation = {-length, 0, 0}, .velocity = {speed, 0, 0}},
       {.name = "b", .kernel = &rods[1]}},
      {}, {PairRequest{"a", "b", Vector3d(1, 0, 0), {}, {}}}, {0, 0, 0});
}

std::vector<Kernel> rods(int modes) { return {rod(modes, length), rod(modes, length)}; }

/// A subject with its estimator.
struct Estimated {
  explicit Estimated(Subject subject) : of(std::move(subject)), estimator(of, of.rebuild(of.kernels)) {}
  Subject of;
  Estimator estimator;
};

Subject subject(int modes) { return {.rebuild = collision, .kernels = rods(modes), .duration = duration}; }

/// The largest distance of impulse and rebound.
double distance(const Quantities& a, const Quantities& b) {
  const Errors errors = distances(a, b);
  return std::max(errors.at(Quantity::impulse), errors.at(Quantity::rebound));
}

double largest(const std::optional<Errors>& errors) {
  return std::max(errors.value().at(Quantity::impulse), errors.value().at(Quantity::rebound));
}

/// Error of impulse and rebound compared with the wave solution. The second three components of the rebound
/// are the velocity of the rod that was struck.
double true_error(const Quantities& found) {
  Figure impulse{Vector::Constant(1, length * speed), length * speed}, rebound{Vector::Zero(6), speed};
  rebound.value[3] = speed;
  Quantities exact;
  exact.figures = {{Quantity::impulse, impulse}, {Quantity::rebound, rebound}};
  return distance(exact, found);
}

TEST(Quantities, of_colliding_rods_are_those_of_the_waves) {
  const auto found = impact_quantities(collision(rods(200)), {.step = 0.002}, 15000);
  ASSERT_TRUE(found);
  EXPECT_LT(true_error(*found), 2e-3);  // error of 200 modes
  EXPECT_NEAR(found->longest_touch, 2 * length, 0.5);
  EXPECT_NEAR(found->figures.at(Quantity::rebound).scale, speed, 1e-12);
}

// The same run, step by step. With half of the modes, contact opens and closes several times.
TEST(Quantities, of_forces_are_those_of_all_steps) {
  const std::vector<Kernel> kernels = rods(20);
  const Model model = collision(kernels);
  const StepOptions options{.step = 0.01};
  const auto found = impact_quantities(model, options, 3000);
  ASSERT_TRUE(found);
  const auto stepper = make_stepper(model, options);
  double impulse = 0, peak = 0, contact = 0;
  std::vector<double> force;
  for (int k = 0; k < 3000; ++k) {
    ASSERT_EQ(stepper->step(), ricochet::StepStatus::ok);
    force.push_back(stepper->force().sum());
    impulse += force.back() * options.step;
    peak = std::max(peak, force.back());
    contact += force.back() > 0 ? options.step : 0;
  }
  while (force.back() == 0) force.pop_back();
  ASSERT_EQ(found->force.size(), force.size());
  // 1e-9: quantities are found with look-ahead blocks, whose round-off impacts amplify.
  for (std::size_t k = 0; k < force.size(); ++k) EXPECT_NEAR(found->force[k], force[k], 1e-9 * peak) << k;
  const auto figure = [&](Quantity quantity) {
    const Figure& of = found->figures.at(quantity);
    EXPECT_EQ(of.scale, of.value[0]);
    return of.value[0];
  };
  EXPECT_NEAR(figure(Quantity::impulse), impulse, 1e-9 * impulse);
  EXPECT_NEAR(figure(Quantity::peak_force), peak, 1e-9 * peak);
  EXPECT_NEAR(figure(Quantity::duration), contact, 1e-9);
  // One touch, as moments without a force do not end it.
  const auto first = std::ranges::find_if(force, [](double f) { return f > 0; });
  EXPECT_NEAR(found->longest_touch, static_cast<double>(force.end() - first) * options.step, 1e-9);
  EXPECT_GT(peak, 0.5);  // Z v/2 is the mean force
}

// The impact speed is √(2 g h) after a fall of h = ½ at g = 1. A run that
// starts at rest has no other reference speed.
TEST(Quantities, of_a_falling_rod_are_measured_by_the_speed_at_which_it_meets_the_wall) {
  const Kernel kernel = rod(8, length);
  const Model model = build_model({{.name = "a", .kernel = &kernel, .translation = {-length, 0, 0}}},
                                  {{.name = "wall", .point = {0.5, 0, 0}, .normal = {-1, 0, 0}}},
                                  {PairRequest{"a", "wall", {}, {}, {}}}, {1, 0, 0});
  const auto found = impact_quantities(model, {.step = 1e-3}, 2000);  // the run ends while contact lasts
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->figures.at(Quantity::rebound).scale, 1, 2e-3);  // error of one step
  EXPECT_NEAR(found->longest_touch, 1, 0.1);
}

TEST(Distances, are_relative_to_the_scale_of_each_quantity) {
  Quantities a, b;
  a.figures = {{Quantity::impulse, {Vector::Constant(1, 1), 10}}, {Quantity::rebound, {Vector::Zero(2), 2}}};
  b = a;
  b.figures[Quantity::impulse].value[0] = 2;
  b.figures[Quantity::rebound].value << 0.3, 0.4;
  EXPECT_DOUBLE_EQ(distances(a, b).at(Quantity::impulse), 0.1);
  EXPECT_DOUBLE_EQ(distances(a, b).at(Quantity::rebound), 0.25);
  EXPECT_EQ(distances(a, a).at(Quantity::rebound), 0);
  a.figures[Quantity::rebound].scale = 0;
  EXPECT_EQ(distances(a, b).at(Quantity::rebound), std::numeric_limits<double>::infinity());
}

// A run with steps a hundred times shorter is the reference without step error. With rigid modes alone, the
// residual flexibility is a spring, and contact is smooth; shocks of a truncated series converge too slowly.
TEST(StepShare, is_near_the_true_error_of_the_step) {
  for (const Scheme scheme : {Scheme::compliant, Scheme::impulse})
    for (const double step : {0.2, 0.05}) {
      Estimated estimated(subject(scheme == Scheme::compliant ? 1 : 12));
      Estimator& estimator = estimated.estimator;
      const StepOptions options{.contact = {.scheme = scheme}, .step = step};
      const auto fine =
          impact_quantities(estimator.model(), {.contact = {.scheme = scheme}, .step = step / 100},
                            std::llround(duration / step * 100));
      const double error = distance(*fine, *estimator.quantities(options)),
                   share = largest(estimator.step(options));
      // A step that hardly errs, as on a spring, has a share of this size by chance.
      EXPECT_LT(error, std::max(3 * share, 1e-6)) << "step " << step;
      EXPECT_LT(share, std::max(10 * error, 1e-6)) << "step " << step;
    }
}

// Steps that do not sample all modes truncate their series at a front, where no order is proven.
TEST(StepShare, assumes_no_order_of_steps_that_sample_only_some_modes) {
  for (double step = 0.9; step > 0.1; step *= 0.95) {
    Estimated estimated(subject(120));
    const StepOptions options{.step = step};
    const double error = true_error(*estimated.estimator.quantities(options)),
                 share = largest(estimated.estimator.step(options));
    EXPECT_LT(error, 2 * share) << "step " << step;
    EXPECT_GT(error, 0.1 * share) << "step " << step;
  }
}

// The error of a shock varies irregularly with the number of modes, as does the
// estimate, so only most cases must hold.
TEST(ModesShare, holds_for_nine_of_ten_numbers_of_modes_and_is_close_for_seven) {
  int within = 0, close = 0, all = 0;
  for (int modes = 5; modes <= 64; modes += 3, ++all) {
    Estimated estimated(subject(modes));
    Estimator& estimator = estimated.estimator;
    const StepOptions options{.step = 5e-3};
    const ErrorEstimate found = estimator.estimate(options);
    const double error = true_error(*estimator.quantities(options));
    within += error <= 3 * found.total() ? 1 : 0;
    close += found.total() <= 10 * error ? 1 : 0;
    EXPECT_EQ(found.share(Cause::spacing), 0);  // one contact point
    EXPECT_EQ(found.share(Cause::eigensolver), 0);
    EXPECT_FALSE(found.share(Cause::mesh));
  }
  EXPECT_GE(within, 0.9 * all);
  EXPECT_GE(close, 0.7 * all);
}

/// The rod of finite elements of this order, with all modes that they have. Functions: hats, and integrals of
/// Legendre's polynomials within the elements.
Kernel rod_of_elements(int elements, int order) {
  const int nodes = elements + 1, inner = order - 1, all = nodes + elements * inner;
  const double h = length / elements;
  Matrix K = Matrix::Zero(all, all), M = K;
  for (int e = 0; e < elements; ++e) {
    Matrix stiff = Matrix::Zero(order + 1, order + 1), mass = stiff;
    stiff.topLeftCorner(2, 2) << 1 / h, -1 / h, -1 / h, 1 / h;
    mass.topLeftCorner(2, 2) << 2.0 / 3, 1.0 / 3, 1.0 / 3, 2.0 / 3;
    for (int k = 2; k <= order; ++k) {  // (P_k − P_(k−2))/√(2(2k − 1))
      stiff(k, k) = 2 / h;
      mass(k, k) = 2.0 / ((2 * k + 1) * (2 * k - 3));
      if (k + 2 <= order)
        mass(k, k + 2) = mass(k + 2, k) = -1 / ((2 * k + 1) * std::sqrt((2.0 * k - 1) * (2 * k + 3)));
      if (k <= 3)
        for (const int end : {0, 1})
          mass(k, end) = mass(end, k) =
              k == 2 ? -1 / std::sqrt(6) : (end == 0 ? 1 : -1) / (3 * std::sqrt(10));
    }
    std::vector<int> at{e, e + 1};
    for (int k = 0; k < inner; ++k) at.push_back(nodes + e * inner + k);
    K(at, at) += stiff;
    M(at, at) += h / 2 * mass;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(K, M);
  Kernel out = rod(all, length, false);
  out.dofs = all;
  for (int n = 1; n < all; ++n) {  // the rigid mode is known
    out.modes.angular_frequency[n] = std::sqrt(modes.eigenvalues()[n]);
    out.surface.shape[n] = modes.eigenvectors()(0, n);
    out.surface.shape[all + n] = modes.eigenvectors()(elements, n);
  }
  out.surface.residual_flexibility.assign(4, 0);
  out.loads.body_force_residual.assign(6, 0);
  return out;
}

// The upper modes of elements are not those of the rod, and the highest ones hardly matter: without this
// knowledge, shares are up to 35 times too small. A front doubles the scatter.
TEST(ModesShare, counts_modes_that_elements_do_not_resolve_as_truncated) {
  for (const int order : {4, 6, 8})
    for (const int elements : {6, 12, 24}) {
      const Kernel kernel = rod_of_elements(elements, order);
      Estimated estimated({.rebuild = collision, .kernels = {kernel, kernel}, .duration = duration});
      const StepOptions options{.step = length / (4 * static_cast<double>(kernel.dofs))};
      const ErrorEstimate found = estimated.estimator.estimate(options);
      const double error = true_error(*estimated.estimator.quantities(options));
      EXPECT_LT(error, 2 * found.total()) << elements << " of order " << order << ": " << formatted(found);
      EXPECT_GT(error, 0.1 * found.total()) << elements << " of order " << order << ": " << formatted(found);
    }
}

// Without the static correction, the truncated modes remove 2L/(πc)·ω of the energy of the ends.
TEST(ModesShare, is_larger_without_residual_flexibility) {
  double sum[2] = {0, 0};
  for (int modes = 16; modes < 48; modes += 4)
    for (const bool residual : {true, false}) {
      Estimated estimated({.rebuild = collision,
                           .kernels = {rod(modes, length, residual), rod(modes, length, residual)},
                           .duration = duration});
      sum[residual ? 0 : 1] += *estimated.estimator.estimate({.step = 5e-3}).share(Cause::modes);
    }
  EXPECT_GT(sum[1], sum[0]);
}

// A body whose lower modes do not move the contact point: their number says nothing about modes above them.
TEST(ModesShare, is_unknown_if_accuracy_would_rest_on_changes_that_still_grow) {
  const auto place = [](const std::vector<Kernel>& kernels) {
    return build_model({{.name = "rod", .kernel = kernels.data(), .velocity = {1, 0, 0}}},
                       {{.name = "wall", .point = {1, 0, 0}, .normal = {-1, 0, 0}}},
                       {PairRequest{"rod", "wall", {}, {}, {}}}, {0, 0, 0});
  };
  for (const bool still : {false, true}) {
    constexpr std::size_t modes = 17;
    Kernel kernel = rod(modes, 1);
    for (std::size_t end : {0, 1})
      for (std::size_t n = 1; still && n <= 10; ++n) kernel.surface.shape[end * modes + n] = 0;
    Estimated estimated({.rebuild = place, .kernels = {kernel}, .duration = 3});
    const StepOptions options{.step = 1e-3};
    const double total = estimated.estimator.estimate(options).total();
    EXPECT_EQ(estimated.estimator.growing_change() > 0, still);
    const auto share = [&](double accuracy) {
      return dial(estimated.of, place(estimated.of.kernels), {.accuracy = accuracy, .options = options})
          .estimate->share(Cause::modes);
    };
    EXPECT_NE(share(3 * total).has_value(), still);
    EXPECT_TRUE(share(total / 2)) << "above the accuracy in any case";
  }
}

/// A solid of unit mass, one point of which hits a wall. Its modes n ≤ `last` have the frequencies nπ and
/// move the point by √2 weight(n); those above `modes` respond at once.
Subject solid(int modes, int last, const std::function<double(int)>& weight) {
  Kernel kernel = rod(modes + 1, 1);
  kernel.surface.element_corners = 3;
  kernel.surface.element.clear();
  std::ranges::fill(kernel.surface.residual_flexibility, 0);
  for (int n = 1; n <= last; ++n)
    if (n <= modes)
      for (const int end : {0, 1})
        kernel.surface.shape[static_cast<std::size_t>(end * (modes + 1) + n)] *= weight(n);
    else
      kernel.surface.residual_flexibility[3] += 2 * std::pow(weight(n) / (n * std::numbers::pi), 2);
  const auto place = [](const std::vector<Kernel>& kernels) {
    return build_model({{.name = "solid", .kernel = kernels.data(), .velocity = {1, 0, 0}}},
                       {{.name = "wall", .point = {1, 0, 0}, .normal = {-1, 0, 0}}},
                       {PairRequest{"solid", "wall", {}, {}, {}}}, {0, 0, 0});
  };
  return {.rebuild = place, .kernels = {std::move(kernel)}, .duration = 3};
}

struct SolidCase {
  std::string name;
  std::function<double(int)> weight;
};

// Patches far smaller than the shortest wave make the force smooth; the mean of a face meets a front; and
// modes of another kind, which leave the point at rest, say nothing of those that move it.
TEST(ModesShare, of_solids_follows_smooth_forces_fronts_and_modes_of_a_kind_that_the_band_lacks) {
  const auto small_patch = [](int n) { return n / 20.0; };
  const auto face = [](int) { return 1.0; };
  const auto two_kinds = [](int n) { return n <= 12 ? 0.0 : 1.0; };
  for (const auto& [name, weight] :
       {SolidCase{"patch", small_patch}, SolidCase{"face", face}, SolidCase{"kinds", two_kinds}})
    for (const int modes : {10, 12, 14, 20, 28, 40}) {
      const StepOptions options{.step = 1.0 / modes / 16};
      Estimated estimated(solid(modes, 400, weight));
      const ErrorEstimate found = estimated.estimator.estimate(options);
      const Subject all = solid(400, 400, weight);
      const auto truth = impact_quantities(all.rebuild(all.kernels), {.step = 1e-4}, 30000);
      ASSERT_TRUE(truth);
      const double error = distance(*truth, *estimated.estimator.quantities(options));
      const double share = largest(found.by_cause.at(Cause::modes));
      EXPECT_LT(error, 3 * share) << name << ", " << modes << " modes";
      // The phase of a front may leave the modes above a band without energy; its error is at most of the
      // first order. A smooth force decays faster than this order, for which the change by half of the band
      // stands.
      const double most = name == "face" ? 1.0 / modes : (name == "patch" ? 20 : 5) * error;
      EXPECT_LT(share, most) << name << ", " << modes << " modes";
      EXPECT_EQ(estimated.estimator.growing_change(), 0);
    }
}

TEST(ModesShare, is_unknown_where_there_is_no_mode_to_leave_out) {
  Estimated estimated(subject(1));
  Estimator& estimator = estimated.estimator;
  EXPECT_FALSE(estimator.estimate({.step = 0.05}).share(Cause::modes));
}

// By the Kato–Temple bound, the error of λ is at most r² λ²/gap. A tenth of the residual
// therefore gives a hundredth of the share.
TEST(EigensolverShare, goes_with_the_square_of_the_residuals) {
  double share[2];
  for (int k = 0; k < 2; ++k) {
    Subject with = subject(16);
    for (Kernel& kernel : with.kernels) kernel.modes.residual.assign(16, k == 0 ? 1e-3 : 1e-4);
    share[k] = largest(
        Estimated(std::move(with)).estimator.estimate({.step = 0.02}).by_cause.at(Cause::eigensolver));
  }
  EXPECT_GT(share[1], 0);
  EXPECT_NEAR(share[0] / share[1], 100, 1e-6);
}

// The eigenvalues of a rod go with n², so those next to n = 6 are 11/36 of λ and more away.
TEST(EigensolverShare, is_half_of_the_bound_of_Kato_and_Temple_for_a_single_mode) {
  const double residual = 1e-3, error = residual * residual * 36 / 11 / 2, change = 1e-3;
  Subject with = subject(16);
  for (Kernel& kernel : with.kernels) {
    kernel.modes.residual.assign(16, 0);
    kernel.modes.residual[6] = residual;
  }
  const double share =
      largest(Estimated(std::move(with)).estimator.estimate({.step = 0.02}).by_cause.at(Cause::eigensolver));
  const auto run = [](double factor) {
    std::vector<Kernel> kernels = rods(16);
    for (Kernel& kernel : kernels) kernel.modes.angular_frequency[6] *= factor;
    return *impact_quantities(collision(kernels), {.step = 0.02}, 1500);
  };
  const Quantities exact = run(1);
  const auto [least, most] =
      std::minmax({distance(exact, run(1 + change)), distance(exact, run(1 - change))});
  // The estimator goes in one of the two directions.
  EXPECT_GT(share, 0.99 * least * error / change);
  EXPECT_LT(share, 1.01 * most * error / change);
  EXPECT_LT(most, 1.5 * least);
}

TEST(PrecisionShare, of_double_is_that_of_single_in_their_round_offs) {
  Estimated estimated(subject(16));
  Estimator& estimator = estimated.estimator;
  const double in_double = largest(estimator.precision({.step = 0.02})),
               in_single = largest(estimator.precision({.step = 0.02, .precision = Precision::float32}));
  EXPECT_GT(in_single, 0);
  EXPECT_LT(in_single, 1e-3);
  EXPECT_NEAR(in_double / in_single, std::ldexp(1, -29),
              1e-6 * std::ldexp(1, -29));  // relative, as each is obtained from the other
}

// Rods whose kernels state the errors of their frequencies, and rods without these errors.
TEST(MeshShare, is_the_distance_from_the_impact_without_the_errors_that_kernels_state) {
  const auto detuned = [](double error) {
    std::vector<Kernel> out = rods(16);
    for (Kernel& kernel : out) {
      kernel.order = 2;
      kernel.modes.stiffness_error.assign(16 * 16, 0);
      for (std::size_t n = 1; n < 16; ++n) {
        const double square = 1 + error * static_cast<double>(n * n);  // of ω², over the exact one
        kernel.modes.angular_frequency[n] *= std::sqrt(square);
        kernel.modes.stiffness_error[17 * n] = 1 - 1 / square;
        for (std::size_t k = n; k < kernel.surface.shape.size(); k += 16)  // static displacements are exact
          kernel.surface.shape[k] *= std::sqrt(square);
      }
    }
    return out;
  };
  const std::vector<Kernel> exact = rods(16), coarse = detuned(1e-5);
  const Subject with{.rebuild = collision, .kernels = coarse, .duration = duration};
  // Backward Euler damps the waves of the truncated shock, which are not smooth in the frequencies.
  const StepOptions options{.contact = {.integration = ContactStep::backward_euler}, .step = 0.01};
  const auto run = [&](const std::vector<Kernel>& kernels) {
    return *impact_quantities(collision(kernels), options, 3000);
  };
  const double error = distances(run(exact), run(coarse)).at(Quantity::impulse);
  Estimated estimated(with);
  const double share = estimated.estimator.estimate(options).by_cause.at(Cause::mesh)->at(Quantity::impulse);
  EXPECT_GT(error, 1e-5);
  EXPECT_GT(share, 0.99 * error);
  EXPECT_LT(share, 1.01 * error);
  EXPECT_LT(estimated.estimator.mesh_near_contact()->at(Quantity::impulse), 1e-12);
}

TEST(MeshShare, is_unknown_of_kernels_without_estimates) {
  const auto estimate = Estimated(subject(16)).estimator.estimate({.step = 0.02});
  EXPECT_FALSE(estimate.by_cause.at(Cause::mesh));
}

/// A block that falls flat on a floor, with a rigid mode and elastic modes that deform its face. A wider
/// patch averages out more of this deformation.
Kernel block(int points) {
  Kernel kernel = square(points - 1, 1);
  const std::size_t m = kernel.surface.size(), n = 12;
  kernel.supported = false;
  for (std::size_t k = 0; k < n; ++k) kernel.modes.angular_frequency.push_back(30 * static_cast<double>(k));
  kernel.modes.decay_rate.assign(n, 0);
  kernel.surface.shape.assign(3 * m * n, 0);
  kernel.surface.residual_flexibility.assign(9 * m * m, 0);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < n; ++k)
      kernel.surface.shape[(3 * i + 2) * n + k] =
          std::cos(std::numbers::pi * static_cast<double>(k) * kernel.surface.node[3 * i]) *
          (k == 0 ? 1 : std::sqrt(2));
  for (std::size_t i = 0; i < 3 * m; ++i) kernel.surface.residual_flexibility[i * (3 * m + 1)] = 1e-5;
  kernel.loads.body_force.assign(3 * n, 0);
  kernel.loads.body_force[2 * n] = 1;
  kernel.loads.rotation.assign(3 * n, 0);
  kernel.loads.body_force_residual.assign(9 * m, 0);
  return kernel;
}

TEST(SpacingShare, falls_with_the_distance_of_the_points) {
  const auto place = [](const std::vector<Kernel>& kernels) {
    return build_model({{.name = "block",
                         .kernel = kernels.data(),
                         .rotation = upside_down(),
                         .translation = {0, 1, 1},
                         .velocity = {0, 0, -1}}},
                       {{.name = "floor", .normal = {0.02, 0, 1}}},
                       {PairRequest{"block", "floor", {}, 0.001, {}}}, {0, 0, 0});
  };
  const auto share = [&](int points) {
    return *Estimated({.rebuild = place, .kernels = {block(points)}, .duration = 0.5})
                .estimator.estimate({.step = 1e-4})
                .share(Cause::spacing);
  };
  EXPECT_GT(share(5), 3 * share(65));
  EXPECT_GT(share(65), 0);
}

// Hertz's law of impact is the reference. On average, the shares of the peak force are 3.4 true errors; those
// of the first order would be 5.5. Points that were coarsened once err more, but what they change is known.
TEST(SpacingShare, of_a_sphere_is_near_the_true_error) {
  Kernel kernel;
  kernel.surface.element_corners = 3;
  double factor = 1, factor_of_fewer = 1;
  constexpr int cases = 8;
  for (const double across : {3.0, 4.0, 6.0, 8.0})
    for (const bool aside : {false, true}) {
      SCOPED_TRACE(across);
      SphereOnPatches blow(across, aside);
      blow.model.bodies.push_back({.name = "sphere",
                                   .modes = 1,
                                   .mass = 1,
                                   .centre = Vector3d::Zero(),
                                   .inertia = Matrix3d::Identity() * blow.radius * blow.radius,
                                   .momentum = -Vector3d::UnitZ(),
                                   .angular_momentum = Vector3d::Zero(),
                                   .weight = Vector3d::Zero(),
                                   .kernel = &kernel,
                                   .rotation = Matrix3d::Identity(),
                                   .translation = Vector3d::Zero()});
      blow.model.pairs.emplace_back().points = static_cast<int>(blow.model.points());
      const Subject of{.rebuild = [&](const std::vector<Kernel>&) { return blow.model; },
                       .kernels = {},
                       .duration = 1.4 * blow.duration};
      Estimator estimator(of, blow.model);
      const StepOptions options{.step = blow.duration / 200};
      const auto peak = [&](Estimator& points) {
        return points.quantities(options)->figures.at(Quantity::peak_force).value(0);
      };
      const auto share = [&](Estimator& points) { return points.spacing(options)->at(Quantity::peak_force); };
      const auto share_of_error = [&](Estimator& points) {
        return share(points) / std::abs(peak(points) / blow.peak - 1);
      };
      Estimator& wide = *estimator.coarser();
      const double all = share_of_error(estimator), fewer = share_of_error(wide);
      EXPECT_GT(share(wide), std::abs(peak(wide) / peak(estimator) - 1));
      EXPECT_GT(all, 1.0 / 3);
      EXPECT_GT(fewer, 1.0 / 3);
      factor *= std::pow(all, 1.0 / cases);
      factor_of_fewer *= std::pow(fewer, 1.0 / cases);
    }
  EXPECT_GT(factor, 1);
  EXPECT_LT(factor, 5);
  EXPECT_GT(factor_of_fewer, 1);
  EXPECT_LT(factor_of_fewer, 5);
}

TEST(SpacingShare, is_unknown_with_a_single_point) {
  const auto share = [](double zone) {
    const auto place = [&](const std::vector<Kernel>& kernels) {
      return build_model({{.name = "block",
                           .kernel = kernels.data(),
                           .rotation = upside_down(),
                           .translation = {0, 1, 1},
                           .velocity = {0, 0, -1}}},
                         {{.name = "floor", .normal = {0.02, 0.01, 1}}},
                         {PairRequest{"block", "floor", {}, 0.001, {}, zone}}, {0, 0, 0});
    };
    return Estimated({.rebuild = place, .kernels = {block(9)}, .duration = 0.1})
        .estimator.estimate({.step = 1e-4})
        .share(Cause::spacing);
  };
  EXPECT_FALSE(share(1e-9));
  EXPECT_TRUE(share(1));
}

// A spinning plate falls for a second at 1 rad/s. Where it may turn by less, one run of the hundred steps
// with which the search begins ends it; where it may turn by more, shorter steps and estimates follow.
TEST(Dial, ends_with_the_first_run_that_turns_a_body_too_far) {
  const std::vector<Kernel> kernels{rigid_plate()};
  const auto rebuild = [](const std::vector<Kernel>& of) {
    return build_model(
        {{"plate", of.data(), Eigen::Matrix3d::Identity(), {0, 0, 0.5}, {0, 0, -1}, {0, 0.1, 1}}},
        {{"floor", Vector3d::Zero(), {0, 0, 1}}}, {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
  };
  std::int64_t steps = 0;
  Subject of{.rebuild = rebuild, .kernels = kernels, .duration = 1, .poll = [&] { ++steps; }};
  const auto dialled = [&](double most_turn) {
    steps = 0;
    of.most_turn = most_turn;
    return dial(of, rebuild(kernels), {.accuracy = 0.1, .options = {.step = 1e-2}, .choose_rate = true});
  };
  const Dialled ended = dialled(0.5);
  EXPECT_LE(steps, 100);
  EXPECT_FALSE(ended.estimate);
  EXPECT_GT(ended.model.gap.size(), 0);
  ASSERT_TRUE(ended.quantities);
  EXPECT_GT(ended.quantities->turn.angle, 0.9);
  EXPECT_LT(ended.quantities->turn.angle, 3);  // after its impact, it spins faster
  EXPECT_TRUE(dialled(3).estimate);
  EXPECT_GT(steps, 1000);
}

// Three candidates on the edge of a tilted plate are coarsened to one, around which the plate would turn
// freely. Flat, it stands on several before and after.
TEST(SpacingShare, is_unknown_where_fewer_points_would_let_the_body_turn) {
  Kernel kernel = rigid_plate();
  kernel.surface.residual_flexibility.assign(27 * 27, 0);
  for (std::size_t i = 0; i < 27; ++i) kernel.surface.residual_flexibility[i * 28] = 1e-5;
  kernel.loads.body_force_residual.assign(81, 0);
  const auto share = [&](double tilt, double zone) {
    const auto place = [&](const std::vector<Kernel>& kernels) {
      return build_model({{.name = "plate",
                           .kernel = kernels.data(),
                           .rotation = turn(tilt, {1, 0, 0}),
                           .translation = {0, 0, 1},
                           .velocity = {0, 0, -1}}},
                         {{.name = "floor", .normal = {0, 0, 1}}},
                         {PairRequest{"plate", "floor", {}, 0.001, {}, zone}}, {0, 0, 0});
    };
    return Estimated({.rebuild = place, .kernels = {kernel}, .duration = 0.1})
        .estimator.estimate({.step = 1e-4})
        .share(Cause::spacing);
  };
  EXPECT_FALSE(share(0.2, 0.01));
  EXPECT_TRUE(share(0, 1));
}

// A plate that lands on an edge, once, or again under its weight.
TEST(SpacingShare, is_unknown_where_touches_repeat_on_a_sharp_edge) {
  Kernel kernel = rigid_plate();
  kernel.surface.residual_flexibility.assign(27 * 27, 0);
  for (std::size_t i = 0; i < 27; ++i) kernel.surface.residual_flexibility[i * 28] = 1e-5;
  kernel.loads.body_force_residual.assign(81, 0);
  const auto place = [](const std::vector<Kernel>& kernels) {
    return build_model({{.name = "plate",
                         .kernel = kernels.data(),
                         .rotation = turn(1, {1, 0, 0}),
                         .translation = {0, 0, 1},
                         .velocity = {0, 0, -1}}},
                       {{.name = "floor", .normal = {0, 0, 1}}},
                       {PairRequest{"plate", "floor", {}, 0.001, {}, 1}}, {0, 0, -20});
  };
  const auto on_edge = [&](double duration) {
    Estimated of({.rebuild = place, .kernels = {kernel}, .duration = duration});
    const bool known = of.estimator.estimate({.step = 1e-4}).share(Cause::spacing).has_value();
    EXPECT_EQ(known, !of.estimator.on_sharp_edge());
    return of.estimator.on_sharp_edge();
  };
  EXPECT_FALSE(on_edge(0.1));
  EXPECT_TRUE(on_edge(0.3));
}

TEST(Inertia, leaves_static_responses_and_halves_the_instant_one_to_the_impulse) {
  const Kernel kernel = block(5);
  Model model = build_model(
      {{.name = "block", .kernel = &kernel, .rotation = upside_down(), .translation = {0, 1, 1}}},
      {{.name = "floor", .normal = {0, 0, 1}}}, {PairRequest{"block", "floor", {}, {}, {}}}, {0, 0, 0});
  const Eigen::Index n = model.rows(), modes = model.omega.size();
  const Matrix root = Matrix::Random(n, n);
  model.R = root * root.transpose() + 0.1 * Matrix::Identity(n, n);
  const Vector impulse = Vector::Random(n).cwiseAbs();
  const Model with = with_inertia(model, impulse, Vector::Constant(1, 50));
  ASSERT_EQ(with.omega.size(), modes + 1);
  const auto instant = [&](const Model& of) { return impulse.dot(of.R * impulse); };
  EXPECT_NEAR(instant(with), instant(model) / 2, 1e-12 * instant(model));
  EXPECT_GT(with.R.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  for (int k = 0; k < 3; ++k) {  // under a constant force f, a mode moves to Bᵀf/ω²
    const Vector force = Vector::Random(n);
    const double moved = with.B.col(modes).dot(force) / std::pow(with.omega[modes], 2);
    EXPECT_LT((with.R * force + moved * with.B.col(modes) - model.R * force).norm(), 1e-12 * force.norm());
  }
}

TEST(BasisShare, of_rods_is_unknown) {
  Subject with = subject(12);
  for (Kernel& kernel : with.kernels) {
    kernel.modes.basis = "contact";
    kernel.modes.certificate.upto_hz = 0.5;
    kernel.modes.certificate.flexibility_error = 0.01;
  }
  EXPECT_FALSE(Estimated(std::move(with)).estimator.estimate({.step = 0.02}).share(Cause::basis));
  EXPECT_EQ(Estimated(subject(12)).estimator.estimate({.step = 0.02}).share(Cause::basis), 0);
}

// d'Alembert: a rod leaves a wall at its speed of arrival. The truncated series of the front converges with
// the first order, whatever the step, and its changes fluctuate.
TEST(Estimate, of_a_rod_on_a_wall_is_within_a_third_and_five_times_the_true_error) {
  for (const int steps_per_period : {8, 64})
    for (const int modes : {20, 40, 80, 160}) {  // elastic ones
      const auto place = [](const std::vector<Kernel>& kernels) {
        return build_model({{.name = "rod", .kernel = kernels.data(), .velocity = {1, 0, 0}}},
                           {{.name = "wall", .point = {1, 0, 0}, .normal = {-1, 0, 0}}},
                           {PairRequest{"rod", "wall", {}, {}, {}}}, {0, 0, 0});
      };
      Estimated estimated({.rebuild = place, .kernels = {rod(modes + 1, 1)}, .duration = 3});
      const StepOptions options{.step = 2.0 / modes / steps_per_period};
      const ErrorEstimate all = estimated.estimator.estimate(options);
      const double estimate = all.total();
      const auto& figures = estimated.estimator.quantities(options)->figures;
      const double error = std::max(std::abs(figures.at(Quantity::impulse).value[0] / 2 - 1),
                                    std::abs(figures.at(Quantity::rebound).value[0] + 1));
      EXPECT_LT(error, 3 * estimate) << modes << " modes, " << steps_per_period << ": " << formatted(all);
      EXPECT_GT(error, 0.2 * estimate) << modes << " modes, " << steps_per_period << ": " << formatted(all);
    }
}

TEST(Total, is_that_of_the_requested_quantity_with_the_largest_known_error) {
  ErrorEstimate estimate{
      .requested = {Quantity::impulse, Quantity::rebound},
      .by_cause = {
          {Cause::mesh, std::nullopt},
          {Cause::modes, Errors{{Quantity::impulse, 3}, {Quantity::rebound, 0}, {Quantity::spin, 5}}},
          {Cause::step, Errors{{Quantity::impulse, 4}, {Quantity::rebound, 4}, {Quantity::spin, 12}}}}};
  EXPECT_EQ(estimate.total(), 5);
  EXPECT_EQ(estimate.worst(), Quantity::impulse);
  EXPECT_EQ(estimate.total(Quantity::rebound), 4);
  EXPECT_EQ(estimate.total(Quantity::spin), 13);
  EXPECT_EQ(estimate.share(Cause::modes), 3);
  EXPECT_FALSE(estimate.share(Cause::mesh));
  estimate.front = true;  // which each cause blurs
  EXPECT_EQ(estimate.total(), 7);
}

TEST(Report, names_the_shares_of_the_worst_quantity_and_what_is_unknown) {
  ErrorEstimate estimate{
      .requested = {Quantity::impulse},
      .by_cause = {{Cause::mesh, std::nullopt},
                   {Cause::modes, Errors{{Quantity::impulse, 0.012}, {Quantity::rebound, 0.04}}},
                   {Cause::step, Errors{{Quantity::impulse, 0.005}, {Quantity::rebound, 0.03}}},
                   {Cause::precision, Errors{{Quantity::impulse, 0}, {Quantity::rebound, 0}}}}};
  EXPECT_EQ(formatted(estimate), "0.013: mesh unknown, modes 0.012, step 0.005");
  EXPECT_EQ(largest_cause(estimate), Cause::modes);
  EXPECT_THAT(warnings(estimate, 0.02),
              ElementsAre(StartsWith("the error estimate leaves out: mesh (run ricochet-kernel")));
  estimate.requested = {Quantity::impulse, Quantity::rebound};
  EXPECT_EQ(formatted(estimate), "0.05 of the rebound: mesh unknown, modes 0.04, step 0.03");
  estimate.by_cause[Cause::mesh] = Errors{{Quantity::impulse, 0}, {Quantity::rebound, 0}};
  EXPECT_EQ(formatted(estimate), "0.05 of the rebound: modes 0.04, step 0.03");
  EXPECT_THAT(warnings(estimate, 0.06), IsEmpty());
  EXPECT_THAT(
      warnings(estimate, 0.04),
      ElementsAre(StartsWith("the error of the rebound is estimated at 0.05, above accuracy = 0.04; its "
                             "largest share (0.04) is that of the modes: use ")));
  estimate.by_cause[Cause::step] = Errors{{Quantity::rebound, 0.001}, {Quantity::peak_force, 0.16}};
  EXPECT_THAT(warnings(estimate, 0.05),
              ElementsAre(StartsWith("the error of the peak_force is estimated at "
                                     "0.16, and accuracy = 0.05 was not requested")));
  EXPECT_THAT(warnings(estimate, 0.054), IsEmpty());  // 0.16 is below three times it
  estimate.requested.push_back(Quantity::peak_force);
  EXPECT_THAT(warnings(estimate, 0.05), ElementsAre(::testing::HasSubstr("above accuracy = 0.05")));
  estimate.requested.pop_back();
  estimate.by_cause[Cause::step] = Errors{{Quantity::impulse, 0.005}, {Quantity::rebound, 0.03}};
  EXPECT_TRUE(estimate.meets(0.06));
  EXPECT_FALSE(estimate.meets(0.04));
  estimate.front = true;
  EXPECT_FALSE(estimate.meets(0.1));
  EXPECT_THAT(warnings(estimate, 0.1),
              ElementsAre(StartsWith("the error of the rebound is estimated at 0.07 and, at a front, often 2 "
                                     "times as large, above accuracy = 0.1; its largest share (0.04)")));
  estimate.by_cause[Cause::mesh] = std::nullopt;
  EXPECT_FALSE(estimate.meets(1));
  EXPECT_FALSE(largest_cause({.requested = {Quantity::impulse}, .by_cause = {{Cause::mesh, std::nullopt}}}));
}

}  // namespace estimate_test
