// SPDX-License-Identifier: BSD-2-Clause
// Matrices that are read from a body file, compared with the dense matrices that were written.
#include "src/elasticity/matrix_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/hdf5_writer.hpp"
#include "src/elasticity/rigid.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"
#include "tests/support.hpp"

namespace ricochet {
namespace matrix_file_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using testing::HasSubstr;
using Complaint = std::string;

/// Rows of a matrix as a body file holds them.
struct Rows {
  std::vector<std::int64_t> start{0}, column;
  std::vector<double> value;

  explicit Rows(const MatrixXd& matrix) {
    for (Index i = 0; i < matrix.rows(); ++i) {
      for (Index j = 0; j < matrix.cols(); ++j)
        if (matrix(i, j) != 0) {
          column.push_back(j);
          value.push_back(matrix(i, j));
        }
      start.push_back(std::ssize(column));
    }
  }
  /// The value at (i, j), which is not zero.
  double& at(std::int64_t i, std::int64_t j) {
    for (auto k = static_cast<std::size_t>(start[static_cast<std::size_t>(i)]);; ++k)
      if (column.at(k) == j) return value[k];
  }
};

/// Nodes in general position. Neighbours in stiffness and in mass are different nodes, and no 3 × 3 block of
/// the stiffness is symmetric. The mass also couples x with y, which adds nothing to the mass of a direction.
struct Model {
  explicit Model(Index nodes, std::vector<Index> stiff = {1, 2, 4}, std::vector<Index> heavy = {1, 5})
      : position(3, nodes) {
    const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random_); };
    for (double& x : position.reshaped()) x = 2 + number();
    K = MatrixXd::Zero(3 * nodes, 3 * nodes);
    plain = M = 20 * MatrixXd::Identity(3 * nodes, 3 * nodes);
    for (Index a = 0; a < nodes; ++a) {
      for (const Index b : stiff)
        for (int repeated = 0; a + b < nodes && repeated < 3; ++repeated) {
          Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * nodes);
          for (int k = 0; k < 3; ++k) g[3 * a + k] = number(), g[3 * (a + b) + k] = number();
          K += g * g.transpose();
        }
      for (const Index b : heavy) {
        if (a + b >= nodes) continue;
        const double m = 2 + number();
        for (int k = 0; k < 3; ++k) plain(3 * a + k, 3 * (a + b) + k) = plain(3 * (a + b) + k, 3 * a + k) = m;
        M(3 * a, 3 * (a + b) + 1) = M(3 * (a + b) + 1, 3 * a) = number();
      }
    }
    M += plain - 20 * MatrixXd::Identity(3 * nodes, 3 * nodes);
    rigid.resize(3 * nodes, 6);
    for (Index a = 0; a < nodes; ++a)
      for (int k = 0; k < 3; ++k) {
        rigid.block<3, 1>(3 * a, k) = Vector3d::Unit(k);
        rigid.block<3, 1>(3 * a, 3 + k) = Vector3d::Unit(k).cross(position.col(a));
      }
  }
  Index nodes() const { return position.cols(); }

  Eigen::Matrix3Xd position;
  MatrixXd K, M;
  MatrixXd plain;  ///< M without the coupling of x with y
  MatrixXd rigid;  ///< (3n,6) e_x, e_y, e_z, e_x × x, e_y × x, e_z × x

 private:
  std::mt19937 random_{7};
};

