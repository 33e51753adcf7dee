// SPDX-License-Identifier: BSD-2-Clause
// Kernels derived from other kernels, compared with closed-form kernels of bars.
#include "kernels/algebra.hpp"

#include <Eigen/Dense>

#include "kernels/band.hpp"
#include "tests/kernels/bar.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace algebra_test {

using test::Bar;
using test::complaint_of;
using test::plain_kernel;
using test::sample_kernel;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Compares all values, with a tolerance relative to the largest value of the array.
template <class Range>
void expect_close(const Range& found, const Range& expected, const std::string& name, double tolerance) {
  ASSERT_EQ(found.size(), expected.size()) << name;
  double largest = 0, off = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    largest = std::max(largest, std::abs(double(expected[i])));
    off = std::max(off, std::abs(double(found[i]) - double(expected[i])));
  }
  EXPECT_LE(off, tolerance * largest) << name;
}

/// R and sag are small differences, so their errors are relative to the
/// totals from which they are subtracted.
void expect_same(const Kernel& found, const Kernel& expected, double whole = 1) {
  constexpr double round_off = 1e-13;
  expect_close(found.modes.angular_frequency, expected.modes.angular_frequency, "omega", round_off);
  expect_close(found.modes.decay_rate, expected.modes.decay_rate, "decay", round_off);
  EXPECT_EQ(found.modes.residual, expected.modes.residual);
  const Certificate &c = found.modes.certificate, &e = expected.modes.certificate;
  EXPECT_NEAR(c.upto_hz, e.upto_hz, round_off * e.upto_hz);
  EXPECT_EQ(c.count_by_inertia, e.count_by_inertia);
  EXPECT_EQ(c.count_found, e.count_found);
  EXPECT_EQ(c.left_out, e.left_out);
  EXPECT_EQ(c.complete, e.complete);
  EXPECT_EQ(c.flexibility_error, e.flexibility_error);
  EXPECT_NEAR(found.mass, expected.mass, round_off * expected.mass);
  expect_close(found.centre, expected.centre, "centre", round_off);
  expect_close(found.inertia, expected.inertia, "inertia", round_off);
  EXPECT_EQ(found.supported, expected.supported);
  expect_close(found.outline, expected.outline, "outline", round_off);
  expect_close(found.surface.node, expected.surface.node, "node", round_off);
  expect_close(found.surface.area, expected.surface.area, "area", round_off);
  expect_close(found.surface.shape, expected.surface.shape, "shape", round_off);
  expect_close(found.surface.residual_flexibility, expected.surface.residual_flexibility, "R",
               round_off * whole);
  EXPECT_EQ(found.surface.element_corners, expected.surface.element_corners);
  EXPECT_EQ(found.surface.element, expected.surface.element);
  EXPECT_EQ(found.surface.group, expected.surface.group);
  EXPECT_EQ(found.surface.normal, expected.surface.normal);
  EXPECT_EQ(found.surface.direction, expected.surface.direction);
  expect_close(found.loads.body_force, expected.loads.body_force, "body force", round_off);
  expect_close(found.loads.rotation, expected.loads.rotation, "rotation", round_off);
  if (expected.supported)
    expect_close(found.loads.body_force_residual, expected.loads.body_force_residual, "sag",
                 round_off * whole);
  ASSERT_EQ(found.view.has_value(), expected.view.has_value());
  if (!found.view) return;
  expect_close(found.view->node, expected.view->node, "view", round_off);
  expect_close(found.view->shape, expected.view->shape, "view's shape", 1e-6);  // single precision
  EXPECT_EQ(found.view->element, expected.view->element);
  expect_close(found.view->residual_flexibility, expected.view->residual_flexibility, "view's R", 1e-6);
  if (expected.supported)
    expect_close(found.view->body_force_residual, expected.view->body_force_residual, "view's sag", 1e-6);
}

/// With 40 modes, R and sag are differences that are 200 and 1e5 times smaller than the totals.
constexpr double of_differences = 1e5;

class BothBars : public testing::TestWithParam<bool> {
 protected:
  Bar bar_{.clamped = GetParam()};
};
INSTANTIATE_TEST_SUITE_P(FreeAndClamped, BothBars, testing::Bool());

