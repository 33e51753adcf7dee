// SPDX-License-Identifier: BSD-2-Clause
// Bodies at rest compared with statics by hand (standing and stacked rods, a table on three
// legs) and with enumerated active sets.
#include "contact/static/equilibrium.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "base/hdf5_reader.hpp"
#include "contact/figures/equilibrium_summary.hpp"
#include "contact/files/recorder.hpp"
#include "tests/contact/bodies.hpp"

namespace equilibrium_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr auto uzawa = EquilibriumOptions::Solver::uzawa;
constexpr double length = 2, weight = 3;  // the rods have ρA = EA = 1; weight per length

const Obstacle wall{"wall", Vector3d::Zero(), Vector3d::UnitX()};

Model standing(const Kernel& kernel, double gap, double pull = -weight) {
  return build_model({{"rod", &kernel, Matrix3d::Identity(), {gap, 0, 0}}}, {wall},
                     {{"rod", "wall", {}, {}, {}}}, {pull, 0, 0});
}

TEST(Equilibrium, of_a_rod_on_its_foot_is_that_of_a_column_under_its_own_weight) {
  const Kernel kernel = rod(5, length);
  const double gap = 0.25;
  for (const auto solver : {EquilibriumOptions::Solver::exact, uzawa}) {
    const Model model = standing(kernel, gap);
    const Equilibrium at_rest = find_equilibrium(model, {.solver = solver});
    // 1e-6: R of the rod is a sum of 10⁶ terms, and Uzawa stops at 1e-9 of the closed gap
    EXPECT_NEAR(at_rest.force.sum(), weight * length, 1e-6);
    EXPECT_NEAR(at_rest.displacement(0), gap, 1e-6);
    const EquilibriumSummary figures = summarise(model, at_rest);
    ASSERT_EQ(figures.pairs.size(), 1U);
    EXPECT_NEAR(figures.pairs[0].force_n, weight * length, 1e-6);
    // The gap plus the mean w L²/3 of the displacement u(x) = w (L x − x²/2) above the foot.
    EXPECT_NEAR(figures.pairs[0].approach_m, gap + weight * length * length / 3, 1e-5);
    EXPECT_EQ(figures.pairs[0].contact_points, 1);
    EXPECT_LT(figures.imbalance, 1e-6);
  }
}

TEST(Equilibrium, of_stacked_rods_loads_the_lower_one_twice) {
  const Kernel kernel = rod(4, length);
  const Model model =
      build_model({{"low", &kernel}, {"top", &kernel, Matrix3d::Identity(), {length + 0.5, 0, 0}}}, {wall},
                  {{"low", "wall", {}, {}, {}}, {"top", "low", Vector3d(-1, 0, 0), {}, {}}}, {-weight, 0, 0});
  const EquilibriumSummary figures = summarise(model, find_equilibrium(model));
  EXPECT_NEAR(figures.pairs[0].force_n, 2 * weight * length, 1e-9);
  EXPECT_NEAR(figures.pairs[1].force_n, weight * length, 1e-9);
  // Lower rod: u(x) = w (L x − x²/2) + w L x, with the mean 5/6 w L² and the value 3/2 w L² at the
  // head. The upper rod stands on this head.
  const double unit = weight * length * length;
  EXPECT_NEAR(figures.pairs[0].approach_m, 5.0 / 6 * unit, 1e-5);
  EXPECT_NEAR(figures.pairs[1].approach_m, 0.5 + (3.0 / 2 + 1.0 / 3 - 5.0 / 6) * unit, 1e-5);
}

TEST(Equilibrium, without_loads_is_no_contact) {
  const Kernel kernel = rod(5, length);
  for (const double gap : {0.0, 0.1}) {
    const Equilibrium at_rest = find_equilibrium(standing(kernel, gap, 0));
    EXPECT_EQ(at_rest.active, 0);
    EXPECT_EQ(at_rest.displacement.norm(), 0);
  }
}

TEST(Equilibrium, that_cannot_be_is_refused_with_the_force_that_nothing_carries) {
  const Kernel kernel = rod(5, length);
  EXPECT_THAT(complaint_of([&] { find_equilibrium(standing(kernel, 0.1, weight)); }),
              AllOf(StartsWith("bodies.rod: no contact forces hold it at rest: a force of [6, 0, 0] N"),
                    HasSubstr("give it a support")));
}