/// A body file that rank 0 writes, and its matrices.
class Read {
 public:
  Read(const Model& model, std::vector<std::int64_t> fixed, const std::vector<std::string>& moved = {})
      : Read(model.position, Rows(model.K), Rows(model.M), std::move(fixed), moved) {}
  Read(const Eigen::Matrix3Xd& position, const Rows& K, const Rows& M, std::vector<std::int64_t> fixed = {},
       const std::vector<std::string>& moved = {}) {
    const test::SharedFile file(".h5", "");
    const auto nodes = static_cast<std::size_t>(position.cols());
    mesh::GlobalMesh global;
    global.position.assign(position.data(), position.data() + position.size());
    global.fixed = std::move(fixed);
    global.fixed.resize(nodes);
    parallel::on_first_rank(PETSC_COMM_WORLD, [&] {
      base::hdf5::Writer writer(file.path());
      writer.group("/");
      writer.attribute("/", "format", std::string("ricochet-body"));
      writer.attribute("/", "version", 1);
      writer.write("/node", global.position, {nodes, 3}, "m");
      for (const auto& [name, rows] : {std::pair("/stiffness", &K), std::pair("/mass", &M)}) {
        if (rows->start.empty()) continue;  // a file without this matrix
        writer.write(std::string(name) + "/start", rows->start, {rows->start.size()}, "");
        writer.write(std::string(name) + "/column", rows->column, {rows->column.size()}, "");
        writer.write(std::string(name) + "/value", rows->value, {rows->value.size()}, "");
      }
      writer.commit();
    });
    mesh = mesh::distribute(std::move(global), PETSC_COMM_WORLD);
    body = elasticity::read_matrices(mesh, file.path(), moved);
  }
  MatrixXd stiffness() const { return test::dense(mesh, body, body.stiffness); }
  MatrixXd mass() const { return test::dense(mesh, body, body.mass); }
  /// Rows of all ranks.
  MatrixXd whole(const MatrixXd& local) const {
    MatrixXd all = MatrixXd::Zero(body.total_rows, local.cols());
    all.middleRows(3 * mesh.first_node, body.local_rows) = local;
    parallel::sum(mesh.comm, all);
    return all;
  }
  std::vector<std::int64_t> parts() const {
    std::vector<std::int64_t> part(mesh.part.begin(), mesh.part.begin() + mesh.owned_nodes);
    part = parallel::gather(mesh.comm, part);
    parallel::broadcast(mesh.comm, part);
    return part;
  }

  mesh::Mesh mesh;
  elasticity::Body body;
};

MatInfo info_of(Mat matrix) {
  MatInfo info{};
  parallel::check(MatGetInfo(matrix, MAT_GLOBAL_SUM, &info));
  return info;
}

TEST(MatrixFile, gives_the_matrices_that_it_holds) {
  const Model model(11);
  const Read read(model, {});
  EXPECT_EQ(test::largest_entry(read.stiffness() - model.K), 0);
  EXPECT_EQ(test::largest_entry(read.mass() - model.M), 0);
  EXPECT_EQ(read.body.total_rows, 33);
  EXPECT_EQ(read.body.free_rows, 33);
  EXPECT_EQ(read.body.local_rows, 3 * read.mesh.owned_nodes);
  EXPECT_EQ(read.parts(), std::vector<std::int64_t>(11, 0));
  EXPECT_EQ(read.mesh.parts, 1);
}

// K − σM has the blocks of both. One more block would be memory that each factorisation and product takes.
TEST(MatrixFile, allocates_exactly_the_blocks_of_stiffness_and_mass_together) {
  const Model model(11);
  const Read read(model, {});
  double blocks = 0;
  for (Index a = 0; a < 11; ++a)
    for (Index b = a; b < 11; ++b)
      blocks += model.K.block<3, 3>(3 * a, 3 * b).any() || model.M.block<3, 3>(3 * a, 3 * b).any();
  for (Mat matrix : {static_cast<Mat>(read.body.stiffness), static_cast<Mat>(read.body.mass)}) {
    const MatInfo info = info_of(matrix);
    EXPECT_EQ(info.nz_used, 9 * blocks);
    EXPECT_EQ(info.nz_allocated, 9 * blocks);
  }
}

TEST(MatrixFile, has_the_mass_centre_and_inertia_of_its_rigid_motions) {
  const Model model(10);
  const Read read(model, {});
  const MatrixXd moved = model.rigid.leftCols(3);
  const double mass = moved.col(0).dot(model.plain * moved.col(0));
  EXPECT_NEAR(read.body.total_mass, mass, 1e-12 * mass);
  Vector3d centre;
  for (int k = 0; k < 3; ++k)
    centre[k] = moved.col(0).dot(model.plain * moved.col(0).cwiseProduct(
                                                   model.position.row(k).replicate(3, 1).reshaped())) /
                mass;
  EXPECT_LT((Vector3d(read.body.centre.data()) - centre).norm(), 1e-13);
  // Energy of rotations about the centre: e × (x − c).
  MatrixXd turned = model.rigid.rightCols(3);
  for (int k = 0; k < 3; ++k) turned.col(k) -= moved * Vector3d::Unit(k).cross(centre);
  const Eigen::Matrix3d inertia = turned.transpose() * model.plain * turned;
  EXPECT_LT((Eigen::Map<const Eigen::Matrix3d>(read.body.inertia.data()) - inertia).norm(),
            1e-12 * inertia.norm());
  EXPECT_GT(std::abs(inertia(0, 1)), 1e-2);
  EXPECT_LT(test::largest_entry(read.whole(read.body.rigid_load) - model.M * model.rigid), 1e-12 * mass);
}

