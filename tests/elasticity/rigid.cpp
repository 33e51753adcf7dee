// SPDX-License-Identifier: BSD-2-Clause
// Rigid motions that supports leave free, in closed form.
#include "src/elasticity/rigid.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/cubes.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace rigid_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// A mesh that is fixed at some places.
struct Supported {
  template <class Bits>
  Supported(const std::string& geo, Bits&& bits, int order = 2) {
    const test::SharedFile file(".geo", geo);
    scene::Body given = test::body_of(file.path(), order);
    mesh = test::mesh_of(given);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) mesh.fixed[i] = bits(Vector3d(&mesh.position[3 * i]));
    body = elasticity::assemble(mesh, given.materials, "test");
    modes = elasticity::rigid_modes(mesh, body);
    // Rigid motions are orthonormal in the mass.
    const MatrixXd gram = modes::inner(mesh.comm, modes, test::product(body.mass, modes));
    EXPECT_LT((gram - MatrixXd::Identity(modes.cols(), modes.cols())).norm(), 1e-12);
  }
  /// The largest deviation of displacements from u(x) over all ranks, except at fixed rows, which must be 0.
  template <class Field>
  double deviation(Index column, Field&& u) const {
    double off = 0;
    const int c = mesh.components();
    mesh.for_each_owned([&](std::size_t i, std::int64_t own) {
      const Vector3d exact = u(Vector3d(&mesh.position[3 * i]));
      for (int k = 0; k < c; ++k) {
        const double value = modes(c * own + k, column);
        if (mesh.is_fixed(i, k))
          EXPECT_EQ(value, 0);
        else
          off = std::max(off, std::abs(value - exact[k]));
      }
    });
    return parallel::largest(mesh.comm, off);
  }
  /// The sign of a mode: that of its inner product with gravity or with rotation k.
  double sign(Index column, int k) const {
    double along = modes.col(column).dot(body.rigid_load.col(k));
    parallel::sum(mesh.comm, &along, 1);
    return along < 0 ? -1 : 1;
  }

  const mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  elasticity::Body body;
  MatrixXd modes;
};

// The cube of density 2 about its edge along y: J = m (1 + 1)/3.
TEST(RigidModes, of_a_hinged_cube_are_its_rotation_about_the_hinge) {
  const Supported cube(test::block_geo("hex", 2, 0),
                       [](const Vector3d& x) { return x[0] < 1e-9 && x[2] < 1e-9 ? 7 : 0; });
  ASSERT_EQ(cube.modes.cols(), 1);
  const double speed = cube.sign(0, 4) / std::sqrt(2 * 2.0 / 3);
  // The hinged nodes have mass, but do not move.
  EXPECT_LT(
      cube.deviation(0, [&](const Vector3d& x) -> Vector3d { return speed * Vector3d::UnitY().cross(x); }),
      1e-10);
}

TEST(RigidModes, of_a_cube_on_a_rail_are_its_translation_along_the_rail) {
  const Supported cube(test::block_geo("hex", 2, 0),
                       [](const Vector3d& x) { return x[2] < 1e-9 ? 5 : 0; });  // x and z of the bottom
  ASSERT_EQ(cube.modes.cols(), 1);
  const double speed = cube.sign(0, 1) / std::sqrt(2.0);
  EXPECT_LT(cube.deviation(0, [&](const Vector3d&) -> Vector3d { return speed * Vector3d::UnitY(); }), 1e-10);
}

TEST(RigidModes, of_a_clamped_cube_do_not_exist) {
  const Supported cube(test::block_geo("hex", 2, 0), [](const Vector3d& x) { return x[2] < 1e-9 ? 7 : 0; });
  EXPECT_EQ(cube.modes.cols(), 0);
}

TEST(RigidModes, of_a_cube_fixed_at_one_corner_are_three_rotations) {
  const Supported cube(test::block_geo("hex", 2, 0),
                       [](const Vector3d& x) { return x.norm() < 1e-9 ? 7 : 0; });
  EXPECT_EQ(cube.modes.cols(), 3);
}

// ρ A L = 2 · 0.5 · 3.
TEST(RigidModes, of_a_rod_are_one_translation_unless_it_is_fixed) {
  const std::string geo =
      "Point(1) = {1,1,1};\nPoint(2) = {2,3,3};\nLine(1) = {1,2};\nTransfinite Curve{1} = 5;\n"
      "Physical Curve(\"rod\") = {1};\n";
  {
    const Supported rod(geo, [](const Vector3d&) { return 0; });
    ASSERT_EQ(rod.modes.cols(), 1);
    const double value = rod.sign(0, 0) / std::sqrt(3.0);
    EXPECT_LT(rod.deviation(0, [&](const Vector3d&) -> Vector3d { return Vector3d::Constant(value); }),
              1e-11);
  }
  EXPECT_EQ(Supported(geo, [](const Vector3d& x) { return x[0] < 1 + 1e-9 ? 1 : 0; }).modes.cols(), 0);
}

