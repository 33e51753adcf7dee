// SPDX-License-Identifier: BSD-2-Clause
// The compact residual flexibility, compared with the dense matrix from which it is made.
#include "kernels/compression.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "kernels/algebra.hpp"
#include "kernels/band.hpp"
#include "kernels/flexibility.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace compression_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::complaint_of;
using test::Folder;

constexpr std::size_t M = 200;

/// Points that are spread evenly over a unit sphere, and R that decays like 1/r: a sum of covariances
/// e^(−r/l) of several lengths l, each times a definite matrix between components. Some candidates yield
/// three times as much, as those at corners do.
struct Body {
  Surface surface;
  MatrixXd R = MatrixXd::Zero(3 * M, 3 * M);
  double spacing = std::sqrt(4 * std::numbers::pi / M);

  Body() {
    surface.components = 3;
    surface.area.assign(M, 4 * std::numbers::pi / M);
    for (std::size_t i = 0; i < M; ++i) {
      const double z = 1 - (2 * static_cast<double>(i) + 1) / M, r = std::sqrt(1 - z * z),
                   angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
      for (const double x : {r * std::cos(angle), r * std::sin(angle), z}) surface.node.push_back(x);
    }
    for (std::size_t i = 0; i < M; ++i)
      for (std::size_t j = 0; j < M; ++j)
        for (int k = 0; k < 4; ++k) {
          const double length = spacing * std::exp2(k);
          Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
          C(0, 1) = C(1, 0) = 0.3 * std::cos(k);
          C(1, 2) = C(2, 1) = 0.3 * std::sin(k);
          R.block<3, 3>(3 * static_cast<Index>(i), 3 * static_cast<Index>(j)) +=
              give(i) * give(j) * std::exp2(-k) * std::exp(-distance(i, j) / length) * 1e-7 * C;
        }
    surface.residual_flexibility.assign(R.data(), R.data() + R.size());
  }
  double give(std::size_t i) const { return i % 17 == 0 ? 1.7 : 1; }
  double distance(std::size_t i, std::size_t j) const {
    const auto at = [&](std::size_t k) { return Eigen::Map<const Vector3d>(&surface.node[3 * k]); };
    return (at(i) - at(j)).norm();
  }
};

/// Makes R of a surface compressed, although the surface has few candidates.
Surface compressed_surface(const Body& body, double radius) {
  Surface surface = body.surface;
  make_compact(surface, {.most_whole = 0, .radius = radius});
  return surface;
}

MatrixXd matrix(const Surface& surface) {
  const Flexibility R(surface);
  const auto rows = 3 * static_cast<Index>(surface.size());
  MatrixXd out(rows, rows);
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> block;
  for (Index i = 0; i < rows / 3; ++i)
    for (Index j = 0; j < rows / 3; ++j) {
      R.block(static_cast<std::size_t>(i), static_cast<std::size_t>(j), block.data());
      out.block<3, 3>(3 * i, 3 * j) = block;
    }
  return out;
}

double lowest(const MatrixXd& R) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

/// Largest error of a displacement under a unit force at any candidate, as a share of that of the candidate
/// itself, and the one among pairs within a distance of each other.
std::pair<double, double> errors(const Body& body, const MatrixXd& found, double near) {
  double all = 0, of_near = 0;
  for (std::size_t j = 0; j < M; ++j)
    for (std::size_t i = 0; i < M; ++i)
      for (Index b = 0; b < 3; ++b) {
        const auto row = 3 * static_cast<Index>(i), own = 3 * static_cast<Index>(j), column = own + b;
        const double error =
            (found - body.R).block<3, 1>(row, column).norm() / body.R.block<3, 1>(own, column).norm();
        all = std::max(all, error);
        if (body.distance(i, j) <= near) of_near = std::max(of_near, error);
      }
  return {all, of_near};
}

TEST(Compression, keeps_what_is_near_and_states_the_error_of_the_rest) {
  const Body body;
  constexpr double radius = 2.5;  // in spacings of the candidates that are kept whole
  const Surface surface = compressed_surface(body, radius);
  ASSERT_TRUE(surface.residual_flexibility.empty());
  const CompactFlexibility& made = *surface.compact;
  // Every second or third candidate, in each direction.
  EXPECT_GT(made.columns, 3 * M / 10);
  EXPECT_LT(made.columns, 3 * M / 3);
  const MatrixXd found = matrix(surface);
  EXPECT_EQ((found - found.transpose()).cwiseAbs().maxCoeff(), 0);
  EXPECT_GE(lowest(found), 0);
  // Single precision; sums of 150 products add a little.
  const auto [all, near] = errors(body, found, radius * 1.5 * body.spacing);
  EXPECT_LT(near, 1e-5);
  // The error is measured at 64 of 200 candidates.
  EXPECT_GT(made.error, 1e-4);
  EXPECT_LE(made.error, all);
  EXPECT_GT(made.error, 0.4 * all);
  EXPECT_LT(all, 0.02);
  // Less is kept than there is.
  const auto stored = made.global.size() + made.near_block.size();
  EXPECT_LT(stored, 9 * M * M * 2 / 3);
  // A wider radius keeps more.
  EXPECT_LT(compressed_surface(body, 2 * radius).compact->error, 0.5 * made.error);
}