TEST(MatrixFile, has_the_wave_speed_of_the_stiffest_uniform_stretch) {
  Model model(9);
  for (int stiffest = 0; stiffest < 3; ++stiffest) {
    SCOPED_TRACE(stiffest);
    double square = 0;
    for (int k = 0; k < 3; ++k) {
      Eigen::VectorXd u = Eigen::VectorXd::Zero(27);
      for (Index a = 0; a < 9; ++a) u[3 * a + k] = model.position(k, a);
      square = std::max(square, u.dot(model.K * u) / (model.plain.sum() / 3));
    }
    const Read read(model, {});
    // Of the moduli of Poisson's ratio 0.3, E is 0.52/0.7 of that of uniaxial strain.
    EXPECT_NEAR(read.body.wave_speed, std::sqrt(square * 0.52 / 0.7), 1e-12 * std::sqrt(square));
    model.position.row(stiffest) *= 10;
  }
}

/// Bits of supports: fixed components, and moving supports as bits 3, 4.
constexpr std::int64_t x = 1, y = 2, z = 4, first = 8, second = 16;

TEST(MatrixFile, couples_supports_with_the_free_rows) {
  const Model model(10);
  // The last node belongs to both supports: along x it moves with the first. Node 6 is fixed by a support at
  // rest.
  const std::vector<std::int64_t> fixed{
      0, x | y | first, 0, x | z | second, 0, 0, y, 0, 0, x | y | z | first | second};
  const Read read(model, fixed, {"xy", "xz"});
  MatrixXd shape = MatrixXd::Zero(30, 6);
  shape(3, 0) = shape(4, 1) = 1;
  shape(9, 3) = shape(11, 5) = 1;
  shape(27, 0) = shape(28, 1) = shape(29, 5) = 1;
  Eigen::VectorXd free = Eigen::VectorXd::Ones(30);
  for (const Index row : {3, 4, 9, 11, 19, 27, 28, 29}) free[row] = 0;
  const Eigen::VectorXd still = Eigen::VectorXd::Ones(30) - free;
  const auto kept = free.asDiagonal();

  EXPECT_EQ(read.body.free_rows, 22);
  const MatrixXd diagonal = model.K.diagonal().maxCoeff() * MatrixXd(still.asDiagonal());
  EXPECT_EQ(test::largest_entry(read.stiffness() - (kept * model.K * kept + diagonal)), 0);
  EXPECT_EQ(test::largest_entry(read.mass() - kept * model.M * kept), 0);
  const elasticity::Imposed& imposed = read.body.imposed;
  EXPECT_EQ(test::largest_entry(read.whole(imposed.shape) - shape), 0);
  EXPECT_LT(test::largest_entry(read.whole(imposed.force) + kept * model.K * shape), 1e-14);
  EXPECT_LT(test::largest_entry(read.whole(imposed.inertia) - kept * model.M * shape), 1e-14);
  EXPECT_LT(test::largest_entry(imposed.momentum - model.rigid.leftCols(3).transpose() * model.M * shape),
            1e-12);
  EXPECT_LT(test::largest_entry(read.whole(read.body.rigid_load) - kept * model.M * model.rigid), 1e-11);
}

TEST(MatrixFile, without_moving_supports_has_no_forcing) {
  const Read read(Model(6), {x | y | z, 0, y});
  EXPECT_EQ(read.body.imposed.shape.cols(), 0);
  EXPECT_EQ(read.body.imposed.force.cols(), 0);
  EXPECT_EQ(read.body.imposed.momentum.cols(), 0);
  EXPECT_EQ(read.body.free_rows, 14);
}

TEST(MatrixFile, holds_displacements_without_a_row) {
  Model model(9);
  for (const Index row : {5, 9, 10, 11})
    for (MatrixXd* matrix : {&model.K, &model.M, &model.plain}) {
      matrix->row(row).setZero();
      matrix->col(row).setZero();
    }
  const Read read(model, {y});
  std::vector<std::int64_t> fixed = parallel::gather(read.mesh.comm, read.mesh.fixed);
  parallel::broadcast(read.mesh.comm, fixed);
  EXPECT_EQ(fixed, (std::vector<std::int64_t>{y, z, 0, x | y | z, 0, 0, 0, 0, 0}));
  EXPECT_EQ(read.body.free_rows, 27 - 5);
  EXPECT_EQ(read.mesh.parts, 1);
  EXPECT_EQ(read.parts(), std::vector<std::int64_t>(9, 0));
  // The mass is the mean of those along x, y and z, which differ here.
  EXPECT_NEAR(read.body.total_mass, model.plain.sum() / 3, 1e-12 * model.plain.sum());
  MatrixXd K = model.K;
  for (const Index row : {1, 5, 9, 10, 11}) {
    K.row(row).setZero();
    K.col(row).setZero();
    K(row, row) = model.K.diagonal().maxCoeff();
  }
  EXPECT_EQ(test::largest_entry(read.stiffness() - K), 0);
}