/// A rigid, flat table on three legs with its centre of mass at the
/// origin. Its modes are heave and two tilts.
Kernel table(const std::vector<Vector3d>& legs, double mass, double radius) {
  Kernel kernel;
  kernel.mass = mass;
  const double inertia = mass * radius * radius;
  kernel.inertia = {inertia, 0, 0, 0, inertia, 0, 0, 0, 2 * inertia};
  kernel.modes.angular_frequency.assign(3, 0);
  kernel.modes.decay_rate.assign(3, 0);
  for (const Vector3d& x : legs) {
    add_candidate(kernel, x, -Vector3d::UnitZ(), 1e-4);
    const double heave = 1 / std::sqrt(mass), tilt = 1 / std::sqrt(inertia);
    // Modes: e_z/√m, e_x × x/√I, e_y × x/√I.
    kernel.surface.shape.insert(kernel.surface.shape.end(), {0, 0, tilt * x.z(),   //
                                                             0, -tilt * x.z(), 0,  //
                                                             heave, tilt * x.y(), -tilt * x.x()});
  }
  kernel.surface.element = {0, 1, 2};
  const std::size_t rows = 3 * legs.size();
  kernel.surface.residual_flexibility.assign(rows * rows, 0);
  for (std::size_t k = 0; k < rows; ++k) kernel.surface.residual_flexibility[k * rows + k] = 1e-9;
  kernel.loads.body_force.assign(9, 0);
  kernel.loads.body_force[6] = std::sqrt(mass);
  kernel.loads.rotation.assign(9, 0);
  kernel.loads.rotation[1] = kernel.loads.rotation[5] = std::sqrt(inertia);
  kernel.loads.body_force_residual.assign(3 * rows, 0);
  return kernel;
}

Model on_floor(const Kernel& kernel) {
  return build_model({{"table", &kernel}}, {{"floor", {0, 0, -1}, Vector3d::UnitZ()}},
                     {{"table", "floor", {}, {}, {}}}, {0, 0, -10});
}

TEST(Equilibrium, of_a_table_shares_its_weight_among_three_legs_as_levers_do) {
  // The barycentric coordinates of the origin are 1/6, 1/3 and 1/2. The
  // legs carry these shares of the weight.
  const Kernel kernel = table({{2, 2, -1}, {-2, 1, -1}, {2.0 / 3, -4.0 / 3, -1}}, 7, 1.5);
  const Model model = on_floor(kernel);
  const Equilibrium at_rest = find_equilibrium(model);
  EXPECT_NEAR(at_rest.force(0), 70.0 / 6, 1e-9);
  EXPECT_NEAR(at_rest.force(1), 70.0 / 3, 1e-9);
  EXPECT_NEAR(at_rest.force(2), 70.0 / 2, 1e-9);
  EXPECT_NEAR(at_rest.displacement.norm(), 0, 1e-15);
}

TEST(Equilibrium, of_a_table_whose_weight_lies_beyond_its_legs_is_refused) {
  const Kernel kernel = table({{2, 2, -1}, {3, 1, -1}, {1, 1, -1}}, 7, 1.5);
  EXPECT_THAT(complaint_of([&] { find_equilibrium(on_floor(kernel)); }),
              StartsWith("bodies.table: no contact"));
}

// ---- Problems without bodies ----

struct Statics {
  Model model;
  MatrixXd S, B;
  VectorXd closing, f;
};

