// SPDX-License-Identifier: BSD-2-Clause
// Bodies at rest with friction compared with statics by hand (blocks on inclines and belts, chains of
// springs with Masing's rule) and with enumerated states of all points in the plane.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <regex>

#include "contact/static/equilibrium.hpp"
#include "tests/contact/bodies.hpp"

namespace friction_equilibrium_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

// ---- A rigid block ----

constexpr double mass = 7, gravity = 10, half = 1.5, height = 0.4;  // of the centre above the feet

/// A rigid block on four feet at (±reach, ±reach, −height), with its centre at the origin and all six rigid
/// modes.
Kernel block(double reach = half) {
  Kernel kernel;
  kernel.mass = mass;
  const double inertia = 5;
  kernel.inertia = {inertia, 0, 0, 0, inertia, 0, 0, 0, inertia};
  kernel.modes.angular_frequency.assign(6, 0);
  kernel.modes.decay_rate.assign(6, 0);
  const double slide = 1 / std::sqrt(mass), roll = 1 / std::sqrt(inertia);
  for (const double x : {-reach, reach})
    for (const double y : {-reach, reach}) {
      add_candidate(kernel, {x, y, -height}, -Vector3d::UnitZ(), 1e-4);
      const double z = -height;  // e_i, and e_i × (x, y, z)
      kernel.surface.shape.insert(kernel.surface.shape.end(), {slide, 0, 0, 0, roll * z, -roll * y,  //
                                                               0, slide, 0, -roll * z, 0, roll * x,  //
                                                               0, 0, slide, roll * y, -roll * x, 0});
    }
  kernel.surface.element = {0, 1, 2, 1, 3, 2};
  kernel.surface.residual_flexibility.assign(12 * 12, 0);
  for (std::size_t k = 0; k < 12; ++k) kernel.surface.residual_flexibility[13 * k] = 1e-9;
  kernel.loads.body_force.assign(18, 0);
  kernel.loads.rotation.assign(18, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    kernel.loads.body_force[7 * i] = std::sqrt(mass);
    kernel.loads.rotation[7 * i + 3] = std::sqrt(inertia);
  }
  kernel.loads.body_force_residual.assign(3 * 12, 0);
  return kernel;
}

Model on_plane(const Kernel& kernel, const Vector3d& acceleration, double friction, double gap = 0) {
  PairRequest pair{"block", "floor", {}, {}, {}};
  pair.friction = ricochet::Friction{friction, friction, 0};
  return build_model({{"block", &kernel}}, {{"floor", {0, 0, -height - gap}, Vector3d::UnitZ()}}, {pair},
                     acceleration);
}

/// On a plane that falls towards +x by this angle.
Model on_incline(const Kernel& kernel, double angle, double friction, double gap = 0) {
  return on_plane(kernel, gravity * Vector3d(std::sin(angle), 0, -std::cos(angle)), friction, gap);
}

TEST(FrictionEquilibrium, of_a_block_on_an_incline_carries_its_weight_by_friction_and_leans_downhill) {
  const Kernel kernel = block();
  for (const double gap : {0.0, 1e-6}) {
    const double angle = 0.3;
    const Model model = on_incline(kernel, angle, 1.01 * std::tan(angle), gap);
    const Equilibrium at_rest = find_equilibrium(model);
    const Vector3d push = model.resultant(model.pairs[0], at_rest.force, model);  // on the floor
    EXPECT_LT((push - mass * model.gravity).norm(), 1e-9 * mass * gravity);
    const double level = mass * gravity * std::cos(angle) / 4;
    const double lean = mass * gravity * std::sin(angle) * height / half / 4;
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(at_rest.force(i), model.point_a(i, 0) > 0 ? level + lean : level - lean, 1e-8 * level);
    EXPECT_EQ(at_rest.active, 4);
    EXPECT_LT(at_rest.imbalance, 1e-10);
    // Each foot closes its gap, and no foot moves along the plane by more than feet yield.
    EXPECT_LT(at_rest.displacement.norm(), 2 * gap + 1e-9 * level);
  }
}

