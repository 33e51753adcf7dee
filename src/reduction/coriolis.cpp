// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/coriolis.hpp"

#include <algorithm>
#include <array>

#include "src/modes/product.hpp"

namespace ricochet::reduction {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Returns Σ a_m × b_n over the nodes of this rank, for all columns m of a and n of b. By components.
std::array<MatrixXd, 3> cross_products(const Eigen::Ref<const MatrixXd>& a,
                                       const Eigen::Ref<const MatrixXd>& b) {
  const auto components = [](const Eigen::Ref<const MatrixXd>& of) {
    std::array<MatrixXd, 3> out;
    for (Index k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(k)] = of(Eigen::seq(k, Eigen::last, 3), Eigen::all);
    return out;
  };
  const std::array<MatrixXd, 3> x = components(a), y = components(b);
  std::array<MatrixXd, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    out[k].noalias() = x[i].transpose() * y[j];
    out[k].noalias() -= x[j].transpose() * y[i];
  }
  return out;
}

}  // namespace

kernels::Coriolis coriolis(const parallel::Teams& teams, Mat mass, const modes::ModeSet& set) {
  const std::vector<double>& omega = set.angular_frequency;
  const auto all = std::ssize(omega);
  kernels::Coriolis out;
  std::vector<std::int64_t> first;  // pair of each mode with the next one
  for (std::int64_t m = 0; m < all; ++m) {
    first.push_back(std::ssize(out.pair) / 2);
    for (std::int64_t n = m + 1; n < all && kernels::nearly_equal(omega[m], omega[n]); ++n)
      out.pair.insert(out.pair.end(), {m, n});
  }
  if (out.pair.empty()) return out;
  out.coupling.assign(out.pair.size() / 2 * 3, 0);

  // Each team multiplies its own columns by M, in panels, and passes them on to the others.
  constexpr Index panel = 64;
  const modes::BlockProduct product(mass);
  const Index rows = set.shape.rows(), columns = set.shape.cols();
  const auto most = static_cast<Index>(parallel::largest(teams.peers(), static_cast<double>(columns)));
  for (Index from = 0; from < most; from += panel) {
    const Index own = std::clamp<Index>(columns - from, 0, panel);
    MatrixXd momentum(rows, 0);
    std::vector<Index> number;
    if (own > 0) {
      momentum = product(set.shape.middleCols(from, own));
      number.assign(set.index.begin() + from, set.index.begin() + from + own);
    }
    for (int t = 0; t < teams.count(); ++t) {
      const auto width = parallel::of_rank<std::int64_t>(teams.peers(), t, own);
      if (width == 0) continue;
      std::vector<Index> theirs = number;
      parallel::broadcast(teams.peers(), theirs, t);
      MatrixXd passed;
      if (teams.mine() == t)
        passed = momentum;
      else
        passed.resize(rows, width);
      MPI_Bcast(passed.data(), static_cast<int>(rows * width), MPI_DOUBLE, t, teams.peers());
      // Own modes below the last of theirs that are nearly equal to the first of theirs, or above it.
      const auto end = std::ranges::lower_bound(set.index, theirs.back()) - set.index.begin();
      const auto begin = std::ranges::find_if(set.index.begin(), set.index.begin() + end,
                                              [&](Index m) {
                                                return m >= theirs.front() ||
                                                       kernels::nearly_equal(omega[m], omega[theirs.front()]);
                                              }) -
                         set.index.begin();
      if (begin == end) continue;
      const auto sums = cross_products(set.shape.middleCols(begin, end - begin), passed);
      for (Index i = begin; i < end; ++i)
        for (Index j = 0; j < width; ++j) {
          const Index m = set.index[static_cast<std::size_t>(i)], n = theirs[static_cast<std::size_t>(j)];
          if (m >= n || !kernels::nearly_equal(omega[m], omega[n])) continue;
          for (std::size_t k = 0; k < 3; ++k)
            out.coupling[3 * (first[m] + n - m - 1) + k] = sums[k](i - begin, j);
        }
    }
  }
  parallel::sum(teams.world(), out.coupling);
  return out;
}

}  // namespace ricochet::reduction
