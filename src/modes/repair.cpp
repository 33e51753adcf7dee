// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/repair.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/algebra.hpp"
#include "src/modes/certify.hpp"

namespace ricochet::modes {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Consecutive columns [first, end) of a team.
struct Cluster {
  Index first, end;
};

/// Divides columns into clusters of neighbours. A cluster extends by a margin to both sides, and to the ends
/// of multiple modes, but not beyond [begin, end), nor over modes of other teams.
std::vector<Cluster> clusters_of(const std::vector<Index>& columns, Index begin, const VectorXd& lambda,
                                 const std::vector<Index>& number) {
  constexpr Index margin = 4, most = 32;
  const Index end = lambda.size();
  const auto neighbours = [&](Index a, Index b) {
    return number[static_cast<std::size_t>(b)] == number[static_cast<std::size_t>(a)] + 1;
  };
  const auto same = [&](Index a, Index b) {
    return neighbours(a, b) && lambda[b] < (1 + kernels::multiple_mode) * lambda[a];
  };
  std::vector<Cluster> clusters;
  for (const Index column : columns) {
    Cluster here{column, column + 1};
    for (Index k = 0; k < margin || (here.first > begin && same(here.first - 1, here.first)); ++k)
      if (here.first > begin && neighbours(here.first - 1, here.first)) --here.first;
    for (Index k = 0; k < margin || (here.end < end && same(here.end - 1, here.end)); ++k)
      if (here.end < end && neighbours(here.end - 1, here.end)) ++here.end;
    if (!clusters.empty() && here.first < clusters.back().end && here.end - clusters.back().first <= most)
      clusters.back().end = here.end;
    else
      clusters.push_back(here);
  }
  return clusters;
}

/// The middle of the widest relative gap between the eigenvalues in the inner half of a cluster.
double shift_within(const VectorXd& lambda) {
  const Index n = lambda.size(), from = n / 4, to = std::max(from + 1, n - 1 - n / 4);
  double shift = lambda[n / 2] * (1 + 1e-4), widest = 0;
  for (Index k = from; k < to && k + 1 < n; ++k) {
    const double gap = lambda[k + 1] / lambda[k] - 1;
    if (gap <= widest) continue;
    widest = gap;
    shift = (lambda[k] + lambda[k + 1]) / 2;
  }
  return shift;
}

}  // namespace

std::vector<Index> repair(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                          const std::vector<Index>& modes, ModeSet& set) {
  constexpr int most_steps = 20;
  const Index rigid = operators.rigid.cols();
  const Index begin = !set.index.empty() && set.index.front() < rigid ? rigid : 0;
  VectorXd lambda(set.shape.cols());
  std::vector<Index> columns;
  for (Index j = 0; j < lambda.size(); ++j) {
    const Index number = set.index[static_cast<std::size_t>(j)];
    lambda[j] = std::pow(set.angular_frequency[static_cast<std::size_t>(number)], 2);
    if (j >= begin && std::ranges::binary_search(modes, number)) columns.push_back(j);
  }
  MatrixXd mine = MatrixXd::Zero(2, lambda.size());  // eigenvalues, and 1 for each that is changed
  for (const Cluster& cluster : clusters_of(columns, begin, lambda, set.index)) {
    const Index n = cluster.end - cluster.first;
    const bool lowest = set.index[static_cast<std::size_t>(cluster.first)] == rigid;
    auto shape = set.shape.middleCols(cluster.first, n);
    auto values = lambda.segment(cluster.first, n);
    mine.row(1).segment(cluster.first, n).setOnes();
    factor.factor(lowest ? -0.01 * values[n - 1] : shift_within(values));
    // Each step reduces an error by the ratio of distances from the shift, down to round-off.
    double before = 1;
    for (int step = 0; step < most_steps; ++step) {
      MatrixXd x = factor.solve(operators.mass(shape));
      x -= operators.rigid * inner(operators.comm, operators.rigid_momentum, x);
      x *= operators.norms(x).cwiseInverse().asDiagonal();
      const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> projected(
          inner(operators.comm, x, operators.stiffness(x)), inner(operators.comm, x, operators.mass(x)));
      shape = x * projected.eigenvectors();
      values = projected.eigenvalues();
      const double worst = operators.residuals(shape, values).maxCoeff();
      if (!(worst < 0.7 * before)) break;
      before = worst;
    }
  }
  mine.row(0) = lambda.transpose();
  const MatrixXd all = set.gather(teams, mine);
  std::vector<Index> changed;
  for (Index j = 0; j < all.cols(); ++j) {
    if (j >= rigid) set.angular_frequency[static_cast<std::size_t>(j)] = std::sqrt(all(0, j));
    if (all(1, j) > 0 || std::ranges::binary_search(modes, j)) changed.push_back(j);
  }
  fix_signs(operators, set.shape);
  return changed;
}

}  // namespace ricochet::modes