TEST(MatrixFile, numbers_unconnected_parts_by_their_first_nodes_each_with_six_rigid_motions) {
  const Model model(12, {3, 6}, {3});
  Rows K(model.K);
  // Zeros that are stored between parts 0 and 1 do not connect them.
  for (const auto& [i, j] : {std::pair(0, 3), std::pair(3, 0)}) {
    const auto at = std::lower_bound(K.column.begin() + K.start[static_cast<std::size_t>(i)],
                                     K.column.begin() + K.start[static_cast<std::size_t>(i) + 1], j) -
                    K.column.begin();
    K.column.insert(K.column.begin() + at, j);
    K.value.insert(K.value.begin() + at, 0);
    for (std::size_t row = static_cast<std::size_t>(i) + 1; row < K.start.size(); ++row) ++K.start[row];
  }
  const Read read(model.position, K, Rows(model.M));
  EXPECT_EQ(read.parts(), (std::vector<std::int64_t>{0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}));
  ASSERT_EQ(read.mesh.parts, 3);
  const MatrixXd rigid = read.whole(elasticity::rigid_modes(read.mesh, read.body));
  ASSERT_EQ(rigid.cols(), 18);
  EXPECT_LT(test::largest_entry(rigid.transpose() * model.M * rigid - MatrixXd::Identity(18, 18)), 1e-12);
  for (Index part = 0; part < 3; ++part) {
    const auto own = rigid.middleCols(6 * part, 6);
    MatrixXd motions = model.rigid;
    for (Index a = 0; a < 12; ++a)
      if (a % 3 != part) {
        EXPECT_EQ(test::largest_entry(own.middleRows(3 * a, 3)), 0);
        motions.middleRows(3 * a, 3).setZero();
      }
    // They are combinations of the rigid motions of that part.
    const MatrixXd combined = motions * motions.householderQr().solve(own);
    EXPECT_LT(test::largest_entry(combined - own), 1e-12);
  }
}

/// The complaint about a changed file.
template <class Change>
Complaint refusal(Change&& change, const Model& model = Model(7)) {
  Rows K(model.K), M(model.M);
  change(K, M);
  return test::complaint_of([&] { Read(model.position, K, M); });
}

TEST(MatrixFile, without_matrices_or_with_those_of_other_nodes_is_refused) {
  EXPECT_THAT(refusal([](Rows& K, Rows& M) { K.start.clear(), M.start.clear(); }),
              HasSubstr("has neither \"/stiffness\" and \"/mass\" nor \"/modes\""));
  EXPECT_THAT(refusal([](Rows&, Rows& M) { M.start.clear(); }), HasSubstr("has neither"));
  EXPECT_THAT(refusal([](Rows&, Rows& M) { M = Rows(Model(6).M); }),
              HasSubstr("\"/mass/start\" is of a matrix of 18 rows: 7 nodes have 21, three each"));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { K = Rows(Model(8).K); }),
              HasSubstr("\"/stiffness/start\" is of a matrix of 24 rows: 7 nodes have 21"));
}

TEST(MatrixFile, whose_rows_do_not_ascend_is_refused) {
  const auto entries = std::to_string(Rows(Model(7).K).column.size());
  const std::string start = "\"/stiffness/start\" does not ascend from 0 to the " + entries + " entries";
  EXPECT_THAT(refusal([](Rows& K, Rows&) { K.start[0] = 1; }), HasSubstr(start));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { std::swap(K.start[4], K.start[5]); }), HasSubstr(start));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { --K.start.back(); }), HasSubstr(start));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { K.column[1] = K.column[0]; }),
              HasSubstr("\"/stiffness/column\" has 0 after 0 in row 0: columns must ascend and be below 21"));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { K.column.back() = 21; }),
              HasSubstr("\"/stiffness/column\" has 21 after 19 in row 20"));
  EXPECT_THAT(refusal([](Rows& K, Rows&) { K.column[0] = -1; }), HasSubstr("has -1 after -1 in row 0"));
  EXPECT_THAT(refusal([](Rows&, Rows& M) { M.at(4, 4) = std::numeric_limits<double>::infinity(); }),
              HasSubstr("\"/mass\" holds inf in row 4"));
}