/// A model with elastic modes, a residual, and rigid modes whose load some contact forces can balance.
Statics random_statics(int points, int elastic, int rigid, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto fill = [&](int rows, int columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  Statics out;
  Model& model = out.model;
  model.B = fill(points, rigid + elastic);
  model.B.leftCols(rigid) =
      model.B.leftCols(rigid).cwiseAbs();  // any contact force pushes the rigid modes back
  model.omega.setZero(rigid + elastic);
  for (int n = rigid; n < rigid + elastic; ++n) model.omega(n) = 1 + n;
  model.load = fill(rigid + elastic, 1);
  const VectorXd carried = fill(points, 1).cwiseAbs();
  model.load.head(rigid) = model.B.leftCols(rigid).transpose() * carried;
  model.gap = fill(points, 1).cwiseAbs();
  model.static_displacement = 0.1 * fill(points, 1);
  model.area = fill(points, 1).cwiseAbs().array() + 0.5;
  const MatrixXd root = 0.3 * fill(points, points);
  model.R = root * root.transpose() + 0.05 * MatrixXd::Identity(points, points);
  out.S = model.R;
  out.closing = model.static_displacement - model.gap;
  for (int n = rigid; n < rigid + elastic; ++n) {
    const VectorXd b = model.B.col(n);
    out.S += b * b.transpose() / std::pow(model.omega(n), 2);
    out.closing += b * model.load(n) / std::pow(model.omega(n), 2);
  }
  out.B = model.B.leftCols(rigid);
  out.f = model.load.head(rigid);
  return out;
}

/// Solves the saddle point problem of each active set and returns the feasible solution.
VectorXd by_enumeration(const Statics& statics) {
  const int m = static_cast<int>(statics.S.rows()), r = static_cast<int>(statics.f.size());
  for (unsigned set = 0; set < 1U << m; ++set) {
    std::vector<int> active;
    for (int i = 0; i < m; ++i)
      if (set >> i & 1U) active.push_back(i);
    const int p = static_cast<int>(active.size());
    if (p < r) continue;
    MatrixXd saddle = MatrixXd::Zero(p + r, p + r);
    saddle.topLeftCorner(p, p) = statics.S(active, active);
    saddle.topRightCorner(p, r) = -statics.B(active, Eigen::all);
    saddle.bottomLeftCorner(r, p) = statics.B(active, Eigen::all).transpose();
    VectorXd right(p + r);
    right << statics.closing(active), statics.f;
    const VectorXd x = saddle.fullPivLu().solve(right);
    if (p > 0 && x.head(p).minCoeff() < 0) continue;
    VectorXd lambda = VectorXd::Zero(m);
    lambda(active) = x.head(p);
    if ((statics.S * lambda - statics.closing - statics.B * x.tail(r)).minCoeff() > -1e-10) return lambda;
  }
  ADD_FAILURE() << "no active set is feasible";
  return VectorXd::Zero(m);
}

TEST(Equilibrium, is_the_one_feasible_active_set_of_all) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int rigid = static_cast<int>(seed % 4);
    SCOPED_TRACE(seed);
    const Statics statics = random_statics(9, 5, rigid, seed);
    const VectorXd expected = by_enumeration(statics);
    const double scale = expected.cwiseAbs().maxCoeff() + 1e-3;
    const Equilibrium exact = find_equilibrium(statics.model);
    // 1e-9: the balance holds to 1e-11, and the condition number of S₀, about 100, amplifies this error
    EXPECT_LT((exact.force - expected).cwiseAbs().maxCoeff(), 1e-9 * scale);
    // Uzawa stops at 1e-9 of the closed gap; its balance holds to 1e-7.
    const Equilibrium slow = find_equilibrium(statics.model, {.solver = uzawa});
    EXPECT_LT((slow.force - expected).cwiseAbs().maxCoeff(), 1e-5 * scale);
  }
}

TEST(Equilibrium, of_many_points_meets_its_conditions) {
  const Statics statics = random_statics(200, 60, 3, 7);
  const Equilibrium at_rest = find_equilibrium(statics.model);
  const VectorXd open = statics.model.gap - at_rest.displacement;
  // Scale of the round-off of sums over 200 points.
  const double scale = statics.S.cwiseAbs().rowwise().sum().maxCoeff() * at_rest.force.maxCoeff();
  EXPECT_GT(at_rest.active, 3);
  EXPECT_GE(at_rest.force.minCoeff(), 0);
  EXPECT_GT(open.minCoeff(), -1e-10 * scale);
  EXPECT_LT(at_rest.force.cwiseProduct(open).cwiseAbs().maxCoeff(), 1e-10 * scale * at_rest.force.maxCoeff());
  EXPECT_LT((statics.B.transpose() * at_rest.force - statics.f).norm(), 1e-9 * statics.f.norm());
}