TEST_P(BothBars, as_solids_scale_to_any_stiffness_density_and_size) {
  Bar other = bar_;
  other.young *= 7.3;
  other.density *= 0.21;
  other.length *= 2.6;
  other.beside *= 2.6;
  other.area *= 2.6 * 2.6;
  const Kernel found = rescaled(bar_.kernel(), {.young = 7.3, .density = 0.21, .scale = 2.6}, {});
  expect_same(found, other.kernel(), of_differences);
  EXPECT_NO_THROW(validate(found, "origin"));
}

TEST_P(BothBars, as_rods_keep_a_cross_section_of_their_own) {
  Bar other = bar_;
  other.young *= 0.4;
  other.density *= 9;
  other.length *= 0.3;
  other.beside *= 0.3;
  other.area *= 1.9;
  expect_same(rescaled(bar_.kernel(), {.young = 0.4, .density = 9, .scale = 0.3, .area = 1.9}, {}),
              other.kernel(), of_differences);
}

TEST(Rescaling, by_one_changes_nothing) {
  for (const int components : {1, 3}) {
    const Kernel kernel = sample_kernel(components);
    // The decay rates of the sample are δ = 0.01 n at ω = 100 √n.
    const Kernel same = rescaled(kernel, {}, {Damping::Law::viscosity, 2e-6});
    EXPECT_EQ(same.surface.shape, kernel.surface.shape);
    EXPECT_EQ(same.surface.residual_flexibility, kernel.surface.residual_flexibility);
    EXPECT_EQ(same.loads.rotation, kernel.loads.rotation);
    EXPECT_EQ(same.view->shape, kernel.view->shape);
    EXPECT_EQ(same.modes.residual, kernel.modes.residual);
    expect_close(same.modes.decay_rate, kernel.modes.decay_rate, "decay", 1e-15);
  }
}

// The damping law of the new body applies, not that of the first kernel.
TEST(Rescaling, gives_decay_rates_by_the_law_at_the_new_frequencies) {
  Bar bar{.clamped = false};
  bar.decay = [](double) { return 5.0; };
  const Similarity twice{.young = 4};
  const auto rates = [&](const Damping& law) { return rescaled(bar.kernel(), twice, law).modes.decay_rate; };
  using Law = Damping::Law;
  EXPECT_EQ(rates({}), std::vector<double>(41, 0.0));
  const double omega = 2 * 3 * std::numbers::pi / 1.7 * std::sqrt(1.5);  // third elastic mode
  EXPECT_NEAR(rates({Law::ratio, 0.01})[3], 0.01 * omega, 1e-12);
  EXPECT_NEAR(rates({Law::loss_factor, 0.01})[3], 0.005 * omega, 1e-12);
  EXPECT_NEAR(rates({Law::viscosity, 1e-3})[3], 5e-4 * omega * omega, 1e-12);
  EXPECT_NEAR(rates({Law::rayleigh, 2, 1e-3})[3], 1 + 5e-4 * omega * omega, 1e-12);
  EXPECT_EQ(rates({Law::rayleigh, 2, 1e-3})[0], 1);  // α also damps rigid motion
}

/// Times in which the elastic modes of a free bar decay by 60 dB, ln(1000)/δ [s].
std::vector<double> decay_times(const Damping& law) {
  const Kernel kernel = rescaled(Bar{.clamped = false}.kernel(), {}, law);
  EXPECT_EQ(kernel.modes.decay_rate[0], 0);  // rigid motion
  std::vector<double> times;
  for (std::size_t n = 1; n < kernel.modes.size(); ++n)
    times.push_back(std::log(1000) / kernel.modes.decay_rate[n]);
  return times;
}

// The elastic modes are harmonics of 0.36 Hz, so that T60 ∝ 1/f is a line in the logarithms.
TEST(DecayTimes, are_interpolated_between_rows_and_constant_beyond) {
  const double lowest = Bar{}.speed() / (2 * Bar{}.length);
  const auto times =
      decay_times({.law = Damping::Law::t60, .table = {{2 * lowest, 6}, {4 * lowest, 3}, {8 * lowest, 12}}});
  const double expected[] = {6, 6, 4, 3, 0, 0, 0, 12, 12, 12};  // 6 · 2/n from the second to the fourth
  for (std::size_t n : {0, 1, 2, 3, 7, 8, 9}) EXPECT_NEAR(times[n], expected[n], 1e-12) << n;
  EXPECT_NEAR(times[4], 3 * 25.0 / 16, 1e-12);  // ∝ f² from the fourth to the eighth
  EXPECT_NEAR(times.back(), 12, 1e-12);
  for (const double time : decay_times({.law = Damping::Law::t60, .table = {{100, 2.5}}}))
    EXPECT_NEAR(time, 2.5, 1e-12);
}

