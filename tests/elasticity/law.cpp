// SPDX-License-Identifier: BSD-2-Clause
// Anisotropic elasticity. The oracles turn the tensor C_ijkl index by index, or the strain into cylindrical
// components; the code turns 6×6 matrices.
#include "src/elasticity/law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "src/elasticity/assemble.hpp"
#include "src/elasticity/surplus.hpp"
#include "src/scene/elastic_law.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace law_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using elasticity::Matrix6;

/// Of the size of albite, which has no symmetry.
const std::array<double, 21> triclinic{0.699,  0.34,   0.308,  0.051,  -0.024, -0.009, 1.835,
                                       0.055,  -0.039, -0.077, -0.058, 1.795,  -0.087, 0.071,
                                       -0.098, 0.249,  -0.024, -0.072, 0.268,  0.005,  0.335};

scene::Material material_of(const std::array<double, 21>& constants) {
  scene::Material material{.group = "", .density = 2};
  material.stiffness = constants;
  return material;
}

scene::Material isotropic() { return {.group = "", .density = 2, .young = 3, .poisson = 0.3}; }

std::array<double, 21> constants_of(const scene::Material& isotropic) {
  const double mu = isotropic.young / (2 * (1 + isotropic.poisson)),
               lambda = 2 * mu * isotropic.poisson / (1 - 2 * isotropic.poisson), p = lambda + 2 * mu;
  return {p, lambda, lambda, 0, 0, 0, p, lambda, 0, 0, 0, p, 0, 0, 0, mu, 0, 0, mu, 0, mu};
}

Matrix6 filled(const std::array<double, 21>& constants) {
  Matrix6 out;
  auto next = constants.begin();
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) out(i, j) = out(j, i) = *next++;
  return out;
}

constexpr int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

/// ε : C : ε by Σ C_pqrs ε'_pq ε'_rs, with the strain ε' along the axes, which are the columns of a rotation.
double twice_energy(const Matrix6& C, const Matrix3d& axes, const Matrix3d& strain) {
  const Matrix3d own = axes.transpose() * strain * axes;
  double sum = 0;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q)
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 3; ++s) sum += C(place[p][q], place[r][s]) * own(p, q) * own(r, s);
  return sum;
}

const Matrix3d slopes = (Matrix3d() << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.6, -0.1).finished();
const Matrix3d strain = (slopes + slopes.transpose()) / 2;
const Matrix3d turn =
    (Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()) * Eigen::AngleAxisd(-1.1, Vector3d::UnitZ()))
        .toRotationMatrix();

Vector3 list(const Vector3d& v) { return {v[0], v[1], v[2]}; }

/// A body of `kind`, with its matrices. Needs a GmshSession.
struct Made {
  scene::Body given;
  mesh::Mesh mesh;
  elasticity::Body body;
  Made(const std::string& kind, int order, double lean, const scene::Material& material)
      : Made(test::SharedFile(".geo", test::block_geo(kind, 2, lean)), order, material) {}

  /// uᵀ K u of the linear displacement, and the largest force inside over the largest one.
  std::pair<double, double> of_linear() const {
    Eigen::MatrixXd u(body.local_rows, 1);
    const auto each = [&](auto&& visit) {
      for (std::size_t i = 0; i < mesh.node.size(); ++i)
        if (const std::int64_t row = mesh.owned(mesh.node[i]); row >= 0)
          visit(3 * row, Vector3d(&mesh.position[3 * i]));
    };
    each([&](Eigen::Index row, const Vector3d& x) { u.block<3, 1>(row, 0) = slopes * x; });
    const Eigen::MatrixXd force = test::product(body.stiffness, u);
    double inside = 0;
    each([&](Eigen::Index row, const Vector3d& x) {
      if ((x.array() > 1e-9).all() && (x.array() < 1 - 1e-9).all())
        inside = std::max(inside, force.block<3, 1>(row, 0).cwiseAbs().maxCoeff());
    });
    const double most = parallel::largest(mesh.comm, force.size() > 0 ? force.cwiseAbs().maxCoeff() : 0.0);
    return {modes::inner(mesh.comm, u, force)(0, 0), parallel::largest(mesh.comm, inside) / most};
  }

 private:
  Made(const test::SharedFile& file, int order, const scene::Material& material)
      : given(test::body_of(file.path(), order)), mesh(test::mesh_of(given)) {
    given.materials = {material};
    body = elasticity::assemble(mesh, given.materials, "test");
  }
};

