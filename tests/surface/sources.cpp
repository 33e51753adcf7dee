// SPDX-License-Identifier: BSD-2-Clause
// Tractions, point forces and receivers on the mesh, and moving supports of a
// complete body, compared with closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "src/mesh/faces.hpp"
#include "src/scene/request.hpp"
#include "src/surface/gauges.hpp"
#include "tests/support.hpp"
#include "tests/surface/made.hpp"

namespace ricochet {
namespace sources_test {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

constexpr double placed = 1e-11;  // gmsh divides a line evenly to about 2e-12

// 26 of the 3³ corners are on the boundary, and 98 of the 5³ nodes.
TEST(VisualisationSurface, by_corners_has_the_places_and_stresses_of_these_nodes) {
  Made made(test::block_geo("hex", 2, 0.4), 2, request_of({"top"}, {}));
  const auto places = [&] {
    std::vector<double> of = made.mesh.visualisation.position;
    parallel::broadcast(made.mesh.comm, of);
    return rows(of, of.size() / 3);
  };
  // (6, nodes) the share of this rank in the stress of a field that varies from node to node.
  const auto stress = [&] {
    reduction::Rows rows;
    rows.of_gradient = surface::surface_stress(made.mesh, made.request.body.materials);
    const MatrixXd of = rows.gradient_times(MatrixXd::NullaryExpr(
        made.matrices.local_rows, 1, [](Eigen::Index i) { return std::sin(static_cast<double>(i)); }));
    MatrixXd out = MatrixXd::Zero(6, 98);
    for (std::size_t p = 0; p < rows.of_gradient.point.size(); ++p)
      out.col(static_cast<Eigen::Index>(rows.of_gradient.point[p])) =
          of.middleRows(6 * static_cast<Eigen::Index>(p), 6);
    return out;
  };
  const MatrixXd before = places(), seen = stress();
  const mesh::FacetMesh fine = made.mesh.visualisation;
  if (parallel::rank_of(made.mesh.comm) == 0) mesh::keep_corners(made.mesh.visualisation);
  const MatrixXd after = places(), kept = stress();
  ASSERT_EQ(before.rows(), 98);
  ASSERT_EQ(after.rows(), 26);
  ASSERT_GT(seen.norm(), 0);
  for (Eigen::Index v = 0; v < after.rows(); ++v) {
    Eigen::Index was = 0;
    EXPECT_EQ((before.rowwise() - after.row(v)).rowwise().norm().minCoeff(&was), 0);
    EXPECT_EQ(kept.col(v), seen.col(was)) << v;
  }
  if (parallel::rank_of(made.mesh.comm) != 0) return;
  const mesh::FacetMesh& coarse = made.mesh.visualisation;
  ASSERT_EQ(coarse.blocks.size(), 1U);
  EXPECT_EQ(coarse.blocks.front().size(), 6U * 4 * 2);
  const auto& wanted = fine.blocks.back().node;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    EXPECT_EQ(coarse.node[static_cast<std::size_t>(coarse.blocks.front().node[k])],
              fine.node[static_cast<std::size_t>(wanted[k])]);
}

// A surface may be both loaded and touched, and a group may carry two tractions.
TEST(Traction, of_a_surface_is_its_area_times_the_vector) {
  for (const char* kind : {"tet", "hex", "prism"}) {
    scene::KernelRequest request = request_of({"top"}, {});
    request.loads.tractions = {load("push", "top"), load("sides", "sides"), load("again", "top")};
    const double lean = 0.4, width = 1 - lean, area = width * width;
    Made made(std::string(kind) == "prism" ? test::prism_geo(2) : test::block_geo(kind, 2, lean), 2, request);
    const bool leans = std::string(kind) != "prism";
    const double top = leans ? area : 1, slope = leans ? std::hypot(1, lean / 2) : 1,
                 sides = 4 * slope * (leans ? (1 + width) / 2 : 1);
    const auto& loads = made.sources.loads;
    ASSERT_EQ(loads.size(), 3U);
    EXPECT_EQ(loads[0].unit, "Pa");
    EXPECT_LT((rows(loads[0].total, 3) - top * Matrix3d::Identity()).norm(), placed) << kind;
    EXPECT_LT((rows(loads[1].total, 3) - sides * Matrix3d::Identity()).norm(), placed) << kind;
    EXPECT_EQ(loads[2].total, loads[0].total);
    // Σ x × f about the origin. The centre of the surface is (½, ½, 1).
    const Point centre(0.5, 0.5, 1);
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((rows(loads[0].moment, 3).col(k) - top * centre.cross(Point::Unit(k))).norm(), placed);
    // ∫ u ds of a linear field.
    modes::Factorisation factor(made.matrices.stiffness, made.matrices.mass);
    kernels::Kernel kernel;
    surface::trace(test::one_team(), made.mesh, made.matrices, factor, made.linear_fields(), made.patches,
                   surface::patch_loads(made.mesh, made.patches), surface::Correction::none, false, kernel,
                   made.sources);
    const MatrixXd part = rows(kernel.applied[0].participation, 3);
    const Point exact = top * (gradient * centre + offset);
    EXPECT_LT((part.col(0) - exact).norm(), placed) << kind;
    EXPECT_LT((part.col(1) + 2 * exact).norm(), placed) << kind;
    EXPECT_TRUE(kernel.applied[0].residual.empty());
  }
}

TEST(Receiver, of_a_linear_field_is_its_value_at_any_position) {
  for (const char* kind : {"tet", "hex", "prism"})
    for (int order : {1, 2, 3}) {
      scene::KernelRequest request = request_of({"top"}, {});
      // Receivers inside, at a corner, on an edge, on an inclined face, and slightly outside.
      const Vector3 places[] = {
          {0.41, 0.53, 0.37}, {0, 0, 0}, {0.5, 0, 0}, {0.1, 0.5, 0.5}, {0.3, 0.6, 1 + 1e-7}};
      for (const Vector3& at : places) request.receivers.push_back(receiver("mic", at));
      request.loads.points = {load("tap", "", places[0])};
      if (order == 3 && kind == std::string("hex")) continue;  // searches in its elements take long
      const int divisions = order < 3 ? 2 : 1;
      Made made(
          std::string(kind) == "prism" ? test::prism_geo(divisions) : test::block_geo(kind, divisions, 0.4),
          order, request);
      modes::Factorisation factor(made.matrices.stiffness, made.matrices.mass);
      kernels::Kernel kernel;
      surface::trace(test::one_team(), made.mesh, made.matrices, factor, made.linear_fields(), made.patches,
                     surface::patch_loads(made.mesh, made.patches), surface::Correction::none, false, kernel,
                     made.sources);
      ASSERT_EQ(kernel.receivers.size(), 5U);
      for (std::size_t r = 0; r < 5; ++r) {
        const Point exact = gradient * Point(places[r].data()) + offset;
        EXPECT_LT((rows(kernel.receivers[r].shape, 3).col(0) - exact).norm(), r == 4 ? 2e-7 : placed)
            << kind << order << " " << r;
      }
      EXPECT_EQ(kernel.applied[0].unit, "N");
      const Point exact = gradient * Point(places[0].data()) + offset;
      EXPECT_LT((rows(kernel.applied[0].participation, 3).col(0) - exact).norm(), placed);
      EXPECT_LT((rows(kernel.applied[0].total, 3) - Matrix3d::Identity()).norm(), 1e-14);
      for (int k = 0; k < 3; ++k)
        EXPECT_LT(
            (rows(kernel.applied[0].moment, 3).col(k) - Point(places[0].data()).cross(Point::Unit(k))).norm(),
            placed);
    }
}

TEST(Receiver, off_the_body_is_refused_with_its_distance_and_the_nearest_point) {
  scene::KernelRequest request = request_of({"top"}, {});
  request.receivers = {receiver("mic", {0.25, 0.5, 1.5})};
  const std::string said = test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 2, request); });
  EXPECT_THAT(said, AllOf(HasSubstr("output.receiver \"mic\" lies 0.5 m off bodies.body"),
                          HasSubstr("nearest point, at = [0.25, 0.5, 1]")));
  // Coordinates that are zero up to round-off are given as 0.
  request.receivers = {receiver("mic", {-0.5, 0.5, -0.25})};
  for (const char* kind : {"hex", "tet"})
    EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo(kind, 2, 0), 2, request); }),
                AllOf(HasSubstr("at = [-0.5, 0.5, -0.25]"), HasSubstr("nearest point, at = [0, 0.5, 0]")));
  // Within 1e-6 of the size of the body, √3, it is on the body.
  request.receivers = {receiver("mic", {0.25, 0.5, 1 + 1.8e-6})};
  EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 1, request); }),
              HasSubstr("lies 1.8e-06 m off"));
  request.receivers = {receiver("mic", {0.25, 0.5, 1 + 1.7e-6})};
  EXPECT_NO_THROW(Made(test::block_geo("hex", 2, 0), 1, request));
  request.receivers.clear();
  request.loads.points = {load("tap", "", {1 + 1e-4, 0.5, 0.5})};
  EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo("tet", 2, 0), 2, request); }),
              HasSubstr("loads.point \"tap\" lies 0.0001 m off"));
}