// 1e-9 of the sum of both diagonal entries may be the last digit of a printed matrix.
TEST(MatrixFile, that_is_not_symmetric_is_refused) {
  const Model model(7);
  for (const bool stiffness : {true, false}) {
    const MatrixXd& matrix = stiffness ? model.K : model.M;
    const double most = 1e-9 * (matrix(3, 3) + matrix(6, 6));
    const auto bent = [&](double share) {
      return [&, share](Rows& K, Rows& M) { (stiffness ? K : M).at(6, 3) += share * most; };
    };
    EXPECT_THAT(refusal(bent(1.01)), HasSubstr(fmt::format("\"{}\" is not symmetric: row 3 has",
                                                           stiffness ? "/stiffness" : "/mass")));
    EXPECT_THAT(refusal(bent(-1.01)), HasSubstr("both triangles are required"));
    Rows K(model.K), M(model.M);
    bent(0.99)(K, M);
    EXPECT_NO_THROW(Read(model.position, K, M));
  }
  // The lower triangle alone.
  EXPECT_THAT(refusal([&](Rows& K, Rows&) { K = Rows(model.K.triangularView<Eigen::Lower>()); }),
              HasSubstr("is not symmetric"));
}

TEST(MatrixFile, with_a_diagonal_that_is_not_positive_is_refused) {
  const auto struck = [](MatrixXd matrix, Index row, double diagonal) {
    matrix.row(row).setZero();
    matrix.col(row).setZero();
    matrix(row, row) = diagonal;
    return Rows(matrix);
  };
  const Model model(7);
  EXPECT_THAT(refusal([&](Rows& K, Rows&) { K = struck(model.K, 7, -2.5); }),
              HasSubstr("\"/stiffness\" has -2.5 on its diagonal in row 7 (node 2, y)"));
  EXPECT_THAT(refusal([&](Rows& K, Rows&) { K = struck(model.K, 8, 0); }),
              HasSubstr("\"/stiffness\" has 0 on its diagonal in row 8 (node 2, z)"));
  EXPECT_THAT(
      refusal([&](Rows&, Rows& M) { M = struck(model.M, 6, -1); }),
      HasSubstr("\"/mass\" is not positive definite: it has -1 on its diagonal in row 6 (node 2, x)"));
  EXPECT_THAT(refusal([&](Rows&, Rows& M) { M = struck(model.M, 6, 0); }),
              HasSubstr("\"/mass\" is not positive definite: it has 0 on its diagonal in row 6"));
}

TEST(MatrixFile, with_nodes_that_may_belong_to_any_of_several_parts_is_refused) {
  const auto without_node = [](Model model, Index node) {
    for (MatrixXd* matrix : {&model.K, &model.M}) {
      matrix->middleRows(3 * node, 3).setZero();
      matrix->middleCols(3 * node, 3).setZero();
    }
    return model;
  };
  const Model two = without_node(Model(9, {2, 4}, {2}), 4);
  EXPECT_THAT(test::complaint_of([&] { Read(two, {}); }),
              HasSubstr("\"/stiffness\" has 2 unconnected parts, and nodes without rows"));
  // The first part begins after a node without rows.
  const Read read(without_node(Model(9), 0), {});
  EXPECT_EQ(read.mesh.parts, 1);
}

TEST(MatrixFile, whose_mass_depends_on_the_direction_is_refused) {
  const Model model(7);
  const double mass = model.plain.sum() / 3;
  for (int k = 0; k < 3; ++k) {
    const auto heavier = [&](double share) {
      return [&, share](Rows&, Rows& M) { M.at(9 + k, 9 + k) += share * mass; };
    };
    EXPECT_THAT(refusal(heavier(1.1e-6)), HasSubstr("masses must be equal in all directions"));
    EXPECT_THAT(refusal(heavier(-1.1e-6)), HasSubstr("the mass is"));
    Rows K(model.K), M(model.M);
    heavier(0.9e-6)(K, M);
    EXPECT_NO_THROW(Read(model.position, K, M));
  }
  // A body whose nodes have no displacement along z.
  Model flat(7);
  for (Index row = 2; row < 21; row += 3)
    for (MatrixXd* matrix : {&flat.K, &flat.M}) {
      matrix->row(row).setZero();
      matrix->col(row).setZero();
    }
  EXPECT_THAT(test::complaint_of([&] { Read(flat, {}); }), HasSubstr(", 0 along z"));
}

}  // namespace matrix_file_test
}  // namespace ricochet