TEST(Equilibrium, by_uzawa_that_takes_too_long_is_an_error_and_no_result) {
  const Statics statics = random_statics(9, 5, 1, 3);
  EXPECT_THROW(find_equilibrium(statics.model, {.solver = uzawa, .uzawa_iterations = 3}),
               ricochet::SolverError);
}

// ---- Results ----

/// Rod along x with ρA = EA = 1, fixed at x = 0. Its head is the candidate, with flexibility L and sag g
/// L²/2.
Kernel post(int modes) {
  Kernel kernel = rod(1, length);
  kernel.supported = true;
  kernel.surface.node = {length, 0, 0};
  kernel.surface.normal = {1, 0, 0};
  kernel.surface.group = {"head"};
  kernel.surface.area = {1};
  kernel.surface.element = {0};
  kernel.surface.shape.clear();
  kernel.modes.angular_frequency.clear();
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), 0);
  kernel.loads.body_force.assign(3 * static_cast<std::size_t>(modes), 0);
  kernel.loads.rotation.assign(3 * static_cast<std::size_t>(modes), 0);
  double flexibility = length, sag = length * length / 2;
  for (int n = 0; n < modes; ++n) {
    const double k = (n + 0.5) * std::numbers::pi / length;
    const double head = std::sqrt(2 / length) * (n % 2 == 0 ? 1 : -1), mean = std::sqrt(2 / length) / k;
    kernel.modes.angular_frequency.push_back(k);
    kernel.surface.shape.push_back(head);
    kernel.loads.body_force[static_cast<std::size_t>(n)] = mean;
    flexibility -= head * head / (k * k);
    sag -= head * mean / (k * k);
  }
  kernel.surface.residual_flexibility = {flexibility};
  kernel.loads.body_force_residual = {sag, 0, 0};
  return kernel;
}

// ---- Springs of patches ----

// The law of the spring, tabulated and inverted by bisection; its energy by quadrature.
TEST(Equilibrium, of_a_bulging_point_meets_the_law_of_its_spring) {
  const double weight = 3, c = 0.5, gap = 0.1, bulge = 2;  // x = 3 · 0.5/4
  Model model;
  model.omega = Vector::Zero(1);
  model.load = Vector::Constant(1, weight);
  model.B = Matrix::Ones(1, 1);
  model.R = Matrix::Constant(1, 1, c);
  model.gap = Vector::Constant(1, gap);
  model.bulge = Vector::Constant(1, bulge);
  model.area = Vector::Ones(1);
  model.static_displacement = Vector::Zero(1);
  const auto law = [&](double force) {
    const double x = force * c / (2 * bulge);
    return 3 * bulge * std::pow(x, 2.0 / 3) - force * c;
  };
  double stored = 0;
  const int parts = 100'000;
  for (int k = 0; k < parts; ++k)
    stored += weight * (k + 0.5) / parts * (law(weight * (k + 1) / parts) - law(weight * k / parts));
  for (const auto solver : {EquilibriumOptions::Solver::exact, uzawa}) {
    const Equilibrium at_rest = find_equilibrium(model, {.solver = solver});
    const double fine = solver == uzawa ? 1e-6 : 1e-10;  // Uzawa balances forces to 1e-7
    EXPECT_NEAR(at_rest.force(0), weight, fine);
    EXPECT_NEAR(at_rest.q(0), gap + law(weight) + c * weight, 10 * fine);
    EXPECT_NEAR(at_rest.displacement(0), gap, 10 * fine);
    EXPECT_NEAR(at_rest.energy.residual, c * weight * weight / 2 + stored, 1e-5);
  }
}

