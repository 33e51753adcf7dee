// SPDX-License-Identifier: BSD-2-Clause
// Traces of known fields on patches, and the static flexibility of a rod in closed form.
#include <gtest/gtest.h>

#include <memory>

#include <cmath>

#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"
#include "src/surface/trace.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace trace_test {

using Point = Eigen::Vector3d;

const Eigen::Matrix3d gradient =
    (Eigen::Matrix3d() << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.6, -0.1).finished();
const Point offset(0.2, -0.4, 0.9);

constexpr double placed = 1e-11;  // gmsh divides a line evenly to about 2e-12

struct Body {
  Body(const std::string& geo, int order, const std::vector<std::string>& contact,
       const surface::PatchOptions& options, const std::map<std::string, std::string>& support = {}) {
    const test::SharedFile file(".geo", geo);
    scene::Body body = test::body_of(file.path(), order);
    body.contact = contact;
    body.support = support;
    mesh = test::mesh_of(body);
    matrices = elasticity::assemble(mesh, body.materials, "test");
    factor = std::make_unique<modes::Factorisation>(matrices.stiffness, matrices.mass);
    patches = surface::make_patches(mesh, contact, options);
  }
  /// The columns u_0 = G x + o and u_1 = −2 u_0, used as modes.
  modes::ModeSet linear_fields() const {
    modes::ModeSet set;
    set.angular_frequency = {0, 0};
    set.index = {0, 1};
    set.shape.resize(matrices.local_rows, 2);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      const std::int64_t local = mesh.node[i] - mesh.first_node;
      if (local < 0 || local >= mesh.owned_nodes) continue;
      const Point u = gradient * Eigen::Map<const Point>(&mesh.position[3 * i]) + offset;
      set.shape.block<3, 1>(3 * local, 0) = u;
      set.shape.block<3, 1>(3 * local, 1) = -2 * u;
    }
    return set;
  }
  kernels::Kernel trace(const modes::ModeSet& set, bool residual, bool view) const {
    kernels::Kernel kernel;
    surface::trace(test::one_team(), mesh, matrices, *factor, set, patches,
                   surface::patch_loads(mesh, patches),
                   residual ? surface::Correction::all : surface::Correction::none, view, kernel,
                   surface::make_sources(mesh, {}));
    return kernel;
  }
  mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  std::unique_ptr<modes::Factorisation> factor;
  surface::Patches patches;
};

/// Centroid of a hat on a grid of step h on the unit square, at height 1.
Point centroid(const double* node, double h) {
  const auto inward = [&](double x) { return x < h / 2 ? h / 3 : x > 1 - h / 2 ? 1 - h / 3 : x; };
  return {inward(node[0]), inward(node[1]), 1};
}

TEST(Trace, of_a_linear_field_is_its_value_at_the_centroid_of_each_patch) {
  for (int order : {1, 2, 3}) {
    const Body body(test::block_geo("hex", 2, 0), order, {"top"}, {});
    const kernels::Kernel kernel = body.trace(body.linear_fields(), false, false);
    const std::size_t m = kernel.surface.size();
    EXPECT_EQ(kernel.surface.components, 3);
    ASSERT_EQ(kernel.surface.shape.size(), m * 3 * 2);
    for (std::size_t i = 0; i < m; ++i) {
      const Point u = gradient * centroid(&kernel.surface.node[3 * i], 0.5 / order) + offset;
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(kernel.surface.shape[(3 * i + c) * 2], u[static_cast<int>(c)], placed);
        EXPECT_NEAR(kernel.surface.shape[(3 * i + c) * 2 + 1], -2 * u[static_cast<int>(c)], placed);
      }
    }
    EXPECT_TRUE(kernel.surface.residual_flexibility.empty());
    EXPECT_FALSE(kernel.view.has_value());
  }
}