// 1e-10: the work of feet that yield by 1e-7 m is a difference of sums.
TEST(FrictionEquilibrium, of_a_block_on_bulging_feet_closes_the_ledger) {
  const Kernel kernel = block();
  const double angle = 0.3;
  Model model = on_incline(kernel, angle, 1.2 * std::tan(angle), 1e-8);
  model.bulge = Vector::Constant(4, 1e-7);
  const Equilibrium at_rest = find_equilibrium(model);
  const double level = mass * gravity * std::cos(angle) / 4;
  const auto springs = model.springs();
  double flattened = 0;
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(at_rest.force(i), 0.1 * level);
    EXPECT_LT(at_rest.force(i), springs[i].limit);
    flattened += springs[i].energy(at_rest.force(i));
  }
  EXPECT_NEAR(at_rest.energy.residual - 0.5 * at_rest.force.dot(model.R * at_rest.force), flattened,
              1e-12 * flattened);
  EXPECT_NEAR(at_rest.energy.ledger(), 0, 1e-10 * at_rest.energy.loads);
  EXPECT_LT(std::abs(at_rest.energy.contact), 0.05 * flattened);
}

TEST(FrictionEquilibrium, that_needs_more_friction_is_refused_with_the_force_that_is_missing) {
  const Kernel kernel = block();
  const double angle = 0.3;
  EXPECT_NO_THROW(find_equilibrium(on_incline(kernel, angle, 1.0001 * std::tan(angle))));
  EXPECT_THAT(complaint_of([&] { find_equilibrium(on_incline(kernel, angle, 0.9999 * std::tan(angle))); }),
              AllOf(StartsWith("bodies.block: no contact forces hold it at rest"),
                    HasSubstr("raise contact.friction")));
  const double friction_angle = 0.2;
  const std::string complaint =
      complaint_of([&] { find_equilibrium(on_incline(kernel, angle, std::tan(friction_angle))); });
  // The weight minus its projection on the cone of friction.
  const double missing = mass * gravity * std::sin(angle - friction_angle);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(complaint, found, std::regex(R"(a force of \[(.*?), (.*?), (.*?)\] N)")));
  // 1e-3: the complaint has four digits
  EXPECT_NEAR(std::stod(found[1]), missing * std::cos(friction_angle), 1e-3 * missing);
  EXPECT_NEAR(std::stod(found[2]), 0, 1e-3 * missing);
  EXPECT_NEAR(std::stod(found[3]), missing * std::sin(friction_angle), 1e-3 * missing);
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 0);
}

// Round-off of sums over contact points must not refuse a body, and a load that nothing carries must not pass
// as round-off. Whatever lies between: no load ends as a failure of the solver.
TEST(FrictionEquilibrium, is_found_or_refused_at_every_distance_from_what_can_be_held) {
  const Kernel kernel = block();
  for (double more = 1e-13; more < 1e-6; more *= 1.7) {
    int refusals = 0;
    for (const double friction : {0.0, std::tan(0.3)}) try {
        const double angle = std::atan(friction) + more;
        if (friction > 0)
          find_equilibrium(on_incline(kernel, angle, friction));
        else
          find_equilibrium(build_model({{"block", &kernel}}, {{"floor", {0, 0, -height}, Vector3d::UnitZ()}},
                                       {{"block", "floor", {}, {}, {}}},
                                       gravity * Vector3d(std::sin(angle), 0, -std::cos(angle))));
      } catch (const ricochet::InputError&) {
        ++refusals;
      }
    if (more < 5e-12) {
      EXPECT_EQ(refusals, 0) << more;
    } else if (more > 1e-10 && more < 5e-10) {  // 1e-11 of the weight without friction, 1e-9 with it
      EXPECT_EQ(refusals, 1) << more;
    } else if (more > 1e-8) {
      EXPECT_EQ(refusals, 2) << more;
    }
  }
}

// Four feet within 1e-4 of the size of the block: the forces of single feet lose four digits, their sum none.
TEST(FrictionEquilibrium, on_feet_that_are_close_together_is_not_refused_for_round_off) {
  for (const double width : {1e-2, 1e-3, 1e-4}) {
    const Kernel kernel = block(width);
    const Model smooth = build_model({{"block", &kernel}}, {{"floor", {0, 0, -height}, Vector3d::UnitZ()}},
                                     {{"block", "floor", {}, {}, {}}}, {0, 0, -gravity});
    EXPECT_NEAR(find_equilibrium(smooth).force.sum(), mass * gravity, 1e-9) << width;
  }
}