// Two cubes, one of them turned away from the origin by its place alone, in one mesh.
TEST(RigidModes, of_two_bodies_in_one_mesh_are_those_of_each) {
  const std::string geo =
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0,1,1,1};\nBox(2) = {3,1,-2,1,2,1};\n"
      "Transfinite Curve{:} = 3;\nTransfinite Surface{:};\nRecombine Surface{:};\nTransfinite Volume{:};\n"
      "Physical Volume(\"body\") = {1, 2};\n";
  // The first one slides along x.
  const Supported both(geo, [](const Vector3d& x) { return x[0] < 2 && x[2] < 1e-9 ? 6 : 0; });
  ASSERT_EQ(both.mesh.parts, 2);
  ASSERT_EQ(both.modes.cols(), 7);
  double first = 0, second = 0;
  both.mesh.for_each_owned([&](std::size_t i, std::int64_t own) {
    const bool of_first = both.mesh.position[3 * i] < 2;
    const double size = both.modes.middleRows(3 * own, 3)
                            .middleCols(of_first ? 1 : 0, of_first ? 6 : 1)
                            .cwiseAbs()
                            .maxCoeff();
    (of_first ? first : second) = std::max(of_first ? first : second, size);
  });
  EXPECT_EQ(parallel::largest(both.mesh.comm, first), 0);
  EXPECT_EQ(parallel::largest(both.mesh.comm, second), 0);
}

/// The number of rigid modes, of which the stiffness must not resist any, and that of mechanisms.
std::pair<Index, std::int64_t> counts(const Supported& cubes) {
  const MatrixXd force = test::product(cubes.body.stiffness, cubes.modes);
  double largest = force.size() > 0 ? force.cwiseAbs().maxCoeff() : 0;
  // Entries of K and of the modes are of order one, and each row has some hundred.
  EXPECT_LT(parallel::largest(cubes.mesh.comm, largest), 1e-12);
  return {cubes.modes.cols(), elasticity::mechanisms(cubes.mesh)};
}

Supported free_cubes(const std::vector<std::array<int, 3>>& lowest, int order = 2) {
  return Supported(
      test::cubes_geo(lowest, 2), [](const Vector3d&) { return 0; }, order);
}

using Counts = std::pair<Index, std::int64_t>;

TEST(RigidModes, of_cubes_that_share_an_edge_are_seven_and_a_vertex_nine) {
  // The hats of order 2 at an edge have no moment about it, so only order 1 shows the inertia of shared
  // nodes.
  for (const int order : {1, 2}) {
    EXPECT_EQ(counts(free_cubes({{0, 0, 0}, {1, 1, 0}}, order)), Counts(7, 1));
    EXPECT_EQ(counts(free_cubes({{0, 0, 0}, {1, 1, 1}}, order)), Counts(9, 3));
  }
  EXPECT_EQ(counts(free_cubes({{0, 0, 0}, {1, 0, 0}})), Counts(6, 0));
}

TEST(RigidModes, of_chains_and_loops_of_cubes_are_those_that_joints_leave) {
  EXPECT_EQ(counts(free_cubes({{0, 0, 0}, {1, 1, 0}, {2, 2, 1}, {6, 0, 0}})), Counts(6 + 1 + 3 + 6, 4));
  // Three edges along three axes, one for each pair: the cubes hold each other.
  EXPECT_EQ(counts(free_cubes({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}})), Counts(6, 0));
}

// A cube of density 2 hangs by an edge along z at x = y = 1 on one that is fixed: J = m (1 + 1)/3.
TEST(RigidModes, of_a_cube_that_hinges_on_a_fixed_one_are_its_rotation_about_the_shared_edge) {
  const Supported cubes(test::cubes_geo({{0, 0, 0}, {1, 1, 0}}, 2),
                        [](const Vector3d& x) { return x[0] < 1e-9 ? 7 : 0; });
  ASSERT_EQ(counts(cubes), Counts(1, 1));
  const double size = 1 / std::sqrt(2 * 2.0 / 3);
  // The angular momentum about the origin has the sign of that about the hinge.
  const double sign = cubes.sign(0, 5);
  const Vector3d hinge(1, 1, 0);
  EXPECT_LT(cubes.deviation(0,
                            [&](const Vector3d& x) -> Vector3d {
                              if (x[0] < 1 + 1e-9 && x[1] < 1 + 1e-9) return Vector3d::Zero();
                              return sign * size * Vector3d::UnitZ().cross(x - hinge);
                            }),
            1e-10);
}

TEST(RigidModes, begin_with_those_of_the_whole_although_it_hinges) {
  const Supported cubes = free_cubes({{0, 0, 0}, {1, 1, 0}});
  for (Index k = 0; k < 3; ++k) {
    const double speed = cubes.sign(k, static_cast<int>(k)) / std::sqrt(4.0);  // the mass
    EXPECT_LT(cubes.deviation(k, [&](const Vector3d&) -> Vector3d { return speed * Vector3d::Unit(k); }),
              1e-10);
  }
  // The pieces swing against each other, so that the whole neither moves nor turns.
  MatrixXd momentum = cubes.body.rigid_load.transpose() * cubes.modes.col(6);
  parallel::sum(cubes.mesh.comm, momentum);
  EXPECT_LT(momentum.cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace rigid_test
}  // namespace ricochet