TEST(Trace, of_a_rigid_mode_is_its_value_at_the_point_from_which_gaps_are_measured) {
  const Point turn(0.3, -0.7, 0.2);
  for (const bool one_direction : {false, true}) {
    surface::PatchOptions options;
    if (one_direction) options.direction = Vector3{0.6, 0, -0.8};
    const Body body(test::block_geo("hex", 2, 0), 2, {"top", "sides"}, options);
    modes::ModeSet set = body.linear_fields();
    for (std::size_t i = 0; i < body.mesh.node.size(); ++i)
      if (const std::int64_t local = body.mesh.owned(body.mesh.node[i]); local >= 0)
        set.shape.block<3, 1>(3 * local, 0) =
            turn.cross(Eigen::Map<const Point>(&body.mesh.position[3 * i])) + offset;
    kernels::Kernel kernel;
    kernel.modes.angular_frequency = {0, 1};
    kernel.centre = body.matrices.centre;
    kernel.inertia = body.matrices.inertia;
    surface::trace(test::one_team(), body.mesh, body.matrices, *body.factor, set, body.patches,
                   surface::patch_loads(body.mesh, body.patches), surface::Correction::none, false, kernel,
                   surface::make_sources(body.mesh, {}));
    const kernels::Surface& geometry = kernel.surface;
    int moved = 0;
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const Point at(&geometry.centroid[3 * i]), u = turn.cross(at) + offset;
      moved += at[2] > 1 - placed && std::min(at[0], 1 - at[0]) < placed;
      if (one_direction) {
        EXPECT_NEAR(geometry.shape[2 * i], 0.6 * u[0] - 0.8 * u[2], placed);
        continue;
      }
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(geometry.shape[2 * (3 * i + c)], u[static_cast<int>(c)], placed);
    }
    EXPECT_EQ(moved, 10);  // on two edges, where the mean lies inside
  }
}

TEST(Trace, along_a_direction_is_only_that_component) {
  const Vector3 direction{0.6, 0, -0.8};
  const Body body(test::block_geo("hex", 2, 0), 2, {"top"}, {.direction = direction});
  const kernels::Kernel kernel = body.trace(body.linear_fields(), false, false);
  EXPECT_EQ(kernel.surface.components, 1);
  EXPECT_EQ(kernel.surface.direction, direction);
  ASSERT_EQ(kernel.surface.shape.size(), kernel.surface.size() * 2);
  for (std::size_t i = 0; i < kernel.surface.size(); ++i) {
    const Point u = gradient * centroid(&kernel.surface.node[3 * i], 0.25) + offset;
    EXPECT_NEAR(kernel.surface.shape[2 * i], 0.6 * u[0] - 0.8 * u[2], placed);
  }
}

TEST(Trace, of_loads_is_momentum_and_angular_momentum_of_the_field) {
  const Body body(test::block_geo("hex", 2, 0), 2, {"top"}, {});
  const kernels::Kernel kernel = body.trace(body.linear_fields(), false, false);
  // ρ ∫ u dV and ρ ∫ x × u dV over the unit cube with ρ = 2; ∫ x_i x_j = ¼, and ⅓ on the diagonal.
  const Point middle(0.5, 0.5, 0.5), momentum = 2 * (gradient * middle + offset);
  const Eigen::Matrix3d second =
      Eigen::Matrix3d::Constant(0.25) + Eigen::Matrix3d(Point::Constant(1.0 / 3 - 0.25).asDiagonal());
  const Eigen::Matrix3d moved =
      2 * (second * gradient.transpose() + middle * offset.transpose());  // ρ ∫ x uᵀ
  const Point angular(moved(1, 2) - moved(2, 1), moved(2, 0) - moved(0, 2), moved(0, 1) - moved(1, 0));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(kernel.loads.body_force[2 * c], momentum[static_cast<int>(c)], 1e-13);
    EXPECT_NEAR(kernel.loads.rotation[2 * c], angular[static_cast<int>(c)], 1e-13);
  }
}

TEST(Trace, keeps_the_visualisation_surface_on_rank_0) {
  const Body body(test::block_geo("hex", 2, 0), 2, {"top"}, {});
  const kernels::Kernel kernel = body.trace(body.linear_fields(), false, true);
  ASSERT_EQ(kernel.view.has_value(), parallel::rank_of(PETSC_COMM_WORLD) == 0);
  if (!kernel.view) return;
  const kernels::View& view = *kernel.view;
  EXPECT_EQ(view.node.size(), 3U * (125 - 27));  // all of the 5³ nodes except the inner ones
  EXPECT_EQ(view.element.size(), 3U * 6 * 16 * 2);
  ASSERT_EQ(view.shape.size(), view.node.size() * 2);
  for (std::size_t v = 0; v < view.node.size() / 3; ++v) {
    const Point u = gradient * Point(&view.node[3 * v]) + offset;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(view.shape[(3 * v + c) * 2], u[static_cast<int>(c)], 2e-7);  // single precision
  }
}