/// Blocks of a wide E that are cut off close by leave an indefinite matrix.
TEST(Compression, raises_the_diagonal_where_truncation_would_cost_definiteness) {
  const Body body;
  for (const double radius : {0.25, 0.35, 0.45}) {
    Surface surface = body.surface;
    make_compact(surface, {.most_whole = 0, .spacing = 5, .radius = radius});
    MatrixXd found = matrix(surface);
    EXPECT_GE(lowest(found), 0) << radius;
    const Eigen::VectorXd raised = (found - body.R).diagonal();
    EXPECT_GT(raised.maxCoeff(), 1e-4 * body.R.diagonal().maxCoeff()) << radius;
    EXPECT_GT(surface.compact->error, 1e-3) << radius;
    found.diagonal() -= raised;
    EXPECT_LT(lowest(found), 0) << radius << ": nothing to show";
  }
}

/// On a line, where each candidate is near two others only, every two of them have a definite E, but all
/// together have not: 1 − 2 · 0.7 < 0.
TEST(Compression, proves_definiteness_of_the_whole_and_not_of_parts) {
  Surface line;
  constexpr std::size_t count = 40;
  line.area.assign(count, 1);
  line.residual_flexibility.assign(9 * count * count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    line.node.insert(line.node.end(), {static_cast<double>(i), 0, 0});
    for (std::size_t j = 0; j < count; ++j)
      for (std::size_t a = 0; a < 3; ++a) {
        const double r = static_cast<double>(i) - static_cast<double>(j);
        line.residual_flexibility[(3 * i + a) * 3 * count + 3 * j + a] = std::exp(-0.35 * r * r);
      }
  }
  make_compact(line, {.most_whole = 0, .most_global = 1, .radius = 1.05 / (count - 1)});
  ASSERT_EQ(line.compact->columns, 3);
  const auto next = static_cast<std::size_t>(line.compact->near_first[20]) + 1;  // of 20 and 21
  EXPECT_NEAR(line.compact->near_block[9 * next], std::exp(-0.35), 1e-6);
  EXPECT_GE(lowest(matrix(line)), 0);
}

/// R of rank 3, whose eigenvalues of 0 rounding moves to both sides.
TEST(Compression, to_single_precision_keeps_a_singular_matrix_semidefinite) {
  Body body;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const MatrixXd V = MatrixXd::NullaryExpr(3 * M, 3, [&](Index, Index) { return normal(random); });
  body.R = V * V.transpose();
  EXPECT_LT(lowest(body.R.cast<float>().cast<double>()), -1e-7 * body.R.diagonal().mean());
  body.surface.residual_flexibility.assign(body.R.data(), body.R.data() + body.R.size());
  make_compact(body.surface);
  ASSERT_EQ(body.surface.compact->whole.size(), 9 * M * M);
  EXPECT_EQ(body.surface.compact->error, 0);
  const MatrixXd found = matrix(body.surface);
  EXPECT_EQ((found - found.transpose()).cwiseAbs().maxCoeff(), 0);
  // The eigenvalue solver rounds, too.
  EXPECT_GE(lowest(found), -1e-12 * body.R.trace());
  const Eigen::VectorXd sums = body.R.cwiseAbs().rowwise().sum(), raised = (found - body.R).diagonal();
  EXPECT_LE((raised - 1.01 * 0x1p-24 * sums).cwiseQuotient(body.R.diagonal()).maxCoeff(), 0x1p-23);
  EXPECT_GE(raised.minCoeff(), 0);
}

TEST(Compression, rows_are_those_of_the_matrix) {
  const Body body;
  for (const Surface& surface : {body.surface, compressed_surface(body, 2)}) {
    const MatrixXd R = matrix(surface);
    for (const std::size_t row : {0, 5, 451}) {
      Eigen::VectorXd sum = Eigen::VectorXd::Ones(3 * M);
      Flexibility(surface).add_row(row, 3e7, sum.data());
      EXPECT_LT((sum - Eigen::VectorXd::Ones(3 * M) - 3e7 * R.row(static_cast<Index>(row)).transpose())
                    .cwiseAbs()
                    .maxCoeff(),
                1e-12);
    }
  }
}