/// The three numbers after the last "[".
Vector3 last_point(const std::string& said) {
  Vector3 point{};
  std::istringstream numbers(said.substr(said.rfind('[') + 1));
  char comma{};
  numbers >> point[0] >> comma >> point[1] >> comma >> point[2];
  return point;
}

// Rotated by 90 degrees about x and then z, the x, y, z axes of the body are the y, z, x axes of the world.
TEST(Receiver, off_the_body_is_corrected_in_the_axes_of_its_key) {
  scene::KernelRequest request = request_of({"top"}, {});
  request.body.rotate_deg = {90, 0, 90};
  request.body.translate = {10, 20, 30};
  request.receivers = {receiver("mic", {1.0 / 3, 0.5, 1.5})};  // in the axes of the body
  const auto said = [&](Axes axes) {
    request.receivers[0].at_axes = axes;
    return test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 1, request); });
  };
  EXPECT_THAT(said(Axes::world), AllOf(HasSubstr("off bodies.body, at = [11.5, 20.3333333, 30.5]: move"),
                                       HasSubstr("nearest point, at = [11, 20.3333333, 30.5]")));
  EXPECT_THAT(said(Axes::body), AllOf(HasSubstr("off bodies.body, at_body = [0.3333333, 0.5, 1.5]: move"),
                                      HasSubstr("nearest point, at_body = [0.3333333, 0.5, 1]")));
}