// The half-power bandwidth of a mode is η f.
TEST(LossFactorsByMode, count_from_the_lowest_elastic_mode_and_end_with_the_last) {
  const double lowest = Bar{}.speed() / (2 * Bar{}.length);
  const auto times = decay_times({.law = Damping::Law::by_mode, .by_mode = {0.01, 0.04, 0.02}});
  const double factors[] = {0.01, 0.04, 0.02, 0.02};
  for (std::size_t n = 0; n < 4; ++n)
    EXPECT_NEAR(std::log(1000) / times[n] / std::numbers::pi,
                factors[n] * lowest * static_cast<double>(n + 1), 1e-12);
}

// N(t) = Σ φ φ sin(ωt)/ω has the unit s/kg, hence N'(t) = N(t ω'/ω) ω/(ω' m).
TEST(Rescaling, stretches_kernel_functions_in_time) {
  const Kernel old = Bar{}.kernel();
  const Kernel found = rescaled(old, {.young = 3, .density = 1.5, .scale = 2}, {});
  const auto n = [](const Kernel& kernel, double t) {
    double sum = 0;
    for (std::size_t k = 0; k < kernel.modes.size(); ++k)
      sum += std::pow(kernel.surface.shape[k], 2) * std::sin(kernel.modes.angular_frequency[k] * t) /
             kernel.modes.angular_frequency[k];
    return sum;
  };
  const double faster = std::sqrt(2.0) / 2, heavier = 1.5 * 8;
  for (const double t : {0.1, 0.7, 3.0})
    EXPECT_NEAR(n(found, t), n(old, t * faster) / (faster * heavier), 1e-12);
}

TEST_P(BothBars, truncated_to_a_band_are_those_with_fewer_modes) {
  for (const std::size_t modes : {39U, 15U, 1U}) {
    Bar fewer = bar_;
    fewer.modes = modes;
    expect_same(truncated_to_band(bar_.kernel(), fewer.end()), fewer.kernel(), of_differences);
  }
  expect_same(truncated_to_band(bar_.kernel(), bar_.end()), bar_.kernel());
}

/// Σ φ φᵀ/ω² + R over the elastic modes.
Eigen::MatrixXd flexibility(const Kernel& kernel) {
  const auto n = static_cast<Eigen::Index>(kernel.modes.size());
  const auto rows = static_cast<Eigen::Index>(kernel.surface.shape.size()) / n;
  const Eigen::Map<const RowMajor> shape(kernel.surface.shape.data(), rows, n);
  Eigen::MatrixXd sum = Eigen::Map<const RowMajor>(kernel.surface.residual_flexibility.data(), rows, rows);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double omega = kernel.modes.angular_frequency[static_cast<std::size_t>(k)];
    if (omega > 0) sum += shape.col(k) * shape.col(k).transpose() / (omega * omega);
  }
  return sum;
}

