// SPDX-License-Identifier: BSD-2-Clause
// Assembled bodies: mass and inertia in closed form, supports against the matrices without them, and
// refusals.
#include "src/elasticity/assemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"
#include "tests/support.hpp"

namespace ricochet {
namespace assemble_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

mesh::Mesh mesh_of(const std::string& geo, int order) {
  const test::SharedFile file(".geo", geo);
  return test::mesh_of(test::body_of(file.path(), order));
}

scene::Material material(double density, double young, double poisson = 0.3) {
  return {.group = "", .density = density, .young = young, .poisson = poisson, .area = 0.5};
}

Eigen::Map<Vector3d> place(mesh::Mesh& mesh, std::size_t node) {
  return Eigen::Map<Vector3d>(&mesh.position[3 * node]);
}

/// Rows of all ranks.
MatrixXd whole(const mesh::Mesh& mesh, const elasticity::Body& body, const MatrixXd& local) {
  MatrixXd all = MatrixXd::Zero(body.total_rows, local.cols());
  all.middleRows(mesh.first_node * mesh.components(), body.local_rows) = local;
  parallel::sum(mesh.comm, all);
  return all;
}

/// The positions of all nodes, in the order of the rows (n,3).
MatrixXd positions(mesh::Mesh& mesh) {
  MatrixXd all = MatrixXd::Zero(mesh.total_nodes, 3);
  mesh.for_each_owned(
      [&](std::size_t i, std::int64_t own) { all.row(mesh.first_node + own) = place(mesh, i); });
  parallel::sum(mesh.comm, all);
  return all;
}

struct Case {
  std::string kind;
  int order;
};

/// A cube in shear, rotation and stretch, away from the origin: x = A ξ + b.
class Skewed : public testing::TestWithParam<Case> {
 protected:
  Skewed() {
    const auto& [kind, order] = GetParam();
    mesh_ = mesh_of(kind == "prism" ? test::prism_geo(2) : test::block_geo(kind, 2, 0), order);
    for (std::size_t i = 0; i < mesh_.node.size(); ++i)
      place(mesh_, i) = (turn_ * Vector3d(place(mesh_, i)) + offset_).eval();
  }
  const mesh::GmshSession gmsh_;
  const Eigen::Matrix3d turn_ =
      (Eigen::Matrix3d() << 1.1, 0.4, -0.3, -0.2, 1.7, 0.5, 0.6, -0.1, 0.9).finished();
  const Vector3d offset_{0.7, -1.2, 2.1};
  mesh::Mesh mesh_;
};

INSTANTIATE_TEST_SUITE_P(Elements, Skewed,
                         testing::Values(Case{"tet", 1}, Case{"tet", 2}, Case{"tet", 3}, Case{"hex", 1},
                                         Case{"hex", 2}, Case{"prism", 1}, Case{"prism", 2}),
                         [](const auto& it) { return it.param.kind + std::to_string(it.param.order); });

// ∫ (ξ − ½)(ξ − ½)ᵀ = I/12 over the cube.
TEST_P(Skewed, body_has_the_exact_mass_centre_and_inertia) {
  const elasticity::Body body = elasticity::assemble(mesh_, {material(2, 3)}, "test");
  const double mass = 2 * turn_.determinant();
  const Eigen::Matrix3d second = mass / 12 * turn_ * turn_.transpose();
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  const Vector3d centre = turn_ * Vector3d::Constant(0.5) + offset_;
  // gmsh places nodes to about 2e-12.
  EXPECT_NEAR(body.total_mass, mass, 1e-11);
  EXPECT_LT((Vector3d(body.centre.data()) - centre).norm(), 1e-11);
  EXPECT_LT((Eigen::Map<const Eigen::Matrix3d>(body.inertia.data()) - inertia).norm(), 1e-10);
}

TEST_P(Skewed, body_loads_its_rigid_motions_with_their_inertia) {
  const elasticity::Body body = elasticity::assemble(mesh_, {material(2, 3)}, "test");
  const MatrixXd nodes = positions(mesh_);
  MatrixXd rigid(body.total_rows, 6);
  for (Index i = 0; i < nodes.rows(); ++i)
    for (int k = 0; k < 3; ++k) {
      rigid.block<3, 1>(3 * i, k) = Vector3d::Unit(k);
      rigid.block<3, 1>(3 * i, 3 + k) = Vector3d::Unit(k).cross(Vector3d(nodes.row(i)));
    }
  const MatrixXd mass = test::dense(mesh_, body, body.mass);
  EXPECT_LT(test::largest_entry(whole(mesh_, body, body.rigid_load) - mass * rigid), 1e-13);
}

TEST_P(Skewed, body_allocates_exactly_the_entries_that_its_elements_couple) {
  const elasticity::Body body = elasticity::assemble(mesh_, {material(2, 3)}, "test");
  for (Mat matrix : {static_cast<Mat>(body.stiffness), static_cast<Mat>(body.mass)}) {
    MatInfo info{};
    parallel::check(MatGetInfo(matrix, MAT_GLOBAL_SUM, &info));
    EXPECT_EQ(info.nz_allocated, info.nz_used);
    EXPECT_EQ(info.mallocs, 0);
  }
}

// Elements left of the middle are of the first material.
TEST_P(Skewed, body_of_two_materials_has_the_mass_and_the_stiffness_of_each) {
  for (mesh::Block& block : mesh_.blocks)
    for (std::size_t e = 0; e < block.size(); ++e) {
      const auto n = static_cast<std::size_t>(block.nodes_per_element);
      Vector3d middle = Vector3d::Zero();
      for (std::size_t a = 0; a < n; ++a)
        middle += place(mesh_, static_cast<std::size_t>(block.node[e * n + a])) / static_cast<double>(n);
      block.label[e] = middle[0] < 1.2;
    }
  const scene::Material light = material(2, 3), heavy = material(5, 4, 0.1), none = material(1e-14, 1e-14);
  const elasticity::Body both = elasticity::assemble(mesh_, {light, heavy}, "test"),
                         one = elasticity::assemble(mesh_, {light, none}, "test"),
                         other = elasticity::assemble(mesh_, {none, heavy}, "test");
  EXPECT_GT(one.total_mass, 0.1);
  EXPECT_GT(other.total_mass, 0.1);
  // The materials fill the body. Its determinant is the volume.
  EXPECT_NEAR(one.total_mass / 2 + other.total_mass / 5, turn_.determinant(), 1e-11);
  EXPECT_NEAR(both.total_mass, one.total_mass + other.total_mass, 1e-12);
  const auto dense = [&](const elasticity::Body& body, const parallel::Matrix& matrix) {
    return test::dense(mesh_, body, matrix);
  };
  EXPECT_LT(test::largest_entry(dense(both, both.stiffness) - dense(one, one.stiffness) -
                                dense(other, other.stiffness)),
            1e-12);
  EXPECT_LT(test::largest_entry(dense(both, both.mass) - dense(one, one.mass) - dense(other, other.mass)),
            1e-12);
  // √(E/ρ) is 1.22 and 0.89; the mean of 1/c³ over the volume determines the number of waves.
  const double V = one.total_mass / 2, W = other.total_mass / 5;
  EXPECT_NEAR((V + W) / std::pow(both.wave_speed, 3), V / std::pow(1.5, 1.5) + W / std::pow(0.8, 1.5), 1e-11);
  EXPECT_NEAR(both.volume, V + W, 1e-11);
}

/// Bits of supports: fixed components, and moving supports as bits 3, 4.
constexpr std::int64_t along_x = 1, along_y = 2, along_z = 4, first = 8, second = 16;

/// The body with supports against its matrices without them.
/// @param shape  (rows, 3S) displacements that the moving supports impose
/// @param fixed  rows that supports fix
void expect_supported(const mesh::Mesh& mesh, const std::vector<std::string>& moved, const MatrixXd& shape,
                      const std::vector<Index>& fixed) {
  mesh::Mesh loose = mesh;
  std::ranges::fill(loose.fixed, 0);
  const elasticity::Body without = elasticity::assemble(loose, {material(2, 3)}, "test"),
                         body = elasticity::assemble(mesh, {material(2, 3)}, "test", {}, moved);
  const MatrixXd K = test::dense(loose, without, without.stiffness),
                 M = test::dense(loose, without, without.mass),
                 rigid_load = whole(loose, without, without.rigid_load);
  Eigen::VectorXd free = Eigen::VectorXd::Ones(body.total_rows);
  for (const Index row : fixed) free[row] = 0;
  const auto kept = free.asDiagonal();
  EXPECT_EQ(body.free_rows, body.total_rows - std::ssize(fixed));
  MatrixXd stiffness = test::dense(mesh, body, body.stiffness);
  for (const Index row : fixed) {
    // A positive value that leaves the conditioning as it is.
    EXPECT_GT(stiffness(row, row), 0.01 * K.diagonal().maxCoeff());
    EXPECT_LE(stiffness(row, row), K.diagonal().maxCoeff());
    stiffness(row, row) = 0;
  }
  EXPECT_LT(test::largest_entry(stiffness - kept * K * kept), 1e-13);
  EXPECT_LT(test::largest_entry(test::dense(mesh, body, body.mass) - kept * M * kept), 1e-14);
  EXPECT_LT(test::largest_entry(whole(mesh, body, body.rigid_load) - kept * rigid_load), 1e-13);
  EXPECT_EQ(body.total_mass, without.total_mass);

  const elasticity::Imposed& imposed = body.imposed;
  ASSERT_EQ(imposed.shape.cols(), shape.cols());
  EXPECT_LT(test::largest_entry(whole(mesh, body, imposed.shape) - shape), 1e-15);
  EXPECT_LT(test::largest_entry(whole(mesh, body, imposed.force) + kept * K * shape), 1e-13);
  EXPECT_LT(test::largest_entry(whole(mesh, body, imposed.inertia) - kept * M * shape), 1e-14);
  EXPECT_LT(test::largest_entry(imposed.momentum - rigid_load.leftCols(3).transpose() * shape), 1e-13);
}

// The bottom moves along x and y, and a side along x and z. The edge that they share moves along x with the
// bottom. Another side rests along y.
TEST(Supports, of_a_solid_remove_rows_and_couple_them_with_the_others) {
  const mesh::GmshSession gmsh;
  for (const char* kind : {"tet", "hex"})
    for (int order : {1, 2}) {
      SCOPED_TRACE(testing::Message() << kind << " of order " << order);
      mesh::Mesh mesh = mesh_of(test::block_geo(kind, 2, 0.3), order);
      const auto bits_at = [](const Vector3d& x) {
        std::int64_t bits = x[2] < 1e-9 ? along_x | along_y | first : 0;
        if (x[1] < 0.15 * x[2] + 1e-9) bits |= along_x | along_z | second;
        if (x[0] < 0.15 * x[2] + 1e-9) bits |= along_y;
        return bits;
      };
      for (std::size_t i = 0; i < mesh.node.size(); ++i) mesh.fixed[i] = bits_at(place(mesh, i));
      const MatrixXd nodes = positions(mesh);
      MatrixXd shape = MatrixXd::Zero(3 * nodes.rows(), 6);
      std::vector<Index> fixed;
      for (Index i = 0; i < nodes.rows(); ++i) {
        const std::int64_t bits = bits_at(nodes.row(i));
        for (int k = 0; k < 3; ++k)
          if ((bits >> k & 1) != 0) fixed.push_back(3 * i + k);
        if ((bits & first) != 0) shape(3 * i, 0) = shape(3 * i + 1, 1) = 1;
        if ((bits & second) != 0) {
          if ((bits & first) == 0) shape(3 * i, 3) = 1;
          shape(3 * i + 2, 5) = 1;
        }
      }
      expect_supported(mesh, {"xy", "xz"}, shape, fixed);
    }
}

std::string inclined_rod() {
  return "Point(1) = {1,1,1};\nPoint(2) = {2,3,3};\nLine(1) = {1,2};\nTransfinite Curve{1} = 5;\n"
         "Physical Curve(\"rod\") = {1};\n";
}

// The rod moves only along (1, 2, 2)/3, so that a unit displacement along y moves its end by 2/3.
TEST(Supports, of_a_rod_move_its_ends_along_its_axis) {
  const mesh::GmshSession gmsh;
  for (int order : {1, 2, 3}) {
    SCOPED_TRACE(order);
    mesh::Mesh mesh = mesh_of(inclined_rod(), order);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      if (place(mesh, i)[0] < 1 + 1e-9) mesh.fixed[i] = along_x | first;
      if (place(mesh, i)[0] > 2 - 1e-9) mesh.fixed[i] = along_x | second;
    }
    const MatrixXd nodes = positions(mesh);
    MatrixXd shape = MatrixXd::Zero(nodes.rows(), 6);
    std::vector<Index> fixed;
    for (Index i = 0; i < nodes.rows(); ++i) {
      if (nodes(i, 0) < 1 + 1e-9) shape.row(i).head(3) = Vector3d(1, 2, 2) / 3, fixed.push_back(i);
      if (nodes(i, 0) > 2 - 1e-9) shape.row(i).tail(3) = Vector3d(0, 2, 0) / 3, fixed.push_back(i);
    }
    expect_supported(mesh, {"xyz", "y"}, shape, fixed);
  }
}