/// K u of all nodes in an order that does not depend on how the mesh is split, which varies from run to run.
Eigen::MatrixXd forces(const Made& made) {
  const mesh::Mesh& mesh = made.mesh;
  Eigen::MatrixXd u(made.body.local_rows, 4), all = Eigen::MatrixXd::Zero(3 * mesh.total_nodes, 4);
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 4; ++j)
        u(3 * row + k, j) = std::sin(1.3 * static_cast<double>(mesh.canonical[i]) + 0.7 * k + 2.1 * j);
  });
  const Eigen::MatrixXd force = test::product(made.body.stiffness, u);
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    all.middleRows<3>(3 * mesh.canonical[i]) = force.middleRows<3>(3 * row);
  });
  parallel::sum(mesh.comm, all);
  return all;
}

/// Largest difference of K u for random u, relative to the largest entry.
double difference(const Made& a, const Made& b) {
  const Eigen::MatrixXd one = forces(a);
  return test::largest_entry(one - forces(b)) / test::largest_entry(one);
}

TEST(AnisotropicPatch, linear_displacement_leaves_no_force_inside_and_the_exact_energy_in_turned_axes) {
  const mesh::GmshSession gmsh;
  for (const auto& [kind, order] : {std::pair("tet", 2), std::pair("hex", 2)}) {
    scene::Material material = material_of(triclinic);
    material.axes = {list(turn.col(0)), list(turn.col(1))};
    const Made made(kind, order, 0, material);
    const auto [energy, inside] = made.of_linear();
    const double exact = twice_energy(filled(triclinic), turn, strain);
    EXPECT_NEAR(energy, exact, 1e-12 * exact) << kind;
    EXPECT_LT(inside, 1e-12) << kind;  // as for isotropic materials, in patch.cpp
  }
}

// Constants of an isotropic material are those of any axes, also of axes that vary.
TEST(Anisotropic, with_isotropic_constants_equals_the_isotropic_body) {
  const mesh::GmshSession gmsh;
  for (const auto& [kind, order] : {std::pair("tet", 3), std::pair("hex", 2)}) {
    const Made reference(kind, order, 0.4, isotropic());
    scene::Material material = material_of(constants_of(isotropic()));
    material.axes = {list(turn.col(0)), list(turn.col(1))};
    EXPECT_LT(difference(reference, {kind, order, 0.4, material}), 1e-13) << kind;
    material.about = scene::CentreLine{{0.3, 0.3, 0}, {0, 0, 1}};
    EXPECT_LT(difference(reference, {kind, order, 0.4, material}), 1e-13) << kind;
    material.about.reset();
    material.stiffness.reset();
    const double young = isotropic().young, shear = young / (2 * (1 + isotropic().poisson));
    material.orthotropy = scene::Orthotropy{{young, young, young}, {shear, shear, shear}, {0.3, 0.3, 0.3}};
    EXPECT_LT(difference(reference, {kind, order, 0.4, material}), 1e-12) << kind;
  }
}

// Estimates of errors go through functions of the next order: constant and varying Jacobians, fixed and
// varying axes.
TEST(Anisotropic, with_isotropic_constants_has_the_estimates_of_the_isotropic_body) {
  const mesh::GmshSession gmsh;
  for (const auto& [kind, order] : {std::pair("tet", 2), std::pair("hex", 2)}) {
    const auto errors = [&](const scene::Material& material) {
      const Made made(kind, order, 0.4, material);
      Eigen::MatrixXd shape(made.body.local_rows, 1);
      for (std::size_t i = 0; i < made.mesh.node.size(); ++i)
        if (const std::int64_t row = made.mesh.owned(made.mesh.node[i]); row >= 0) {
          const Vector3d x(&made.mesh.position[3 * i]);
          shape.block<3, 1>(3 * row, 0) << std::sin(2 * x[0]) * x[1], std::cos(x[1] + x[2]),
              x[0] * std::exp(x[2]);
        }
      return elasticity::stiffness_errors(made.mesh, made.given.materials, shape,
                                          Eigen::VectorXd::Constant(1, 2.0))(0, 0);
    };
    const double reference = errors(isotropic());
    scene::Material material = material_of(constants_of(isotropic()));
    material.axes = {list(turn.col(0)), list(turn.col(1))};
    EXPECT_NEAR(errors(material), reference, 1e-11 * reference) << kind;
    material.about = scene::CentreLine{{0.3, 0.3, 0}, {0, 0, 1}};
    EXPECT_NEAR(errors(material), reference, 1e-11 * reference) << kind;
  }
}