TEST_P(BothBars, have_the_same_static_response_after_truncation) {
  Eigen::MatrixXd exact(4, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      exact(i, j) = bar_.flexibility((i + 1) * bar_.length / 4, (j + 1) * bar_.length / 4);
  const auto off = [&](const Kernel& kernel) { return (flexibility(kernel) - exact).norm() / exact.norm(); };
  EXPECT_LT(off(truncated_to_band(bar_.kernel(), {0.9})), 1e-12);
  EXPECT_LT(off(truncated_to_count(bar_.kernel(), 3)), 1e-12);
  EXPECT_LT(off(truncated_to_flexibility_error(bar_.kernel(), {1.0}, 0.05)), 1e-12);
}

TEST(Truncation, keeps_rigid_modes) {
  const Bar bar{.clamped = false};
  for (const Kernel& kernel :
       {truncated_to_band(bar.kernel(), {1e-9}), truncated_to_count(bar.kernel(), 1)}) {
    EXPECT_EQ(kernel.modes.angular_frequency, std::vector<double>{0.0});
    EXPECT_EQ(kernel.modes.certificate.count_by_inertia, 1);
    EXPECT_NO_THROW(validate(kernel, "origin"));
  }
}

TEST(Rescaling, keeps_each_shift_between_the_same_modes) {
  const Kernel had = Bar{}.kernel(), made = rescaled(had, {.young = 3, .density = 5, .scale = 2}, {});
  const auto square = [](const Kernel& kernel) { return std::pow(kernel.modes.angular_frequency.back(), 2); };
  ASSERT_EQ(made.modes.certificate.shift.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s)
    EXPECT_NEAR(made.modes.certificate.shift[s] / had.modes.certificate.shift[s], square(made) / square(had),
                1e-12);
  EXPECT_EQ(made.modes.certificate.modes_below, had.modes.certificate.modes_below);
}

// A count above the new end says nothing about the modes that remain.
TEST(Truncation, keeps_the_inertia_counts_below_its_end) {
  const Kernel whole = Bar{}.kernel();
  ASSERT_EQ(whole.modes.certificate.shift.size(), 2U);
  const Kernel cut = truncated_to_count(whole, 4);
  EXPECT_EQ(cut.modes.certificate.shift, std::vector{whole.modes.certificate.shift[0]});
  EXPECT_EQ(cut.modes.certificate.modes_below, std::vector{whole.modes.certificate.modes_below[0]});
}

TEST(Truncation, to_a_number_keeps_multiple_modes_whole) {
  Kernel kernel = Bar{}.kernel();
  std::vector<double>& omega = kernel.modes.angular_frequency;
  omega[5] = omega[4] * (1 + 1e-8);
  EXPECT_EQ(truncated_to_count(kernel, 4).modes.size(), 4U);
  const Kernel cut = truncated_to_count(kernel, 5);
  EXPECT_EQ(cut.modes.size(), 6U);
  EXPECT_GT(cut.modes.certificate.upto_hz, to_hertz({omega[5]}).value);
  EXPECT_LT(cut.modes.certificate.upto_hz, to_hertz({omega[6]}).value);
  EXPECT_EQ(truncated_to_count(kernel, 40).modes.certificate.upto_hz, kernel.modes.certificate.upto_hz);
}

TEST(Truncation, renumbers_the_pairs_of_the_modes_that_it_keeps) {
  Kernel kernel = Bar{}.kernel();
  kernel.modes.coriolis = {.pair = {1, 2, 1, 3, 3, 5, 4, 5},
                           .coupling = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}};
  std::vector<bool> keep(kernel.modes.size(), true);
  keep[2] = false;
  truncate(kernel, keep);
  EXPECT_EQ(kernel.modes.coriolis.pair, (std::vector<std::int64_t>{1, 2, 2, 4, 3, 4}));
  EXPECT_EQ(kernel.modes.coriolis.coupling, (std::vector<double>{4, 5, 6, 7, 8, 9, 10, 11, 12}));
  EXPECT_EQ(truncated_to_count(kernel, 2).modes.coriolis, Coriolis{});
}

// Even one mode that was truncated: the rest are not all modes below the end.
TEST(Truncation, is_refused_after_a_truncation_that_left_gaps) {
  Kernel kernel = Bar{}.kernel();
  kernel.modes.certificate.left_out = 1;
  for (const std::string& line : {complaint_of([&] { truncated_to_band(kernel, {0.9}); }),
                                  complaint_of([&] { truncated_to_count(kernel, 3); }),
                                  complaint_of([&] { truncated_to_flexibility_error(kernel, {1.0}, 0.05); })})
    EXPECT_NE(line.find("1 of its modes were truncated"), std::string::npos) << line;
}

TEST(Truncation, needs_no_residual_flexibility_and_no_visualisation_surface) {
  Kernel kernel = Bar{}.kernel();
  kernel.surface.residual_flexibility.clear();
  kernel.loads.body_force_residual.clear();
  kernel.view.reset();
  const Kernel cut = restricted_to_points(truncated_to_count(kernel, 7), {2});
  EXPECT_EQ(cut.modes.size(), 7U);
  EXPECT_TRUE(cut.surface.residual_flexibility.empty());
  EXPECT_NO_THROW(validate(cut, "origin"));
}