// Thin rod: J = m L²/12 (I − e eᵀ); N = EA u' and the wave speed √(E/ρ).
TEST(Rod, that_is_inclined_has_the_exact_mass_centre_inertia_and_stiffness) {
  const mesh::GmshSession gmsh;
  for (int order : {1, 2, 3, 4}) {
    SCOPED_TRACE(order);
    mesh::Mesh mesh = mesh_of(inclined_rod(), order);
    const elasticity::Body body = elasticity::assemble(mesh, {material(2, 3)}, "test");
    const Vector3d axis = Vector3d(1, 2, 2) / 3;
    const double length = 3, mass = 2 * 0.5 * length;
    EXPECT_NEAR(body.total_mass, mass, 1e-11);
    EXPECT_LT((Vector3d(body.centre.data()) - Vector3d(1.5, 2, 2)).norm(), 1e-11);
    const Eigen::Matrix3d inertia =
        mass * length * length / 12 * (Eigen::Matrix3d::Identity() - axis * axis.transpose());
    EXPECT_LT((Eigen::Map<const Eigen::Matrix3d>(body.inertia.data()) - inertia).norm(), 1e-10);
    EXPECT_NEAR(body.wave_speed, std::sqrt(1.5), 1e-14);
    const Eigen::VectorXd along = positions(mesh) * axis;
    const MatrixXd K = test::dense(mesh, body, body.stiffness), M = test::dense(mesh, body, body.mass);
    EXPECT_NEAR(along.dot(K * along), 3 * 0.5 * length, 1e-11);
    // Translations move it along its axis; rotations do not move its axis along itself.
    const MatrixXd load = whole(mesh, body, body.rigid_load);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(along.size());
    EXPECT_LT(test::largest_entry(load.leftCols(3) - M * ones * axis.transpose()), 1e-12);
    for (int k = 0; k < 3; ++k) {
      const Eigen::VectorXd turned = M * ones * axis.dot(Vector3d::Unit(k).cross(Vector3d(1, 1, 1)));
      EXPECT_LT(test::largest_entry(load.col(3 + k) - turned), 1e-11) << k;
    }
  }
}

