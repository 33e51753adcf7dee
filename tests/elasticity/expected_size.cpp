// SPDX-License-Identifier: BSD-2-Clause
// The size of matrices that is expected before they are assembled, against the matrices themselves.
#include "src/elasticity/expected_size.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "src/elasticity/assemble.hpp"
#include "src/modes/operators.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace expected_size_test {

/// Number of entries of the blocks that PETSc stores.
double entries_of(Mat matrix) {
  MatInfo info{};
  parallel::check(MatGetInfo(matrix, MAT_LOCAL, &info));
  return info.nz_used;
}

/// Memory of this process [MiB].
double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096 / (1 << 20);
}

void expect_size(const scene::Body& given, int components) {
  const mesh::Mesh mesh = mesh::distribute(mesh::read_mesh(given), PETSC_COMM_SELF);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
  const double blocks = entries_of(body.stiffness) / (components * components);
  EXPECT_EQ(elasticity::expected_blocks(mesh), blocks);
  // The mean over 100 nodes scatters by a tenth of the range of a few to a hundred neighbours.
  EXPECT_NEAR(elasticity::expected_blocks(mesh, 100) / blocks, 1, 0.15);
  if (components == 1) return;
  EXPECT_LT(elasticity::least_mib(mesh.total_nodes), elasticity::expected_mib(mesh));
  // Nodes of solids of order 1 to 4 have up to 125 neighbours in place of three.
  EXPECT_GT(elasticity::least_mib(mesh.total_nodes), elasticity::expected_mib(mesh) / 40);
}

TEST(ExpectedSize, counts_the_blocks_of_every_element_and_order) {
  const mesh::GmshSession gmsh;
  for (const char* kind : {"tet", "hex"})
    for (int order = 1; order <= 4; ++order) {
      SCOPED_TRACE(testing::Message() << kind << " of order " << order);
      const test::SharedFile file(".geo", test::block_geo(kind, order < 3 ? 5 : 2, 0.3));
      expect_size(test::body_of(file.path(), order), 3);
    }
}

TEST(ExpectedSize, is_the_memory_that_matrices_take) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 6, 0.3));
  const scene::Body given = test::body_of(file.path(), 2);
  const mesh::Mesh mesh = mesh::distribute(mesh::read_mesh(given), PETSC_COMM_SELF);
  const double before = resident_mib();
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
  const modes::Operators operators(mesh, body);
  const modes::Factorisation factor(body.stiffness, body.mass);
  // The analysis of MUMPS keeps the structure of the factors besides; freed memory may be used again.
  EXPECT_NEAR((resident_mib() - before) / elasticity::expected_mib(mesh), 1, 0.5);
}

TEST(ExpectedSize, counts_the_entries_of_a_rod) {
  const test::SharedFile file(".geo",
                              "Point(1) = {0,0,0};\nPoint(2) = {2,0,0};\nLine(1) = {1,2};\n"
                              "Transfinite Curve{1} = 60;\nPhysical Curve(\"rod\") = {1};\n");
  const mesh::GmshSession gmsh;
  for (int order = 1; order <= 4; ++order) expect_size(test::body_of(file.path(), order), 1);
}

}  // namespace expected_size_test
}  // namespace ricochet