/// The view restricted to these points; the visualisation surface of the bar has four columns.
View with_columns(View view, const std::vector<std::size_t>& points) {
  std::vector<float> taken;
  for (std::size_t row = 0; row < view.residual_flexibility.size(); row += 4)
    for (const std::size_t i : points) taken.push_back(view.residual_flexibility[row + i]);
  view.residual_flexibility = taken;
  return view;
}

TEST_P(BothBars, restricted_to_points_are_those_with_fewer) {
  Bar fewer = bar_;
  fewer.at = {0.75, 0.5};
  Kernel expected = fewer.kernel();
  expected.surface.element = {1, 0};  // with reversed orientation
  expected.view = with_columns(*bar_.kernel().view, {2, 1});
  expect_same(restricted_to_points(bar_.kernel(), {2, 1}), expected);
  // No two of these points are neighbours.
  fewer.at = {0.25, 0.75};
  expected = fewer.kernel();
  expected.surface.element_corners = 1;
  expected.surface.element = {0, 1};
  expected.view = with_columns(*bar_.kernel().view, {0, 2});
  expect_same(restricted_to_points(bar_.kernel(), {0, 2}), expected);
}

TEST(Restriction, to_points_keeps_all_components_of_each) {
  const std::size_t n = 5, m = 4;
  const Kernel whole = plain_kernel(3, n, m), cut = restricted_to_points(whole, {3, 1});
  EXPECT_NO_THROW(validate(cut, "origin"));
  const std::size_t row[] = {9, 10, 11, 3, 4, 5};
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_EQ(cut.surface.shape[i * n + k], whole.surface.shape[row[i] * n + k]);
    for (std::size_t j = 0; j < 6; ++j)
      EXPECT_EQ(cut.surface.residual_flexibility[i * 6 + j],
                whole.surface.residual_flexibility[row[i] * 3 * m + row[j]]);
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_EQ(cut.loads.body_force_residual[i * 3 + d], whole.loads.body_force_residual[row[i] * 3 + d]);
  }
  EXPECT_EQ(cut.surface.group, (std::vector<std::string>{"upper face", "upper face"}));
}

/// Static response of row r of the receiver to column e: the residual plus the sum over the modes, Σ φ f/ω².
double answer(const Kernel& kernel, std::size_t r, const std::vector<double>& residual, std::size_t width,
              std::size_t column, const std::vector<double>& force, std::size_t e) {
  const std::size_t n = kernel.modes.size();
  double sum = residual[r * width + column];
  for (std::size_t k = 0; k < n; ++k)
    if (const double omega = kernel.modes.angular_frequency[k]; omega > 0)
      sum += kernel.receivers[0].shape[r * n + k] * force[e * n + k] / (omega * omega);
  return sum;
}

// Young's modulus × 3, density × 5, size × 2: the displacement of a similar body grows by 1/(3·2)
// under a force, by 2²/(3·2) under a pressure and by 5·2³/(3·2) under its own weight. The lift of a
// support is geometric, so Γ grows as √mass.
TEST(Rescaling, scales_the_response_to_sources_with_size_and_stiffness) {
  const Kernel had = sample_kernel(3), made = rescaled(had, {.young = 3, .density = 5, .scale = 2}, {});
  const std::size_t loads = had.applied.size();
  for (std::size_t l = 0; l < loads; ++l) {
    const double factor = had.applied[l].unit == "Pa" ? 4.0 / 6 : 1.0 / 6;
    const auto of = [&](const Kernel& kernel) {
      return answer(kernel, 1, kernel.receivers[0].load_residual, 3 * loads, 3 * l + 2,
                    kernel.applied[l].participation, 2);
    };
    EXPECT_NEAR(of(made), factor * of(had), 1e-12 * std::abs(of(had)));
    EXPECT_NEAR(made.applied[l].total[4], (had.applied[l].unit == "Pa" ? 4 : 1) * had.applied[l].total[4],
                1e-12);
  }
  const auto under_weight = [&](const Kernel& kernel) {
    return answer(kernel, 2, kernel.receivers[0].body_force_residual, 3, 0, kernel.loads.body_force, 0);
  };
  EXPECT_NEAR(under_weight(made), 40.0 / 6 * under_weight(had), 1e-12 * std::abs(under_weight(had)));
  const auto moved_by = [](const Kernel& kernel) {  // Ψ at the receiver: ΦΓ plus the residual
    const std::size_t n = kernel.modes.size();
    double sum = kernel.receivers[0].motion_residual[0];
    for (std::size_t k = 0; k < n; ++k)
      sum += kernel.receivers[0].shape[k] * kernel.motions[0].participation[k];
    return sum;
  };
  EXPECT_NEAR(moved_by(made), moved_by(had), 1e-12 * std::abs(moved_by(had)));
}