TEST(PatchLoads, are_unit_forces_that_supports_do_not_carry) {
  const Body body(test::block_geo("hex", 2, 0), 1, {"top"}, {}, {{"sides", "x"}});
  const Eigen::MatrixXd loads = surface::patch_loads(body.mesh, body.patches);
  const auto& geometry = body.patches.geometry;
  ASSERT_EQ(loads.cols(), static_cast<Eigen::Index>(3 * geometry.size()));
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, loads.cols());
  for (Eigen::Index r = 0; r < loads.rows(); ++r) force.row(r % 3) += loads.row(r);
  parallel::sum(PETSC_COMM_WORLD, force);
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    // Only the middle node is free along x. In each direction it carries 2/3 of a hat, or 1/3 at an edge: the
    // rows (1, 4, 1)/6 and (2, 1)/6 of a linear mass matrix, divided by their sums.
    double share = 1;
    for (int d = 0; d < 2; ++d)
      share *= std::abs(geometry.node[3 * i + static_cast<std::size_t>(d)] - 0.5) < 0.1 ? 2.0 / 3 : 1.0 / 3;
    const Eigen::Matrix3d each = force.middleCols<3>(static_cast<Eigen::Index>(3 * i));
    EXPECT_NEAR((each - Eigen::Matrix3d(Point(share, 1, 1).asDiagonal())).norm(), 0, placed);
  }
}

TEST(ResidualFlexibility, and_modes_of_a_clamped_rod_add_to_its_static_flexibility) {
  // Linear elements are exact at nodes: u(L) = L/(EA) under a unit force, for any number of modes.
  const double exact = 2.0 / (3.0 * 0.5);
  for (std::int64_t count : {1, 4}) {
    const Body rod(test::rod_geo(20), 1, {"right"}, {}, {{"left", "x"}});
    const modes::ModeSet set =
        modes::compute_modes(test::one_team(), rod.mesh, rod.matrices, *rod.factor, {.count = count});
    const kernels::Kernel kernel = rod.trace(set, true, true);
    ASSERT_EQ(kernel.surface.size(), 1U);
    EXPECT_EQ(kernel.surface.area[0], 0.5);
    EXPECT_EQ(kernel.surface.element_corners, 1);
    // A rod moves only along x, so the other components are zero.
    const auto n = static_cast<std::size_t>(count);
    double flexibility = kernel.surface.residual_flexibility[0],
           gravity = kernel.loads.body_force_residual[0];
    for (std::size_t k = 0; k < n; ++k) {
      const double omega = set.angular_frequency[k], phi = kernel.surface.shape[k];
      flexibility += phi * phi / (omega * omega);
      gravity += phi * kernel.loads.body_force[k] / (omega * omega);
      EXPECT_EQ(kernel.surface.shape[n + k], 0);
    }
    EXPECT_NEAR(flexibility, exact, 1e-9 * exact);
    // Under its own weight: u(L) = ρ L²/(2E) per unit of acceleration.
    EXPECT_NEAR(gravity, 2.0 * 4.0 / (2 * 3.0), 1e-9);
    for (std::size_t k = 1; k < 9; ++k) EXPECT_EQ(kernel.surface.residual_flexibility[k], 0);

    // Along the rod, u(x) = x/(EA) under the force and ρ/E (L x − x²/2) under the weight.
    if (!kernel.view) continue;  // the view is on another rank
    const kernels::View& view = *kernel.view;
    ASSERT_EQ(view.node.size(), 3U * 21);
    for (std::size_t v = 0; v < 21; ++v) {
      const double x = view.node[3 * v];
      double pulled = view.residual_flexibility[9 * v], hanging = view.body_force_residual[9 * v];
      for (std::size_t k = 0; k < n; ++k) {
        const double seen = view.shape[3 * v * n + k] / std::pow(set.angular_frequency[k], 2);
        pulled += seen * kernel.surface.shape[k];
        hanging += seen * kernel.loads.body_force[k];
      }
      EXPECT_NEAR(pulled, x / (3.0 * 0.5), 2e-6);  // single precision, and the tolerance 1e-6 of the field
      EXPECT_NEAR(hanging, 2.0 / 3.0 * (2 * x - x * x / 2), 2e-6);
      for (std::size_t k = 1; k < 9; ++k) EXPECT_EQ(view.residual_flexibility[9 * v + k], 0);
    }
  }
}

TEST(ResidualFlexibility, is_symmetric_and_semidefinite_on_a_free_body) {
  const Body body(test::block_geo("tet", 2, 0.3), 2, {"top"},
                  {.direction = Vector3{0, 0, 1}, .spacing = 0.3});
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), body.mesh, body.matrices, *body.factor, {.count = 10});
  const kernels::Kernel kernel = body.trace(set, true, false);
  const auto m = static_cast<Eigen::Index>(kernel.surface.size());
  const Eigen::Map<const Eigen::MatrixXd> R(kernel.surface.residual_flexibility.data(), m, m);
  EXPECT_EQ((R - R.transpose()).cwiseAbs().maxCoeff(), 0);
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R).eigenvalues();
  EXPECT_GT(values[0], -1e-10 * values[m - 1]);
  EXPECT_GT(values[m - 1], 0);
}

}  // namespace trace_test
}  // namespace ricochet