TEST(Compression, norms_are_bounded) {
  const Body body;
  EXPECT_NEAR(norm_bound(body.surface) / body.R.norm(), 1, 1e-12);
  Surface single = body.surface;
  make_compact(single);
  EXPECT_NEAR(norm_bound(single) / body.R.norm(), 1, 1e-5);
  EXPECT_NEAR(norm_bound(compressed_surface(body, 2)) / body.R.trace(), 1, 1e-3);
}

/// A kernel of the sphere with modes of random shapes.
Kernel kernel_of(const Body& body, const Compression& how) {
  Kernel kernel = test::plain_kernel(3, 5, M);
  kernel.view.reset();
  kernel.surface.area = body.surface.area;
  kernel.surface.node = body.surface.node;
  kernel.surface.residual_flexibility = body.surface.residual_flexibility;
  kernel.modes.certificate.left_out = 0;
  kernel.modes.certificate.count_found = 5;
  kernel.modes.certificate.shift.clear();
  kernel.modes.certificate.modes_below.clear();
  make_compact(kernel.surface, how);
  return kernel;
}

const Compression whole{}, parts{.most_whole = 0, .radius = 2};

TEST(CompactKernel, comes_back_from_its_file) {
  const Folder folder;
  const Body body;
  for (const Compression& how : {whole, parts}) {
    const Kernel kernel = kernel_of(body, how);
    write(kernel, folder.path() / "k.kernel.h5");
    const Kernel back = read(folder.path() / "k.kernel.h5");
    EXPECT_EQ(back.surface.compact, kernel.surface.compact);
    EXPECT_TRUE(back.surface.residual_flexibility.empty());
  }
}

TEST(CompactKernel, with_blocks_of_candidates_that_do_not_exist_is_refused) {
  const Body body;
  const Kernel kernel = kernel_of(body, parts);
  const auto complaint = [&](auto spoil) {
    Kernel spoilt = kernel;
    spoil(*spoilt.surface.compact);
    return complaint_of([&] { validate(spoilt, "FILE"); });
  };
  using testing::HasSubstr;
  EXPECT_NO_THROW(validate(kernel, "FILE"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { R.near_candidate.back() = M; }),
              HasSubstr("near_candidate\" contains 200 at index"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { std::swap(R.near_candidate[0], R.near_candidate[1]); }),
              HasSubstr("is not ascending"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { R.near_first[1] = -4; }), HasSubstr("does not ascend"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { R.near_first.pop_back(); }), HasSubstr("has 200 values"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { R.columns = 7; }), HasSubstr("expected 4200"));
  EXPECT_THAT(complaint([](CompactFlexibility& R) { R.error = -1; }), HasSubstr("\"error\""));
}

/// What is done to a compact kernel is what is done to the whole one.
TEST(CompactKernel, is_scaled_restricted_and_truncated_as_a_whole_one) {
  const Body body;
  const std::vector<std::int64_t> points{120, 3, 17, 18, 19, 150, 4, 199};
  for (const Compression& how : {whole, parts}) {
    const Kernel kernel = kernel_of(body, how);
    const MatrixXd R = matrix(kernel.surface);
    const double scale = R.diagonal().maxCoeff();
    const auto differ = [&](const Kernel& changed, const MatrixXd& expected) {
      const MatrixXd found = matrix(changed.surface);
      EXPECT_GE(lowest(found), 0);
      return (found - expected).cwiseAbs().maxCoeff() / expected.diagonal().maxCoeff();
    };
    // Rounded again, with the diagonal raised by 2⁻²⁴ times the sum of a row.
    EXPECT_LT(differ(rescaled(kernel, {.young = 3, .scale = 1.7}, {}), R / (3 * 1.7)), 2e-5);
    std::vector<Index> rows;
    for (const std::int64_t i : points)
      for (Index a = 0; a < 3; ++a) rows.push_back(3 * i + a);
    EXPECT_EQ(differ(restricted_to_points(kernel, points), R(rows, rows)), 0);
    const double cut = kernel.modes.angular_frequency[2] * 1.01;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const RowMajor> shape(kernel.surface.shape.data(), 3 * M, 5);
    MatrixXd more = R;
    for (Index n = 3; n < 5; ++n)
      more += shape.col(n) * shape.col(n).transpose() /
              std::pow(kernel.modes.angular_frequency[static_cast<std::size_t>(n)], 2);
    EXPECT_LT(differ(truncated_above(kernel, RadPerSecond{cut}), more), 2e-5);
    EXPECT_GT((more - R).cwiseAbs().maxCoeff(), scale);
    EXPECT_EQ(compacted(kernel).surface.compact, kernel.surface.compact);
    EXPECT_NE(complaint_of([&] { restricted_to_direction(kernel, {0, 0, 1}); }), "");
  }
}

}  // namespace compression_test
}  // namespace ricochet::kernels