/// A factor of kg^mass m^length s^time.
struct Unit {
  double mass = 0, length = 0, time = 0;
};

// A body with Young's modulus × 3, density × 5 and size × 2 is the same body in other units of mass, length
// and time, so each datum gets the factor of its unit. Loads are per N or per Pa, which are not scaled.
TEST(Rescaling, gives_each_datum_the_factor_of_its_unit) {
  const Kernel had = sample_kernel(3), made = rescaled(had, {.young = 3, .density = 5, .scale = 2}, {});
  const double length = 2, mass = 5 * length * length * length;
  const double time = std::sqrt(mass / (3 * length));  // Pa = kg m⁻¹ s⁻²
  const auto expect_unit = [&](const auto& to, const auto& from, Unit unit, const std::string& name) {
    std::vector<double> expected;
    for (const auto value : from)
      expected.push_back(value * std::pow(mass, unit.mass) * std::pow(length, unit.length) *
                         std::pow(time, unit.time));
    expect_close(std::vector<double>(to.begin(), to.end()), expected, name,
                 1e-6);  // views hold single precision
  };
  const Unit flexibility{-1, 0, 2};
  expect_unit(made.centre, had.centre, {0, 1, 0}, "centre");
  expect_unit(made.inertia, had.inertia, {1, 2, 0}, "inertia");
  expect_unit(made.outline, had.outline, {0, 1, 0}, "outline");
  expect_unit(made.piece_box, had.piece_box, {0, 1, 0}, "pieces");
  expect_unit(made.modes.angular_frequency, had.modes.angular_frequency, {0, 0, -1}, "omega");
  EXPECT_EQ(made.modes.stiffness_error, had.modes.stiffness_error);
  expect_unit(made.surface.mesh_error, had.surface.mesh_error, flexibility, "error of R");
  EXPECT_EQ(made.surface.mesh_error_coupling, had.surface.mesh_error_coupling);
  EXPECT_EQ(made.modes.coriolis, had.modes.coriolis);
  expect_unit(made.surface.centroid, had.surface.centroid, {0, 1, 0}, "centroid");
  expect_unit(made.surface.bulge, had.surface.bulge, {0, 1, 0}, "bulge");
  EXPECT_EQ(made.surface.element_normal, had.surface.element_normal);
  expect_unit(made.surface.area, had.surface.area, {0, 2, 0}, "area");
  expect_unit(made.surface.shape, had.surface.shape, {-0.5, 0, 0}, "shape");
  expect_unit(made.surface.residual_flexibility, had.surface.residual_flexibility, flexibility, "R");
  expect_unit(made.loads.body_force, had.loads.body_force, {0.5, 0, 0}, "body force");
  expect_unit(made.loads.rotation, had.loads.rotation, {0.5, 1, 0}, "rotation");
  expect_unit(made.loads.body_force_residual, had.loads.body_force_residual, {0, 0, 2}, "sag");
  for (std::size_t l = 0; l < had.applied.size(); ++l) {
    const Load &to = made.applied[l], &from = had.applied[l];
    const double square = from.unit == "Pa" ? 2 : 0;  // m² more than per N
    expect_unit(to.participation, from.participation, {-0.5, square, 0}, "participation");
    expect_unit(to.total, from.total, {0, square, 0}, "total");
    expect_unit(to.moment, from.moment, {0, square + 1, 0}, "moment");
    expect_unit(to.residual, from.residual, {-1, square, 2}, "residual of a load");
  }
  expect_unit(made.motions[0].participation, had.motions[0].participation, {0.5, 0, 0}, "lift");
  expect_unit(made.motions[0].residual, had.motions[0].residual, {}, "residual of a support");
  expect_unit(made.motions[0].momentum, had.motions[0].momentum, {1, 0, 0}, "momentum");
  for (std::size_t r = 0; r < had.receivers.size(); ++r) {
    const Receiver &to = made.receivers[r], &from = had.receivers[r];
    expect_unit(to.point, from.point, {0, 1, 0}, "point");
    expect_unit(to.shape, from.shape, {-0.5, 0, 0}, "shape of a receiver");
    expect_unit(to.residual_flexibility, from.residual_flexibility, flexibility, "R of a receiver");
    expect_unit(to.body_force_residual, from.body_force_residual, {0, 0, 2}, "sag of a receiver");
    expect_unit(to.motion_residual, from.motion_residual, {}, "lift of a receiver");
  }
  expect_unit(made.view->node, had.view->node, {0, 1, 0}, "view");
  expect_unit(made.view->shape, had.view->shape, {-0.5, 0, 0}, "shape of the view");
  expect_unit(made.view->residual_flexibility, had.view->residual_flexibility, flexibility, "R of the view");
  expect_unit(made.view->body_force_residual, had.view->body_force_residual, {0, 0, 2}, "sag of the view");
  expect_unit(made.view->motion_residual, had.view->motion_residual, {}, "lift of the view");
  const SensitivityOf<float>&to = *made.view->stress, &from = *had.view->stress;  // Pa = kg m⁻¹ s⁻²
  expect_unit(to.shape, from.shape, {0.5, -2, -2}, "stress");
  expect_unit(to.residual_flexibility, from.residual_flexibility, {0, -2, 0}, "R of the stress");
  expect_unit(to.body_force_residual, from.body_force_residual, {1, -2, 0}, "stress by gravity");
  expect_unit(to.motion_residual, from.motion_residual, {1, -2, -2}, "stress by a support");
}