// The integral of the energy over the cube by 16³ Gauss points, in cylindrical components about a line
// outside.
TEST(CylindricalAxes, have_the_energy_of_strains_in_cylindrical_components) {
  const mesh::GmshSession gmsh;
  const Vector3d along = Vector3d(0.2, -0.3, 1).normalized(), through(-0.8, -0.6, 0.3);
  scene::Material material = material_of(triclinic);
  material.about = scene::CentreLine{list(through), list(along)};
  const Eigen::Index n = 16;
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);  // Golub & Welsch
  for (Eigen::Index k = 1; k < n; ++k)
    jacobi(k, k - 1) = static_cast<double>(k) / std::sqrt(4.0 * static_cast<double>(k * k) - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> rule(jacobi);
  double exact = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index k = 0; k < n; ++k) {
        const Vector3d x =
            (Vector3d(rule.eigenvalues()[i], rule.eigenvalues()[j], rule.eigenvalues()[k]).array() + 1) / 2;
        Matrix3d axes;
        axes.col(0) = (x - through - along * along.dot(x - through)).normalized();
        axes.col(1) = along.cross(axes.col(0));
        axes.col(2) = along;
        const double weight =
            std::pow(rule.eigenvectors()(0, i) * rule.eigenvectors()(0, j) * rule.eigenvectors()(0, k), 2);
        exact += weight * twice_energy(filled(triclinic), axes, strain);
      }
  // The rule of elements of order 3 has degree 8, and C is no polynomial.
  EXPECT_NEAR(Made("hex", 3, 0, material).of_linear().first, exact, 1e-9 * exact);
  EXPECT_NEAR(Made("tet", 3, 0, material).of_linear().first, exact, 1e-8 * exact);
}

TEST(CylindricalAxes, on_their_line_have_the_mean_of_all_radial_directions) {
  scene::Material material = material_of(triclinic);
  const Vector3d along = Vector3d(1, 2, 2) / 3, through(0.1, 0.2, 0.3), normal = along.unitOrthogonal();
  material.about = scene::CentreLine{list(through), list(along)};
  const elasticity::Law law(material);
  Matrix6 mean = Matrix6::Zero();
  for (int k = 0; k < 360; ++k)
    mean += law.at(through + Eigen::AngleAxisd(k * M_PI / 180, along) * (0.01 * normal)) / 360;
  EXPECT_LT((law.at(through) - mean).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((law.at(through + 7 * along) - mean).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_GT((law.at(through + 0.01 * normal) - mean).cwiseAbs().maxCoeff(), 0.1);
}

// Copper: the extreme moduli are along an edge and a diagonal of its cube, 1/E = S11 − 2 (S11 − S12 − S44/2)
// Γ with Γ = 0 and 1/3 (Nye 1957). The mean of a law with isotropic constants is this law.
TEST(FiguresOfALaw, are_those_of_closed_forms) {
  const double c11 = 168.4, c12 = 121.4, c44 = 75.4, d = (c11 - c12) * (c11 + 2 * c12), s11 = (c11 + c12) / d,
               s12 = -c12 / d, s44 = 1 / c44;
  const scene::Material copper = [&] {
    scene::Material out =
        material_of({c11, c12, c12, 0, 0, 0, c11, c12, 0, 0, 0, c11, 0, 0, 0, c44, 0, 0, c44, 0, c44});
    return out;
  }();
  const double soft = 1 / s11, stiff = 1 / (s11 - 2 * (s11 - s12 - s44 / 2) / 3);
  EXPECT_NEAR(scene::softest_young(copper), soft, 1e-12 * soft);
  const scene::WaveSpeeds waves = scene::wave_speeds(copper);
  EXPECT_NEAR(waves.low, std::sqrt(soft / 2), 1e-12 * waves.low);
  EXPECT_NEAR(waves.high, std::sqrt(stiff / 2), 1e-3 * waves.high);  // directions are 3° apart
  const scene::Material like = material_of(constants_of(isotropic()));
  EXPECT_NEAR(scene::mean_poisson(like), 0.3, 1e-13);
  EXPECT_NEAR(scene::wave_speeds(like).mean, std::sqrt(1.5), 1e-13);
  EXPECT_NEAR(scene::wave_speeds(like).low, std::sqrt(1.5), 1e-13);
}

}  // namespace law_test
}  // namespace ricochet