TEST(Equilibrium, of_many_bulging_points_meets_its_conditions) {
  Statics statics = random_statics(60, 20, 3, 7);
  Model& model = statics.model;
  const double typical = find_equilibrium(model).force.maxCoeff() * model.R.diagonal().mean();
  model.bulge = Vector::LinSpaced(60, 0, 0.5 * typical);
  const auto springs = model.springs();
  const Equilibrium at_rest = find_equilibrium(model), slow = find_equilibrium(model, {.solver = uzawa});
  const VectorXd open = model.gap - at_rest.displacement;
  const double scale = statics.S.cwiseAbs().rowwise().sum().maxCoeff() * at_rest.force.maxCoeff();
  int partial = 0;
  for (int i = 0; i < 60; ++i) {
    const double f = at_rest.force(i);
    partial += f > 0 && f < springs[i].limit ? 1 : 0;
    const double s = f > 0 && springs[i].bulge > 0 ? springs[i].displacement(f) : 0;
    const double u =
        model.B.row(i).dot(at_rest.q) + model.static_displacement(i) - model.R.row(i).dot(at_rest.force);
    EXPECT_NEAR(open(i), model.gap(i) - u + s, 1e-12 * scale);
  }
  EXPECT_GT(partial, 3);
  EXPECT_GT(open.minCoeff(), -1e-10 * scale);
  EXPECT_LT(at_rest.force.cwiseProduct(open).cwiseAbs().maxCoeff(), 1e-10 * scale * at_rest.force.maxCoeff());
  EXPECT_LT((statics.B.transpose() * at_rest.force - statics.f).norm(), 1e-9 * statics.f.norm());
  EXPECT_LT((slow.force - at_rest.force).cwiseAbs().maxCoeff(), 1e-4 * at_rest.force.maxCoeff());
}

/// A mass on a spring of stiffness k, with a pad of flexibility c on the wall side, at a distance `gap` from
/// a wall, and a force f towards the wall.
Model on_spring(double k, double c, double gap, double f) {
  Model model;
  model.omega = Vector::Constant(1, std::sqrt(k));
  model.load = Vector::Constant(1, f);
  model.B = Matrix::Ones(1, 1);
  model.R = Matrix::Constant(1, 1, c);
  model.gap = Vector::Constant(1, gap);
  model.area = Vector::Ones(1);
  model.static_displacement = Vector::Zero(1);
  return model;
}

// The mass moves by x and presses the wall with λ: k x = f − λ and x − c λ = gap.
TEST(Equilibrium, has_the_energies_of_a_spring_and_a_pad_and_the_work_of_the_load) {
  const double k = 40, c = 0.03, gap = 0.02;
  for (const double f : {0.5, 5.0})  // too weak to reach the wall, and pressed against it
    for (const auto solver : {EquilibriumOptions::Solver::exact, uzawa}) {
      const Equilibrium at_rest = find_equilibrium(on_spring(k, c, gap, f), {.solver = solver});
      const double lambda = std::max(0.0, (f - k * gap) / (1 + k * c)), x = (f - lambda) / k;
      const double fine = solver == uzawa ? 1e-8 : 1e-14;
      EXPECT_NEAR(at_rest.force(0), lambda, fine * f);
      EXPECT_NEAR(at_rest.energy.strain, k * x * x / 2, fine);
      EXPECT_NEAR(at_rest.energy.residual, c * lambda * lambda / 2, fine);
      EXPECT_NEAR(at_rest.energy.loads, f * x, fine);
      EXPECT_EQ(at_rest.energy.kinetic, 0);
      EXPECT_EQ(at_rest.energy.contact, 0);
      EXPECT_EQ(at_rest.energy.friction, 0);
    }
}

// Two posts head to head, of flexibility L each; the foot of one moves by d towards the other. f = d/(2 L)
// shortens both by d/2, and by half of this in the mean, so their centres come nearer by d − d/4 − d/4. 2e-3:
// six modes lack this share of the mean.
TEST(Equilibrium, of_posts_that_a_support_presses_together_brings_their_centres_nearer) {
  const Kernel kernel = post(6);
  const Matrix3d turned = Eigen::DiagonalMatrix<double, 3>(-1, -1, 1);
  Model model = build_model({{"low", &kernel}, {"top", &kernel, turned, {2 * length, 0, 0}}}, {},
                            {{"top", "low", Vector3d(-1, 0, 0), {}, {}}}, {0, 0, 0});
  const double d = 1e-3;
  Model::Forcing one;
  one.body = 1;
  one.support = true;
  one.first_mode = model.bodies[1].first_mode;
  one.force = one.lift = Vector::Zero(model.bodies[1].modes);
  one.displacement = Vector::Constant(model.rows(), d);
  one.displacement_a = Vector::Zero(model.rows());
  one.lift_momentum = {-d * model.bodies[1].mass, 0, 0};
  one.history = dead_load;
  model.forcing.push_back(one);
  const EquilibriumSummary figures = summarise(model, find_equilibrium(model));
  EXPECT_NEAR(figures.pairs[0].force_n, d / (2 * length), 1e-9);
  EXPECT_NEAR(figures.pairs[0].approach_m, d / 2, 2e-3 * d);
}