TEST(Restriction, is_refused_for_kernels_with_loads_or_receivers) {
  for (const std::string& line :
       {complaint_of([] { restricted_to_points(sample_kernel(3), {0}); }), complaint_of([] {
          restricted_to_direction(sample_kernel(3), {1, 0, 0});
        })})
    EXPECT_NE(line.find("has loads, moving supports, receivers or gauges"), std::string::npos) << line;
}

TEST(Restriction, to_normals_that_are_all_alike_is_that_to_their_direction) {
  Kernel whole = plain_kernel(3);
  const Vector3 d{0.6, 0, -0.8};
  for (std::size_t row = 0; row < whole.surface.normal.size(); ++row) whole.surface.normal[row] = d[row % 3];
  const Kernel normal = restricted_to_normals(whole), directed = restricted_to_direction(whole, d);
  EXPECT_NO_THROW(validate(normal, "origin"));
  EXPECT_EQ(normal.surface.shape, whole.surface.shape);
  EXPECT_EQ(normal.surface.residual_components(), 1);
  EXPECT_EQ(normal.surface.residual_flexibility, directed.surface.residual_flexibility);
  EXPECT_EQ(normal.loads.body_force_residual, directed.loads.body_force_residual);
  EXPECT_EQ(normal.view->residual_flexibility, directed.view->residual_flexibility);
  EXPECT_THROW(restricted_to_normals(normal), InputError);
  EXPECT_THROW(restricted_to_direction(normal, d), InputError);
}

TEST(Restriction, to_normals_and_truncation_commute) {
  const Kernel whole = sample_kernel(3);
  const RadPerSecond end{whole.modes.angular_frequency[whole.modes.size() - 2]};
  const Kernel one = restricted_to_normals(truncated_above(whole, end)),
               other = truncated_above(restricted_to_normals(whole), end);
  EXPECT_LT(other.modes.size(), whole.modes.size());
  const auto expect_equal = [](const auto& a, const auto& b, double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    double largest = 0;
    for (const auto value : a) largest = std::max<double>(largest, std::abs(value));
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance * largest);
  };
  constexpr double round_off = 1e-14, single = 1e-6;
  expect_equal(one.surface.residual_flexibility, other.surface.residual_flexibility, round_off);
  expect_equal(one.loads.body_force_residual, other.loads.body_force_residual, round_off);
  for (std::size_t l = 0; l < one.applied.size(); ++l)
    expect_equal(one.applied[l].residual, other.applied[l].residual, round_off);
  for (std::size_t r = 0; r < one.receivers.size(); ++r)
    expect_equal(one.receivers[r].residual_flexibility, other.receivers[r].residual_flexibility, round_off);
  for (std::size_t s = 0; s < one.motions.size(); ++s)
    expect_equal(one.motions[s].residual, other.motions[s].residual, round_off);
  expect_equal(one.view->residual_flexibility, other.view->residual_flexibility, single);
}