TEST(FrictionEquilibrium, of_a_block_that_would_tip_over_is_refused_however_rough_the_plane) {
  const Kernel kernel = block();
  const double tips = std::atan(half / height);
  EXPECT_NO_THROW(find_equilibrium(on_incline(kernel, tips - 0.01, 100)));
  EXPECT_THROW(find_equilibrium(on_incline(kernel, tips + 0.01, 100)), ricochet::InputError);
}

TEST(FrictionEquilibrium, of_a_block_on_a_moving_belt_is_carried_along) {
  const Kernel kernel = block();
  Model model = on_plane(kernel, {0, 0, -gravity}, 0.1);
  const Vector3d way(0.3, -0.1, 0);
  add_belt(model, "floor", way, {{0, 1}, {0, 1}});
  const Equilibrium at_rest = find_equilibrium(model);
  const Vector3d moved = model.bodies[0].momentum * at_rest.q / mass;
  EXPECT_LT((moved - way - moved.z() * Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_LT(at_rest.force.tail(8).norm(), 3e-9 * mass * gravity);  // 1e-9, the solver's, in each of 8 rows
  EXPECT_LT(std::abs(at_rest.energy.friction), 1e-9);
  EXPECT_EQ(at_rest.time, 1);
}

// ---- Points on springs ----

/// Points that a spring of stiffness 1 each presses with a force of `load`, with gap 0. Their tangential
/// motion along the first tangent is that of unit masses with the stiffness matrix K.
Model points_on(const MatrixXd& K, const VectorXd& load, double friction) {
  const Eigen::Index m = load.size();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(K);
  Model model;
  model.omega.setOnes(2 * m);
  model.load.setZero(2 * m);
  model.load.head(m) = load;
  model.B.setZero(3 * m, 2 * m);
  model.B.topLeftCorner(m, m).setIdentity();
  model.R.setZero(3 * m, 3 * m);
  for (int i = 0; i < m; ++i) {
    const auto t = static_cast<int>(m) + 2 * i;
    model.friction.push_back({i, t, {friction, friction, 0}});
    model.B.row(t).tail(m) = modes.eigenvectors().row(i);
    model.R(t + 1, t + 1) = 1;
  }
  for (Eigen::Index k = 0; k < m; ++k)
    model.omega(m + k) = modes.eigenvalues()(k) > 1e-12 ? std::sqrt(modes.eigenvalues()(k)) : 0;
  model.gap.setZero(m);
  model.area.setOnes(m);
  model.static_displacement.setZero(3 * m);
  return model;
}

/// A force on point i along its normal (row 0) or first tangent (row 1).
void pull(Model& model, Eigen::Index i, int row, History history) {
  Model::Forcing one;
  one.force = model.B.row(row == 0 ? i : model.points() + 2 * i).transpose();
  one.lift.setZero(one.force.size());
  one.displacement.setZero(model.rows());
  one.history = std::move(history);
  model.forcing.push_back(one);
}

MatrixXd chain(int points, double stiffness) {
  MatrixXd K = MatrixXd::Zero(points, points);
  for (int i = 0; i + 1 < points; ++i)
    K.block(i, i, 2, 2) += stiffness * (MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  return K;
}

double place_of(const Model& model, const Equilibrium& at_rest, Eigen::Index i) {
  return at_rest.displacement(model.points() + 2 * i);
}

double ledger(const Equilibrium& at_rest) { return at_rest.energy.ledger(); }

// The solver meets Coulomb's law to 1e-12 ‖S‖ |p| in displacements, with ‖S‖ = 1 m/N and |p| = 5 N; a
// stiffness of 40 N/m makes forces of them.
constexpr double fine = 40 * 5e-12;

TEST(FrictionEquilibrium, of_a_point_on_two_springs_sticks_and_then_slips_under_a_growing_shear) {
  const double k = 40, press = 5, mu = 0.25;
  for (const double shear : {0.5, 1.2, 1.3, 4.0}) {
    Model model = points_on(MatrixXd::Constant(1, 1, k), VectorXd::Constant(1, press), mu);
    pull(model, 0, 1, {{0, 2}, {0, shear}});
    const Equilibrium at_rest = find_equilibrium(model);
    const double tau = std::min(shear, mu * press), w = (shear - tau) / k;
    EXPECT_NEAR(at_rest.force(0), press, fine);
    EXPECT_NEAR(at_rest.force(1), tau, fine);
    EXPECT_NEAR(place_of(model, at_rest, 0), w, fine);
    EXPECT_NEAR(at_rest.energy.friction, mu * press * w, fine);
    EXPECT_NEAR(at_rest.energy.strain, k * w * w / 2, fine);
    EXPECT_NEAR(ledger(at_rest), 0, fine);
    ASSERT_EQ(at_rest.states.size(), 1U);
    EXPECT_EQ(at_rest.states[0], shear > mu * press ? ContactState::slip : ContactState::stick);
    EXPECT_EQ(at_rest.time, 2);
  }
}

// A point at a gap g with S_nn = S_tt = 1 is moved along the plane by −3 g in each increment, w = S p + (g, 3
// g). It may stay open; if it touches and sticks, p = −S⁻¹ (g, 3 g), which is a pressure for S_nt > 1/3 and
// within the cone for a large μ. So there are two equilibria at least. If μ S_nt < S_nn, friction never draws
// a point in, and the open one is the only one.
TEST(FrictionEquilibrium, that_is_not_the_only_one_is_counted_in_every_increment) {
  const double gap = 1e-3;
  for (const double mu : {1.0, 2.0}) {
    Model model = points_on(MatrixXd::Constant(1, 1, 1), VectorXd::Zero(1), mu);
    model.omega(0) = 1;
    model.R(0, 1) = model.R(1, 0) = 0.8;
    model.gap(0) = gap;
    pull(model, 0, 1, {{0, 1}, {0, -3 * gap * 5}});
    const Equilibrium at_rest = find_equilibrium(model, {.increments = 5});
    EXPECT_EQ(at_rest.increments, 10);  // the first half without any load
    if (mu == 1) {
      EXPECT_EQ(at_rest.ambiguous, 0);
      EXPECT_EQ(at_rest.active, 0);
    } else {
      EXPECT_GE(at_rest.ambiguous, 1);
      EXPECT_LE(at_rest.ambiguous, 5);
    }
    if (at_rest.active == 0 && mu == 2) {
      EXPECT_EQ(at_rest.ambiguous, 5);
    }
  }
}

TEST(FrictionEquilibrium, of_a_point_on_a_spring_that_a_belt_drags_slips_at_the_limit) {
  const double k = 40, press = 5, mu = 0.25, stretch = mu * press / k;
  for (const double way : {0.5 * stretch, 3 * stretch}) {
    Model model = points_on(MatrixXd::Constant(1, 1, k), VectorXd::Constant(1, press), mu);
    model.belts.push_back({"floor", VectorXd::Unit(3, 1) * -way, {{0, 1, 3}, {0, 1, 1}}});
    const Equilibrium at_rest = find_equilibrium(model, {.increments = 30});  // slip begins after ten of them
    const double w = std::min(way, stretch);
    EXPECT_NEAR(place_of(model, at_rest, 0), -w, fine);
    EXPECT_NEAR(at_rest.force(1), k * w, fine);
    EXPECT_NEAR(at_rest.energy.friction, mu * press * (way - w), fine);
    // The belt works with the force on it.
    EXPECT_NEAR(at_rest.energy.loads, k * w * w / 2 + mu * press * (way - w), fine);
    EXPECT_NEAR(ledger(at_rest), 0, fine);
    EXPECT_EQ(at_rest.time, 3);
  }
}

TEST(FrictionEquilibrium, of_a_point_whose_support_moves_is_that_of_a_point_held_by_the_spring_between) {
  const double k = 40, press = 5, mu = 0.25, stretch = mu * press / k;
  for (const double way : {0.5 * stretch, 3 * stretch}) {
    Model model = points_on(MatrixXd::Constant(1, 1, k), VectorXd::Constant(1, press), mu);
    pull(model, 0, 1, {{-1, 0, 1}, {0.2, 0.2, 1.2}});  // displaced before: that does not count
    model.forcing[0].force.setZero();
    model.forcing[0].support = true;
    model.forcing[0].displacement = VectorXd::Unit(3, 1) * way;
    const Equilibrium at_rest = find_equilibrium(model);
    const double w = std::max(0.0, way - stretch);
    EXPECT_NEAR(place_of(model, at_rest, 0), 0.2 * way + w, fine);
    EXPECT_NEAR(at_rest.force(1), std::min(k * way, mu * press), fine);
    EXPECT_NEAR(at_rest.energy.friction, mu * press * w, fine);
    EXPECT_NEAR(ledger(at_rest), 0, fine);
  }
}

TEST(FrictionEquilibrium, depends_on_the_order_of_loads) {
  const double k = 40, press = 5, mu = 0.25, shear = 3;
  const History first{{0, 1}, {0, 1}}, second{{1, 2}, {0, 1}};
  const auto find = [&](const History& normal, const History& tangential) {
    Model model = points_on(MatrixXd::Constant(1, 1, k), VectorXd::Zero(1), mu);
    pull(model, 0, 0, {normal.time, {0, press}});
    pull(model, 0, 1, {tangential.time, {0, shear}});
    return find_equilibrium(model).force(1);
  };
  EXPECT_NEAR(find(first, second), mu * press, 1e-12);  // the shear meets a pressed point
  EXPECT_NEAR(find(second, first), 0, 1e-12);           // the point has moved freely before
  // Together, the shear grows faster than what friction holds.
  EXPECT_NEAR(find(first, first), mu * press, 1e-12);
}

TEST(FrictionEquilibrium, meets_loads_that_jump_at_the_start_after_those_that_were_there_before) {
  Model model = points_on(MatrixXd::Constant(1, 1, 40), VectorXd::Zero(1), 0.25);
  pull(model, 0, 1, {{-1}, {3}});
  pull(model, 0, 0, {{0}, {5}});
  EXPECT_NEAR(find_equilibrium(model).force(0), 5, 1e-12);
  EXPECT_NEAR(find_equilibrium(model).force(1), 0, fine);  // the point has moved freely before it was pressed
}

// ---- A chain of pressed blocks, pulled at its first block: Masing's rule ----

constexpr int blocks = 6;
constexpr double stiffness = 30, press = 4, mu = 0.3, limit = mu * press;

/// Displacement of the first block under a force that grows from 0: block i slips once the force reaches
/// i · limit.
double backbone(double force) {
  double out = 0;
  for (int i = 1; i * limit < force; ++i) out += (force - i * limit) / stiffness;
  return out;
}

/// ∫ backbone from 0 to `force`
double complement(double force) {
  double out = 0;
  for (int i = 1; i * limit < force; ++i) out += std::pow(force - i * limit, 2) / (2 * stiffness);
  return out;
}

Equilibrium pulled(const std::vector<double>& forces, int increments, double* place = nullptr) {
  Model model = points_on(chain(blocks, stiffness), VectorXd::Constant(blocks, press), mu);
  History history{{0}, {0}};
  for (const double force : forces) {
    history.time.push_back(static_cast<double>(history.time.size()));
    history.value.push_back(force);
  }
  pull(model, 0, 1, history);
  Equilibrium out = find_equilibrium(model, {.increments = increments});
  if (place != nullptr) *place = place_of(model, out, 0);
  return out;
}

TEST(FrictionEquilibrium, is_reported_at_each_time_of_the_histories_at_which_a_load_has_changed) {
  Model model = points_on(chain(blocks, stiffness), VectorXd::Constant(blocks, press), mu);
  const double peak = 2.5 * limit;
  pull(model, 0, 1, {{0, 1, 2, 3, 4}, {0, peak, peak, -peak, 0}});
  std::vector<double> time, pull_of_friction;
  const Equilibrium last = find_equilibrium(model, {.increments = 7}, [&](const Equilibrium& at_knot) {
    time.push_back(at_knot.time);
    pull_of_friction.push_back(at_knot.force.tail(2 * blocks).sum());
  });
  EXPECT_EQ(time, (std::vector<double>{0, 2, 3, 4}));  // nothing changes from 1 to 2
  // 1e-8: forces balance to 1e-9
  const std::vector<double> balance{0, peak, -peak, 0};
  for (std::size_t k = 0; k < balance.size(); ++k)
    EXPECT_NEAR(std::abs(pull_of_friction.at(k)), std::abs(balance[k]), 1e-8 * peak) << k;
  EXPECT_EQ(last.time, 4);

  // A load that jumps at t = 0 has two states there, before and after; the row is that after.
  Model jumping = points_on(chain(blocks, stiffness), VectorXd::Constant(blocks, press), mu);
  pull(jumping, 0, 1, {{0, 1}, {peak, 0}});
  time.clear();
  pull_of_friction.clear();
  find_equilibrium(jumping, {.increments = 7}, [&](const Equilibrium& at_knot) {
    time.push_back(at_knot.time);
    pull_of_friction.push_back(at_knot.force.tail(2 * blocks).sum());
  });
  EXPECT_EQ(time, (std::vector<double>{0, 1}));
  EXPECT_NEAR(std::abs(pull_of_friction.at(0)), peak, 1e-8 * peak);
}

TEST(FrictionEquilibrium, of_a_chain_follows_its_backbone_and_on_unloading_masings_rule) {
  // The chain can slide freely, so friction alone holds its rigid mode.
  const double peak = 4.6 * limit;
  for (const int increments : {1, 7}) {
    SCOPED_TRACE(increments);
    double place = 0;
    EXPECT_NEAR(
        pulled({peak}, increments, &place).energy.friction,
        [&] {
          // Block i slips by Σ_{l ≥ i} (peak − l limit)/stiffness.
          double heat = 0;
          for (int l = 1; l * limit < peak; ++l) heat += l * limit * (peak - l * limit) / stiffness;
          return heat;
        }(),
        1e-9);
    EXPECT_NEAR(place, backbone(peak), 1e-9);
    for (const double share : {0.5, 0.0, -0.7, -1.0}) {
      pulled({peak, share * peak}, increments, &place);
      EXPECT_NEAR(place, backbone(peak) - 2 * backbone((1 - share) * peak / 2), 1e-9);
    }
  }
}

TEST(FrictionEquilibrium, of_a_chain_turns_the_area_of_the_loop_into_heat) {
  const double peak = 4.6 * limit;
  double begin = 0, end = 0;
  const Equilibrium before = pulled({peak}, 5, &begin), after = pulled({peak, -peak, peak}, 5, &end);
  EXPECT_NEAR(begin, end, 1e-9);
  EXPECT_LT((before.force - after.force).norm(), 1e-8 * press);
  const double area = 4 * peak * backbone(peak) - 8 * complement(peak);
  EXPECT_NEAR(after.energy.friction - before.energy.friction, area, 1e-9);
  EXPECT_NEAR(ledger(after), 0, 1e-9);
}

TEST(FrictionEquilibrium, of_a_chain_that_is_pulled_away_is_refused) {
  EXPECT_NO_THROW(pulled({0.999 * blocks * limit}, 2));
  // A model without bodies names none, so the balance fails instead.
  EXPECT_ANY_THROW(pulled({1.001 * blocks * limit}, 2));
}

// ---- Enumeration ----

struct Planar {
  Model model;
  MatrixXd S, B;
};

/// Random points in the plane: the second tangents take no part. Rigid modes have a load that forces within
/// the cones can balance.
Planar random_points(int points, int elastic, int rigid, double friction, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto fill = [&](Eigen::Index rows, Eigen::Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  Planar out;
  Model& model = out.model;
  const int n = 3 * points, N = rigid + elastic;
  model.B = fill(n, N);
  model.omega.setZero(N);
  for (int k = rigid; k < N; ++k) model.omega(k) = 1 + k;
  const MatrixXd root = 0.3 * fill(n, n);
  model.R = root * root.transpose() + 0.1 * MatrixXd::Identity(n, n);
  model.static_displacement = 0.2 * fill(n, 1);
  VectorXd carried = VectorXd::Zero(n);
  for (int i = 0; i < points; ++i) {
    const int t = points + 2 * i;
    model.friction.push_back({i, t, {friction, friction, 0}});
    model.B.row(i).head(rigid) = model.B.row(i).head(rigid).cwiseAbs();
    model.B.row(t + 1).setZero();
    model.R.row(t + 1).setZero();
    model.R.col(t + 1).setZero();
    model.R(t + 1, t + 1) = 1;
    model.static_displacement(t + 1) = 0;
    carried(i) = std::abs(normal(random)) + 0.3;
    carried(t) = 0.5 * friction * carried(i) * std::tanh(normal(random));
  }
  model.load = fill(N, 1);
  model.load.head(rigid) = model.B.leftCols(rigid).transpose() * carried;
  model.gap = 0.5 * fill(points, 1).cwiseAbs();
  model.area.setOnes(points);
  out.S = model.R;
  for (int k = rigid; k < N; ++k)
    out.S += model.B.col(k) * model.B.col(k).transpose() / std::pow(model.omega(k), 2);
  out.B = model.B.leftCols(rigid);
  return out;
}

/// Solves the linear equations of each combination of states (open, stick, slip either way) of all points
/// and returns the p of those that are consistent. @param r  (n) û − g, and û − w
std::vector<std::pair<VectorXd, VectorXd>> by_enumeration(const Planar& planar, double friction,
                                                          const VectorXd& r, const VectorXd& f) {
  const int m = static_cast<int>(planar.model.points()), rigid = static_cast<int>(f.size());
  std::vector<std::pair<VectorXd, VectorXd>> out;
  for (int code = 0; code < 1 << 2 * m; ++code) {
    // Unknowns λ_i, τ_i and ρ; w = S p − r − B ρ.
    MatrixXd equations = MatrixXd::Zero(2 * m + rigid, 2 * m + rigid);
    VectorXd right = VectorXd::Zero(2 * m + rigid);
    const auto row_of = [&](int k) { return k < m ? k : m + 2 * (k - m); };
    const auto touch = [&](int equation, int row) {
      for (int k = 0; k < 2 * m; ++k) equations(equation, k) = planar.S(row, row_of(k));
      equations.row(equation).tail(rigid) = -planar.B.row(row);
      right(equation) = r(row);
    };
    for (int i = 0; i < m; ++i) {
      const int state = code >> 2 * i & 3;
      if (state == 0)
        equations(i, i) = equations(m + i, m + i) = 1;
      else {
        touch(i, i);
        if (state == 1)
          touch(m + i, m + 2 * i);
        else {
          equations(m + i, m + i) = 1;
          equations(m + i, i) = state == 2 ? -friction : friction;
        }
      }
    }
    for (int k = 0; k < rigid; ++k) {
      for (int j = 0; j < 2 * m; ++j) equations(2 * m + k, j) = planar.B(row_of(j), k);
      right(2 * m + k) = f(k);
    }
    const Eigen::FullPivLU<MatrixXd> lu(equations);
    if (!lu.isInvertible()) continue;
    const VectorXd x = lu.solve(right);
    VectorXd p = VectorXd::Zero(3 * m);
    for (int k = 0; k < 2 * m; ++k) p(row_of(k)) = x(k);
    const VectorXd w = planar.S * p - r - planar.B * x.tail(rigid);
    bool holds = true;
    for (int i = 0; i < m; ++i) {
      const int state = code >> 2 * i & 3, t = m + 2 * i;
      const double slip = -w(t);
      holds = holds && p(i) > -1e-10 && w(i) > -1e-10 &&
              (state != 1 || std::abs(p(t)) <= friction * p(i) + 1e-10) && (state != 2 || slip > -1e-10) &&
              (state != 3 || slip < 1e-10);
    }
    if (holds) out.emplace_back(p, x.tail(rigid));
  }
  return out;
}

TEST(FrictionEquilibrium, is_among_the_consistent_states_of_all_points) {
  constexpr double friction = 0.2;
  int slipping = 0, sticking = 0, open = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    const int rigid = static_cast<int>(seed % 3);
    SCOPED_TRACE(seed);
    const Planar planar = random_points(4, 5, rigid, friction, seed);
    const Model& model = planar.model;
    // The path: the loads in three equal parts.
    constexpr int parts = 3;
    VectorXd flexibility = VectorXd::Zero(model.omega.size());
    for (Eigen::Index k = rigid; k < flexibility.size(); ++k) flexibility(k) = std::pow(model.omega(k), -2);
    const VectorXd whole = model.static_displacement + model.B * flexibility.cwiseProduct(model.load);
    VectorXd w = VectorXd::Zero(model.rows()), p = w;
    for (int part = 1; part <= parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      VectorXd r = share * whole - w;
      r.head(4) = share * whole.head(4) - model.gap;
      const auto found = by_enumeration(planar, friction, r, share * model.load.head(rigid));
      ASSERT_FALSE(found.empty());
      for (const auto& [other, _] : found) ASSERT_LT((other - found[0].first).norm(), 1e-8);
      p = found[0].first;
      w = share * whole - planar.S * p + planar.B * found[0].second;
    }
    const Equilibrium at_rest = find_equilibrium(model, {.increments = parts});
    // 1e-8: the balance holds to 1e-11, and the condition number of S₀, about 100, amplifies this error
    EXPECT_LT((at_rest.force - p).norm(), 1e-8 * (1 + p.norm()));
    EXPECT_LT((at_rest.displacement - w).norm(), 1e-8 * (1 + w.norm()));
    EXPECT_NEAR(ledger(at_rest), 0, 1e-8 * (1 + at_rest.energy.strain + at_rest.energy.friction));
    EXPECT_GE(at_rest.energy.friction, 0);
    for (const ContactState state : at_rest.states) {
      slipping += state == ContactState::slip;
      sticking += state == ContactState::stick;
      open += state == ContactState::open;
    }
  }
  EXPECT_GT(std::min({slipping, sticking, open}), 10);
}

TEST(FrictionEquilibrium, errs_less_the_smaller_the_increments) {
  const Planar planar = random_points(4, 5, 0, 0.2, 1);
  std::vector<double> lost;
  for (const int increments : {10, 100, 1000}) {
    const Equilibrium at_rest = find_equilibrium(planar.model, {.increments = increments});
    EXPECT_NEAR(ledger(at_rest), 0, 1e-10);
    lost.push_back(std::abs(at_rest.energy.contact));
  }
  EXPECT_GT(lost[0], 0);
  EXPECT_LT(lost[2], 0.05 * lost[0]);  // first order: 1/100
}

TEST(FrictionEquilibrium, without_a_coefficient_is_that_without_friction) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Planar planar = random_points(5, 6, static_cast<int>(seed % 3 ? 1 : 0), 0, seed);
    Model smooth = planar.model;
    smooth.friction.clear();
    smooth.B = smooth.B.topRows(5).eval();
    smooth.R = smooth.R.topLeftCorner(5, 5).eval();
    smooth.static_displacement = smooth.static_displacement.head(5).eval();
    const Equilibrium rough = find_equilibrium(planar.model), at_rest = find_equilibrium(smooth);
    EXPECT_LT((rough.force.head(5) - at_rest.force).norm(), 1e-8 * (1 + at_rest.force.norm()));
    EXPECT_EQ(rough.energy.friction, 0);
  }
}

TEST(Equilibrium, without_friction_is_that_after_the_last_knot) {
  Model model = points_on(MatrixXd::Constant(1, 1, 1), VectorXd::Constant(1, 2), 0);
  pull(model, 0, 0, {{-1}, {3}});
  pull(model, 0, 0, {{1, 4}, {0.5, 7}});
  model.friction.clear();
  model.B = model.B.topRows(1).eval();
  model.R = MatrixXd::Zero(1, 1);
  model.static_displacement.setZero(1);
  for (Model::Forcing& one : model.forcing) one.displacement.setZero(1);
  const Equilibrium at_rest = find_equilibrium(model);
  EXPECT_NEAR(at_rest.force(0), 2 + 3 + 7, 1e-13);
  EXPECT_EQ(at_rest.time, 4);
}

TEST(FrictionEquilibrium, by_uzawa_is_refused) {
  const Model model = points_on(MatrixXd::Constant(1, 1, 1), VectorXd::Constant(1, 2), 0.1);
  EXPECT_THAT(complaint_of([&] { find_equilibrium(model, {.solver = EquilibriumOptions::Solver::uzawa}); }),
              HasSubstr("contact.solver = \"uzawa\": has no friction"));
}

}  // namespace friction_equilibrium_test
