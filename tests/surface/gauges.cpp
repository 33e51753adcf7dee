// SPDX-License-Identifier: BSD-2-Clause
// Stress and strain at gauges, of displacements that are given at the nodes, compared with their exact
// derivatives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support.hpp"
#include "tests/surface/made.hpp"

namespace ricochet {
namespace gauges_test {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using Field = std::function<Point(const Point&)>;
using Slopes = std::function<Matrix3d(const Point&)>;

const Vector3 places[] = {{0.41, 0.53, 0.37}, {0, 0, 0}, {0.5, 0, 0}, {0.1, 0.5, 0.5}, {0.3, 0.6, 1}};
const Vector3 along{2.0 / 3, -1.0 / 3, 2.0 / 3};

/// σ = E/(1 + ν) (ε + ν/(1 − 2ν) tr ε I) in the order of a gauge.
Eigen::VectorXd stress(const Matrix3d& slopes, double young, double poisson) {
  const Matrix3d strain = (slopes + slopes.transpose()) / 2;
  const Matrix3d s =
      young / (1 + poisson) * (strain + poisson / (1 - 2 * poisson) * strain.trace() * Matrix3d::Identity());
  return (Eigen::VectorXd(6) << s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(0, 2), s(0, 1)).finished();
}

scene::KernelRequest with_gauges(double length = 0) {
  scene::KernelRequest request = request_of({"top"}, {});
  for (const Vector3& at : places)
    request.gauges.push_back({.name = "g", .body = "body", .at = at, .direction = along, .length = length});
  return request;
}

/// The kernel whose first mode has this displacement at the nodes.
kernels::Kernel kernel_of(Made& made, const Field& field) {
  modes::ModeSet set = made.linear_fields();
  for (std::size_t i = 0; i < made.mesh.node.size(); ++i)
    if (const std::int64_t own = made.mesh.owned(made.mesh.node[i]); own >= 0)
      set.shape.block<3, 1>(3 * own, 0) = field(Point(&made.mesh.position[3 * i]));
  modes::Factorisation factor(made.matrices.stiffness, made.matrices.mass);
  kernels::Kernel kernel;
  surface::trace(test::one_team(), made.mesh, made.matrices, factor, set, made.patches,
                 surface::patch_loads(made.mesh, made.patches), surface::Correction::none, false, kernel,
                 made.sources);
  return kernel;
}

/// Largest error of stress and strain at the places, relative to the largest stress and to 1.
double error_of(Made& made, const Field& field, const Slopes& slopes) {
  const kernels::Kernel kernel = kernel_of(made, field);
  const scene::Material& material = made.request.body.materials[0];
  double error = 0, largest = 0;
  for (std::size_t g = 0; g < std::size(places); ++g) {
    const Matrix3d at = slopes(Point(places[g].data()));
    const Eigen::VectorXd exact = stress(at, material.young, material.poisson),
                          found = rows(kernel.gauges[g].stress.shape, 6).col(0);
    largest = std::max(largest, exact.cwiseAbs().maxCoeff());
    error = std::max(error, (found - exact).cwiseAbs().maxCoeff());
  }
  return error / largest;
}

// Every element and order: the patch test, inside, at a corner, on an edge, on an inclined face and on top.
TEST(Gauge, of_a_linear_field_has_its_exact_stress_and_strain_everywhere) {
  for (const char* kind : {"tet", "hex", "prism"})
    for (const int order : {1, 2}) {
      const bool prism = std::string(kind) == "prism";
      Made made(prism ? test::prism_geo(2) : test::block_geo(kind, 2, 0.4), order, with_gauges());
      const Field field = [](const Point& x) -> Point { return gradient * x + offset; };
      // Round-off of coordinates, 2e-12, over elements of ¼.
      EXPECT_LT(error_of(made, field, [](const Point&) { return gradient; }), 1e-10) << kind << order;
      const kernels::Kernel kernel = kernel_of(made, field);
      const Point d(along.data());
      for (const kernels::Gauge& gauge : kernel.gauges)
        EXPECT_NEAR(gauge.strain->shape[0], d.dot(gradient * d), 1e-10) << kind << order;
    }
}

/// Stress in the order of a gauge by C and the strain, both along axes, the columns of a rotation.
Eigen::VectorXd stress_along(const Eigen::Matrix<double, 6, 6>& C, const Matrix3d& axes,
                             const Matrix3d& slopes) {
  const Matrix3d e = axes.transpose() * (slopes + slopes.transpose()) * axes;  // 2 ε
  const Eigen::VectorXd own =
      C * Eigen::Vector<double, 6>(e(0, 0) / 2, e(1, 1) / 2, e(2, 2) / 2, e(1, 2), e(0, 2), e(0, 1));
  const Matrix3d s =
      axes *
      (Matrix3d() << own[0], own[5], own[4], own[5], own[1], own[3], own[4], own[3], own[2]).finished() *
      axes.transpose();
  return (Eigen::VectorXd(6) << s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(0, 2), s(0, 1)).finished();
}

// A uniform strain of a body without symmetry: in axes of the body, and about a line through it.
TEST(Gauge, of_an_anisotropic_body_has_the_stress_of_its_law_in_its_axes_at_the_point) {
  std::array<double, 21> upper{7,  3.4,  3.1, 0.5, -0.2, -0.1, 18,   0.6, -0.4, -0.8, -0.6,
                               18, -0.9, 0.7, -1,  2.5,  -0.2, -0.7, 2.7, 0.1,  3.4};
  Eigen::Matrix<double, 6, 6> C;
  auto next = upper.begin();
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) C(i, j) = C(j, i) = *next++;
  const Point along = Point(1, 2, 2) / 3, through(0.2, 0.9, 0.4);
  for (const bool about : {false, true}) {
    scene::KernelRequest request = with_gauges();
    scene::Material& material =
        request.body.materials.emplace_back(scene::Material{.group = "", .density = 2});
    material.stiffness = upper;
    if (about)
      material.about =
          scene::CentreLine{{through[0], through[1], through[2]}, {along[0], along[1], along[2]}};
    else
      material.axes = {{{0, 1, 0}, {0, 0, 1}}};
    Made made(test::block_geo("hex", 2, 0.4), 1, request);
    const kernels::Kernel kernel =
        kernel_of(made, [](const Point& x) -> Point { return gradient * x + offset; });
    for (std::size_t g = 0; g < std::size(places); ++g) {
      Matrix3d axes = (Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
      if (about) {
        const Point from = Point(places[g].data()) - through;
        axes.col(0) = (from - along.dot(from) * along).normalized();
        axes.col(1) = along.cross(axes.col(0));
        axes.col(2) = along;
      }
      const Eigen::VectorXd exact = stress_along(C, axes, gradient);
      EXPECT_LT((rows(kernel.gauges[g].stress.shape, 6).col(0) - exact).cwiseAbs().maxCoeff(),
                1e-10 * exact.cwiseAbs().maxCoeff())
          << about << g;
    }
  }
}

// Polynomials of degree p + 1 through the nodes: one more than elements of order p hold.
TEST(Gauge, of_a_field_of_one_degree_more_than_the_elements_is_exact) {
  for (const int order : {1, 2})
    for (const char* kind : {"tet", "hex"}) {
      const double cubic = order == 2 ? 1 : 0;
      const Field field = [&](const Point& x) -> Point {
        return {x[0] * x[1] - x[2] * x[2] + cubic * x[0] * x[1] * x[2], 0.5 * x[1] * x[1] + x[0] * x[2],
                x[2] * x[0] - 0.3 * x[1] * x[0] + cubic * x[2] * x[2] * x[2]};
      };
      const Slopes slopes = [&](const Point& x) -> Matrix3d {
        return (Matrix3d() << x[1] + cubic * x[1] * x[2], x[0] + cubic * x[0] * x[2],
                -2 * x[2] + cubic * x[0] * x[1], x[2], x[1], x[0], x[2] - 0.3 * x[1], -0.3 * x[0],
                x[0] + 3 * cubic * x[2] * x[2])
            .finished();
      };
      Made made(test::block_geo(kind, 3, 0), order, with_gauges());
      EXPECT_LT(error_of(made, field, slopes), 1e-9) << kind << order;
    }
}

// Nodal values of a smooth field. The gradient of its interpolation has the order p, what is recovered p + 1.
// Between meshes with elements of half the size, errors fall by 2^(p + 1); at single points, 0.5 less counts.
TEST(Gauge, converges_with_one_order_more_than_the_gradient) {
  const Field field = [](const Point& x) -> Point {
    return {std::sin(1.5 * x[0]) * std::cos(x[1]), std::exp(0.8 * x[1]) * x[2] * x[2], std::sin(x[0] + x[2])};
  };
  const Slopes slopes = [](const Point& x) -> Matrix3d {
    const double c = std::cos(x[0] + x[2]), e = std::exp(0.8 * x[1]);
    return (Matrix3d() << 1.5 * std::cos(1.5 * x[0]) * std::cos(x[1]), -std::sin(1.5 * x[0]) * std::sin(x[1]),
            0, 0, 0.8 * e * x[2] * x[2], 2 * e * x[2], c, 0, c)
        .finished();
  };
  for (const char* kind : {"tet", "hex"})
    for (const int order : {1, 2}) {
      const int coarse = order == 1 ? 4 : 3;
      std::vector<double> error;
      for (const int divisions : {coarse, 2 * coarse}) {
        Made made(test::block_geo(kind, divisions, 0), order, with_gauges());
        error.push_back(error_of(made, field, slopes));
      }
      const double rate = std::log2(error[0] / error[1]);
      EXPECT_GT(rate, order + 0.5) << kind << order << ": " << error[0] << " " << error[1];
      EXPECT_LT(error[1], order == 1 ? 0.012 : 3e-4) << kind << order;
    }
}

// One element across cannot determine all monomials, however many elements a patch takes; far ones would only
// smooth a field that varies along the plate: 8.7 % of error instead of 1.0 %.
TEST(Gauge, in_a_plate_of_one_element_across_takes_no_far_elements) {
  Made made(
      "Point(1) = {0, 0, 0}; line[] = Extrude {1, 0, 0} { Point{1}; Layers{8}; };\n"
      "face[] = Extrude {0, 1, 0} { Line{line[1]}; Layers{8}; Recombine; };\n"
      "plate[] = Extrude {0, 0, 1} { Surface{face[1]}; Layers{1}; Recombine; };\n"
      "Physical Volume(\"body\") = {plate[1]}; Physical Surface(\"top\") = {plate[0]};\n",
      2, with_gauges());
  EXPECT_LT(error_of(
                made,
                [](const Point& x) -> Point {
                  return {std::sin(6 * x[0]), std::sin(6 * x[1]), 0};
                },
                [](const Point& x) -> Matrix3d {
                  return Point(6 * std::cos(6 * x[0]), 6 * std::cos(6 * x[1]), 0).asDiagonal();
                }),
            0.02);
}

// ∂u/∂x = 3 x² has the mean 3 (x₀² + L²/12), which is L²/4 more than its value in the middle.
TEST(Gauge, with_a_length_averages_its_strain) {
  scene::KernelRequest request = request_of({"top"}, {});
  const double length = 0.6;
  request.gauges = {
      {.name = "g", .body = "body", .at = {0.5, 0.5, 1}, .direction = Vector3{1, 0, 0}, .length = length}};
  Made made(test::block_geo("hex", 2, 0), 3, request);
  const kernels::Kernel kernel = kernel_of(made, [](const Point& x) -> Point {
    return {x[0] * x[0] * x[0], 0, 0};
  });
  EXPECT_NEAR(kernel.gauges[0].strain->shape[0], 3 * (0.25 + length * length / 12), 1e-9);
}

TEST(Gauge, whose_length_leaves_the_body_is_refused) {
  scene::KernelRequest request = with_gauges(0.5);
  request.gauges.resize(1);
  request.gauges[0].at = {0.5, 0.5, 1};
  request.gauges[0].direction = Vector3{0, 0, 1};
  EXPECT_THAT(test::complaint_of([&] { Made(test::block_geo("hex", 2, 0), 2, request); }),
              AllOf(HasSubstr("output.gauge \"g\": its length leaves bodies.body by 0.1936 m"),
                    HasSubstr("shorten it, or turn its direction")));
}

// One element has too few nodes for its polynomial, but constant stress needs no more.
TEST(Gauge, of_a_single_element_has_its_constant_stress) {
  for (const int order : {1, 2}) {
    Made made(test::block_geo("hex", 1, 0), order, with_gauges());
    EXPECT_LT(error_of(
                  made, [](const Point& x) -> Point { return gradient * x; },
                  [](const Point&) { return gradient; }),
              1e-9)
        << order;
  }
}

}  // namespace gauges_test
}  // namespace ricochet