TEST(Elements, that_are_inverted_are_refused_by_all_ranks_with_tag_and_place) {
  const mesh::GmshSession gmsh;
  for (const char* kind : {"tet", "hex"})
    for (int order : {1, 2}) {
      SCOPED_TRACE(testing::Message() << kind << " of order " << order);
      mesh::Mesh mesh = mesh_of(test::block_geo(kind, 2, 0), order);
      // Mirrored, every element is inverted, and rank 0 speaks.
      for (std::size_t i = 0; i < mesh.node.size(); ++i) place(mesh, i)[2] *= -1;
      const mesh::Block& block = mesh.blocks[0];
      const Vector3d x = place(mesh, static_cast<std::size_t>(block.node[0]));
      std::string words =
          fmt::format("part.msh: element {} near ({:.4g}, {:.4g}, {:.4g}) m is inverted or flat",
                      block.tag[0], x[0], x[1], x[2]);
      parallel::broadcast(mesh.comm, words);
      EXPECT_THAT(test::complaint_of([&] { elasticity::assemble(mesh, {material(2, 3)}, "part.msh"); }),
                  AllOf(HasSubstr(words), HasSubstr("repair the mesh"), Not(HasSubstr("order"))));
      // Mirrored back, and then with one edge bent through the element.
      for (std::size_t i = 0; i < mesh.node.size(); ++i) place(mesh, i)[2] *= -1;
      if (order == 2) {
        const auto corner = place(mesh, static_cast<std::size_t>(block.node[0]));
        const auto opposite = place(mesh, static_cast<std::size_t>(block.node[3]));
        place(mesh, static_cast<std::size_t>(block.node[std::string(kind) == "tet" ? 4 : 8])) =
            corner + 3 * (opposite - corner);
        EXPECT_THAT(test::complaint_of([&] { elasticity::assemble(mesh, {material(2, 3)}, "part.msh"); }),
                    HasSubstr("or lower the element order"));
      }
      // Flat.
      for (std::size_t i = 0; i < mesh.node.size(); ++i) place(mesh, i)[2] = 0;
      EXPECT_THAT(test::complaint_of([&] { elasticity::assemble(mesh, {material(2, 3)}, "part.msh"); }),
                  HasSubstr("is inverted or flat"));
    }
  mesh::Mesh rod = mesh_of(inclined_rod(), 1);
  for (std::size_t i = 0; i < rod.node.size(); ++i) place(rod, i).setOnes();
  EXPECT_THAT(test::complaint_of([&] { elasticity::assemble(rod, {material(2, 3)}, "rod.msh"); }),
              HasSubstr("is inverted or flat"));
}

TEST(Assembly, reports_its_progress_every_256_elements) {
  const mesh::GmshSession gmsh;
  mesh::Mesh mesh = mesh_of(test::block_geo("hex", 9, 0), 1);
  std::int64_t elements = 0;
  for (const mesh::Block& block : mesh.blocks) elements += std::ssize(block.tag);
  std::vector<std::int64_t> seen;
  elasticity::assemble(mesh, {material(2, 3)}, "test", [&](std::int64_t done, std::int64_t all) {
    EXPECT_EQ(all, elements);
    seen.push_back(done);
  });
  std::vector<std::int64_t> expected;
  for (std::int64_t done = 256; done <= elements; done += 256) expected.push_back(done);
  EXPECT_EQ(seen, expected);
}

}  // namespace assemble_test
}  // namespace ricochet