// The body leans, so that no digits are exact.
TEST(Receiver, off_the_body_is_on_it_where_the_message_puts_it) {
  scene::KernelRequest request = request_of({"top"}, {});
  request.body.rotate_deg = {11, -23, 37};
  request.body.translate = {123.456, -0.1, 1e-3};
  for (const Axes axes : {Axes::world, Axes::body}) {
    request.receivers = {receiver("mic", {1.01, 0.4, 0.9})};
    request.receivers[0].at_axes = axes;
    const Vector3 point =
        last_point(test::complaint_of([&] { Made(test::block_geo("tet", 2, 0.4), 1, request); }));
    request.receivers[0].at = axes == Axes::world ? point_in_body(request.body, point) : point;
    EXPECT_NO_THROW(Made(test::block_geo("tet", 2, 0.4), 1, request));
  }
}

TEST(Receiver, in_the_unit_of_a_drawing_is_named_in_metres) {
  scene::KernelRequest request = request_of({"top"}, {});
  request.body.scale = 1e-3;
  request.receivers = {receiver("mic", {0.25, 0.5, 1})};
  request.receivers[0].at_axes = Axes::body;
  EXPECT_THAT(
      test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 1, request); }),
      HasSubstr("points are in metres, after scale = 0.001: write at_body = [0.00025, 0.0005, 0.001]"));
  request.receivers[0].at = {0.25e-3, 0.5e-3, 1.2e-3};  // hardly off; times the scale, it is in the body, too
  EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 1, request); }),
              HasSubstr("move it to the nearest point, at_body = [0.00025, 0.0005, 0.001]"));
}

// Elements of order 3 approximate the area of the unit sphere to about 4e-4, and flat ones to a few per cent.
TEST(Traction, of_a_curved_surface_has_its_area_and_no_moment_about_its_centre) {
  scene::KernelRequest request = request_of({"skin"}, {});
  request.loads.tractions = {load("push", "skin")};
  const Made made(
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0.3, -0.2, 0.5, 1};\nMeshSize{:} = 0.6;\n"
      "Physical Volume(\"body\") = {1};\nPhysical Surface(\"skin\") = {1};\n",
      3, request);
  const double area = 4 * std::numbers::pi;
  const kernels::Load& push = made.sources.loads[0];
  EXPECT_LT((rows(push.total, 3) - area * Matrix3d::Identity()).norm(), 1e-3 * area);
  for (int k = 0; k < 3; ++k)
    EXPECT_LT((rows(push.moment, 3).col(k) - area * Point(0.3, -0.2, 0.5).cross(Point::Unit(k))).norm(),
              1e-3 * area);
}