TEST(Restriction, to_a_direction_keeps_the_component_along_it) {
  const std::size_t n = 5, m = 4;
  const Kernel whole = plain_kernel(3, n, m);
  const Vector3 d{0.6, 0, -0.8};
  const Kernel cut = restricted_to_direction(whole, d);
  EXPECT_NO_THROW(validate(cut, "origin"));
  EXPECT_EQ(cut.surface.direction, d);
  // A unit force along d on patch i, as three components for each patch.
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(12, 4);
  for (Eigen::Index i = 0; i < 4; ++i) load.block<3, 1>(3 * i, i) << 0.6, 0, -0.8;
  const auto matrix = [](const std::vector<double>& values, Eigen::Index rows) -> RowMajor {
    return Eigen::Map<const RowMajor>(values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows);
  };
  const auto expect_projected = [&](const RowMajor& found, const Eigen::MatrixXd& expected) {
    EXPECT_LT((found - expected).norm(), 1e-14 * expected.norm());
  };
  expect_projected(matrix(cut.surface.shape, 4), load.transpose() * matrix(whole.surface.shape, 12));
  expect_projected(matrix(cut.surface.residual_flexibility, 4),
                   load.transpose() * matrix(whole.surface.residual_flexibility, 12) * load);
  expect_projected(matrix(cut.loads.body_force_residual, 4),
                   load.transpose() * matrix(whole.loads.body_force_residual, 12));
  const auto view_part = [&](const Kernel& kernel) {
    const std::vector<float>& values = kernel.view->residual_flexibility;
    return matrix({values.begin(), values.end()}, 9);
  };
  EXPECT_LT((view_part(cut) - view_part(whole) * load).norm(),
            1e-6 * view_part(whole).norm());  // single precision
}

template <class Action>
void expect_refusal(Action action, const std::string& fragment) {
  const std::string text = complaint_of(action);
  EXPECT_TRUE(text.starts_with("kernel of \"bar\": ")) << text;
  EXPECT_NE(text.find(fragment), std::string::npos) << text;
}

TEST(Truncation, is_refused_if_the_kernel_lacks_the_data_for_it) {
  const Kernel whole = Bar{}.kernel();
  expect_refusal([&] { truncated_to_band(whole, {1e3}); }, "all modes up to 14.");
  expect_refusal([&] { truncated_to_band(whole, {0}); }, "not up to 0");
  expect_refusal([&] { truncated_to_count(whole, 41); }, "has 40 modes, fewer than 41");
  expect_refusal([&] { truncated_to_flexibility_error(whole, {14}, 1e-3); }, "may cause an error of");
  expect_refusal(
      [&] {
        restricted_to_points(whole, {0, 4});
      },
      "no candidate 4: they are numbered from 0 to 3");
  expect_refusal([&] { restricted_to_points(whole, {-1}); }, "no candidate -1");
  expect_refusal([&] { restricted_to_points(whole, {1, 1}); }, "named twice");
  expect_refusal([&] { restricted_to_points(whole, {}); }, "name at least one");
  Kernel bare = whole;
  bare.surface.residual_flexibility.clear();
  expect_refusal([&] { truncated_to_flexibility_error(bare, {1}, 0.1); }, "no residual flexibility");
  const Kernel less = truncated_to_flexibility_error(whole, {1}, 0.1);
  expect_refusal([&] { truncated_to_band(less, {1}); }, "were truncated");
  expect_refusal([&] { restricted_to_direction(whole, {1, 0, 0}); }, "has one direction only");
  Kernel fitted = whole;
  fitted.modes.basis = "contact";
  expect_refusal([&] { truncated_to_count(fitted, 3); }, "contact-adapted basis");
}

}  // namespace algebra_test
}  // namespace ricochet::kernels