TEST(EquilibriumResult, has_rows_in_which_supports_carry_the_loads_of_their_time) {
  const Kernel low = post(6), top = rod(5, length);
  Model model = build_model({{"low", &low}, {"top", &top, Matrix3d::Identity(), {length, 0, 0}}}, {},
                            {{"top", "low", Vector3d(-1, 0, 0), {}, {}}}, {-weight, 0, 0});
  Model::Forcing one;
  one.body = 0;
  one.first_mode = model.bodies[0].first_mode;
  one.force = one.lift = Vector::Zero(model.bodies[0].modes);
  one.displacement = one.displacement_a = Vector::Zero(model.rows());
  one.total = {3, 0, 0};
  one.history = {{0, 1, 2}, {0, 0.5, 2}};
  model.forcing.push_back(one);
  Equilibrium at_rest = find_equilibrium(model);
  const ricochet::test::Folder folder;
  Recorder recorder(model, {.path = folder / "r.h5", .title = "r"});
  for (const double time : {0.0, 1.0, 2.0}) {
    at_rest.time = time;
    recorder.record(at_rest);
  }
  recorder.commit();
  const ricochet::base::hdf5::Reader file(folder / "r.h5", "");
  EXPECT_EQ(file.read<double>("/time", {3}), (std::vector<double>{0, 1, 2}));
  const std::vector<double> reaction = file.read<double>("/bodies/low/reaction", {3, 3});
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(reaction[3 * k], 2 * weight * length - 3 * one.history.value[k], 1e-9);
}

TEST(EquilibriumResult, holds_one_row_with_forces_displacements_and_what_supports_carry) {
  const Kernel low = post(6), top = rod(5, length);
  const Model model = build_model({{"low", &low}, {"top", &top, Matrix3d::Identity(), {length, 0, 0}}}, {},
                                  {{"top", "low", Vector3d(-1, 0, 0), {}, {}}}, {-weight, 0, 0});
  const Equilibrium at_rest = find_equilibrium(model);
  const ricochet::test::Folder folder;
  Recorder recorder(model, {.path = folder / "r.h5", .title = "r", .snapshot_every = 1});
  recorder.record(at_rest);
  recorder.commit();
  const ricochet::base::hdf5::Reader file(folder / "r.h5", "");
  const auto row = [&](const std::string& name, std::size_t n) { return file.read<double>(name, {1, n}); };
  EXPECT_EQ(file.read<double>("/time", {1}), std::vector<double>{0});
  EXPECT_EQ(file.read<double>("/contact/time", {1}), std::vector<double>{0});
  EXPECT_NEAR(row("/contact/force", 1)[0], weight * length, 1e-9);
  EXPECT_NEAR(row("/contact/gap", 1)[0], 0, 1e-12);
  // The head of the post sinks under its own weight and that of the rod, by
  // w L²/2 + w L · L. The normal n points down.
  for (const char* side : {"/contact/displacement_a", "/contact/displacement_b"})
    EXPECT_NEAR(row(side, 1)[0], 1.5 * weight * length * length, 1e-9);
  EXPECT_NEAR(row("/bodies/low/reaction", 3)[0], 2 * weight * length, 1e-9);
  EXPECT_EQ(row("/bodies/top/reaction", 3)[0], 0);
  EXPECT_EQ(row("/bodies/top/velocity", 3)[0], 0);
  EXPECT_EQ(file.read<double>("/energy/kinetic", {1})[0], 0);
  // Strain energy of the free rod on its foot: ∫ σ²/2 = w² L³/6, except for
  // the part of the modes above the fifth.
  const double strain =
      file.read<double>("/energy/strain", {1})[0] + file.read<double>("/energy/residual", {1})[0];
  const double whole = weight * weight * std::pow(length, 3) * (1.0 / 6 + 7.0 / 6);  // post: ∫ (2L − x)²/2
  EXPECT_NEAR(strain, whole, 2e-2 * whole);
  EXPECT_EQ(row("/snapshots/top", 5).size(), 5U);
}

}  // namespace equilibrium_test