// Pressure has no resultant on a closed surface. By the divergence theorem, its virial Σ f·x is −3pV: that of
// the faceted volume, which differs from the ball by less than the area does.
TEST(Pressure, on_a_ball_has_no_resultant_and_the_virial_of_its_volume) {
  scene::KernelRequest request = request_of({"skin"}, {});
  request.loads.tractions = {load("push", "skin")};
  request.loads.tractions[0].pressure = 0;
  const Made made(
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0.3, -0.2, 0.5, 1};\nMeshSize{:} = 0.6;\n"
      "Physical Volume(\"body\") = {1};\nPhysical Surface(\"skin\") = {1};\n",
      3, request);
  const double volume = 4.0 / 3 * std::numbers::pi;
  const kernels::Load& push = made.sources.loads[0];
  EXPECT_TRUE(push.inward);
  const Point together = Point::Ones();  // the pressure 1
  EXPECT_LT((rows(push.total, 3) * together).norm(), 1e-12);
  EXPECT_LT((rows(push.moment, 3) * together).norm(), 1e-12);
  Eigen::VectorXd virial = Eigen::VectorXd::Zero(1);
  const Eigen::VectorXd force = made.sources.load * together;
  for (std::size_t node = 0; node < made.mesh.node.size(); ++node)
    if (const std::int64_t row = made.mesh.owned(made.mesh.node[node]); row >= 0)
      virial[0] += force.segment<3>(3 * row).dot(Point(&made.mesh.position[3 * node]));
  parallel::sum(made.mesh.comm, virial);
  EXPECT_NEAR(virial[0], -3 * volume, 1e-3 * 3 * volume);
}

// A rod moves only along its axis, (1, 2, 2)/3, and so acts a load.
TEST(Loads, of_an_inclined_rod_act_along_its_axis) {
  scene::KernelRequest request = request_of({"right"}, {});
  request.loads.tractions = {load("pull", "right")};
  request.loads.points = {load("tap", "", {1.5, 2, 2})};
  request.receivers = {receiver("mic", {1.5, 2, 2})};
  for (const int order : {1, 2}) {
    const Made made(
        "Point(1) = {1,1,1};\nPoint(2) = {2,3,3};\nLine(1) = {1,2};\nTransfinite Curve{1} = 4;\n"
        "Physical Curve(\"rod\") = {1};\nPhysical Point(\"right\") = {2};\n",
        order, request);
    const Point axis = Point(1, 2, 2) / 3, end(2, 3, 3), tapped(1.5, 2, 2);
    const Matrix3d along = axis * axis.transpose();
    const auto& loads = made.sources.loads;
    EXPECT_LT((rows(loads[0].total, 3) - 0.5 * along).norm(), placed);  // of its cross-section 0.5
    EXPECT_LT((rows(loads[1].total, 3) - along).norm(), placed);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((rows(loads[0].moment, 3).col(k) - 0.5 * end.cross(Point(along.col(k)))).norm(), placed);
      EXPECT_LT((rows(loads[1].moment, 3).col(k) - tapped.cross(Point(along.col(k)))).norm(), placed);
    }
    // Each unit vector acts with its part along the axis.
    MatrixXd sum = made.sources.load.colwise().sum();
    parallel::sum(PETSC_COMM_WORLD, sum);
    EXPECT_LT((sum.leftCols(3) - 0.5 * axis.transpose()).norm(), placed);
    EXPECT_LT((sum.rightCols(3) - axis.transpose()).norm(), placed);
    EXPECT_LT((Point(made.sources.receivers[0].point.data()) - tapped).norm(), placed);
  }
}

TEST(Traction, on_a_missing_surface_is_refused_with_the_available_ones) {
  scene::KernelRequest request = request_of({"top"}, {});
  request.loads.tractions = {load("push", "rim")};
  EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo("hex", 1, 0), 1, request); }),
              AllOf(HasSubstr("no physical surface \"rim\""), HasSubstr("change loads.traction.group")));
}

/// A column without lateral contraction, clamped at z = 0. Tension, weight and the lift are
/// polynomials that its elements represent exactly.
class Column : public testing::TestWithParam<bool> {
 protected:
  static constexpr double young = 3, density = 2;
  /// The kernel of modes or of vectors fitted to contact, computed once for all tests.
  static const kernels::Kernel& kernel(bool fitted) {
    static std::map<bool, kernels::Kernel> known;
    if (!known.contains(fitted)) {
      Made made(test::block_geo("hex", 2, 0), 2, request(), 0);
      known[fitted] = fitted ? made.fitted_kernel(Hertz{0.5}) : made.kernel({.count = 25});
    }
    return known[fitted];
  }
  static scene::KernelRequest request() {
    scene::KernelRequest request = request_of({"top"}, {{"bottom", "xyz"}});
    request.loads.tractions = {load("pull", "top")};
    request.loads.points = {load("tap", "", {0.5, 0.5, 1})};
    request.loads.motions = {load("shaker", "bottom")};
    request.receivers = {receiver("low", {0.3, 0.6, 0.25}), receiver("foot", {0.5, 0.5, 0})};
    return request;
  }
  const kernels::Kernel& kernel_ = kernel(GetParam());
};
INSTANTIATE_TEST_SUITE_P(ModesAndVectors, Column, testing::Bool(),
                         [](const auto& it) { return it.param ? "vectors" : "modes"; });

TEST_P(Column, under_tension_stretches_evenly_when_modes_and_residual_add) {
  const kernels::Load& pull = kernel_.applied[0];
  const MatrixXd part = rows(pull.participation, 3);
  const MatrixXd top =
      modal(kernel_, shape_of(kernel_), part) + rows(pull.residual, 3 * kernel_.surface.size());
  for (std::size_t i = 0; i < kernel_.surface.size(); ++i)
    EXPECT_LT((top.block<3, 1>(static_cast<Eigen::Index>(3 * i), 2) - Point(0, 0, 1 / young)).norm(), 1e-9);
  const kernels::Receiver &low = kernel_.receivers[0], &foot = kernel_.receivers[1];
  const MatrixXd there = modal(kernel_, rows(low.shape, 3), part) + rows(low.load_residual, 3).leftCols(3);
  EXPECT_LT((there.col(2) - Point(0, 0, 0.25 / young)).norm(), 1e-9);
  const MatrixXd fixed = modal(kernel_, rows(foot.shape, 3), part) + rows(foot.load_residual, 3).leftCols(3);
  EXPECT_LT(fixed.norm(), 1e-12);
}

TEST_P(Column, under_its_weight_is_compressed_by_what_stands_above) {
  const kernels::Receiver& low = kernel_.receivers[0];
  const MatrixXd sunk = modal(kernel_, rows(low.shape, 3), rows(kernel_.loads.body_force, 3)) +
                        rows(low.body_force_residual, 3);
  const double z = 0.25;
  EXPECT_LT((sunk.col(2) - Point(0, 0, density / young * (z - z * z / 2))).norm(), 1e-9);
}

TEST_P(Column, is_reciprocal_to_a_receiver) {
  // Reciprocity with a force that is distributed evenly over the top: over all
  // patches in proportion to their areas.
  const kernels::Receiver& low = kernel_.receivers[0];
  const MatrixXd all =
      modal(kernel_, rows(low.shape, 3), shape_of(kernel_)) + rows(low.residual_flexibility, 3);
  Point sum = Point::Zero();
  for (std::size_t i = 0; i < kernel_.surface.size(); ++i)
    sum += kernel_.surface.area[i] * all.col(static_cast<Eigen::Index>(3 * i + 2));
  EXPECT_LT((sum - Point(0, 0, 0.25 / young)).norm(), 1e-9);
}

TEST_P(Column, follows_its_only_moving_support_as_a_rigid_body) {
  const kernels::Motion& shaker = kernel_.motions[0];
  const MatrixXd gamma = rows(shaker.participation, 3), shape = shape_of(kernel_);
  // Ψ = I, so Γ equals the modal gravity load, and Ψ = (Ψ − ΦΓ) + ΦΓ.
  EXPECT_LT((gamma - rows(kernel_.loads.body_force, 3)).norm(), 1e-9);
  const MatrixXd top = shape * gamma.transpose() + rows(shaker.residual, 3 * kernel_.surface.size());
  for (std::size_t i = 0; i < kernel_.surface.size(); ++i)
    EXPECT_LT((top.middleRows(static_cast<Eigen::Index>(3 * i), 3) - Matrix3d::Identity()).norm(), 1e-9);
  for (const kernels::Receiver& receiver : kernel_.receivers)
    EXPECT_LT((rows(receiver.shape, 3) * gamma.transpose() + rows(receiver.motion_residual, 3) -
               Matrix3d::Identity())
                  .norm(),
              1e-9);
  // The mass is 2.
  const MatrixXd momentum = rows(kernel_.loads.body_force, 3) * gamma.transpose() + rows(shaker.momentum, 3);
  EXPECT_LT((momentum - density * Matrix3d::Identity()).norm(), 1e-9);
}

}  // namespace sources_test
}  // namespace ricochet
