// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/certify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace ricochet::modes {

namespace {

/// Bound on max |ΦᵀMΦ − I|. Two modes from different shifts, with residuals up to r, are orthogonal to within
/// 2rλ/Δλ; for r = 1e-8 and neighbours 2 % apart, this is the bound. A mode that was found twice would
/// give 1. Ritz vectors of one space are orthogonal whatever their residuals.
constexpr double orthonormality_of_modes = 1e-6, orthonormality_of_ritz_vectors = 1e-8;

/// Computes residuals and overlaps of the modes in `changed`. Each team multiplies its own columns, in
/// panels, because K Φ and M Φ are as large as Φ. The M Φ of each team is then compared with the columns of
/// the others.
/// @param changed  numbers of modes, ascending
/// @return the modes whose residuals exceed both `tolerance` and round-off, or whose overlap exceeds `bound`
std::vector<Eigen::Index> measure(const parallel::Teams& teams, const Operators& operators,
                                  std::optional<double> tolerance, double bound,
                                  const std::vector<Eigen::Index>& changed, ModeSet& set) {
  constexpr Eigen::Index panel = 64;
  const Eigen::MatrixXd& shape = set.shape;
  const auto number = [&](Eigen::Index j) { return set.index[static_cast<std::size_t>(j)]; };
  const auto all = static_cast<Eigen::Index>(set.angular_frequency.size());
  const bool whole = std::ssize(changed) == all;
  Eigen::RowVectorXd residual = Eigen::RowVectorXd::Zero(all), excess = residual, overlap = residual;
  const double stiffest =
      parallel::largest(operators.comm, operators.diagonal.size() > 0 ? operators.diagonal.maxCoeff() : 0);
  std::vector<Eigen::Index> mine;
  for (Eigen::Index j = 0; j < shape.cols(); ++j)
    if (std::ranges::binary_search(changed, number(j))) mine.push_back(j);
  const auto most =
      static_cast<Eigen::Index>(parallel::largest(teams.peers(), static_cast<double>(mine.size())));
  for (Eigen::Index from = 0; from < most; from += panel) {
    const auto own = std::clamp<Eigen::Index>(std::ssize(mine) - from, 0, panel);
    std::vector<Eigen::Index> place(mine.begin() + std::min(from, std::ssize(mine)),
                                    mine.begin() + std::min(from + own, std::ssize(mine)));
    std::vector<Eigen::Index> columns;
    for (const Eigen::Index j : place) columns.push_back(number(j));
    Eigen::MatrixXd momentum(shape.rows(), own);
    if (own > 0) {
      const Eigen::MatrixXd vectors = shape(Eigen::all, place);
      momentum = operators.mass(vectors);
      const Eigen::MatrixXd force = operators.stiffness(vectors);
      Eigen::VectorXd lambda(own), scale = operators.norms(force);
      for (Eigen::Index k = 0; k < own; ++k) {
        const auto n = static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]);
        lambda[k] = std::pow(set.angular_frequency[n], 2);
        // For rigid modes, ‖Kφ‖ vanishes, so it cannot serve as the scale.
        if (lambda[k] == 0) scale[k] = stiffest * operators.norms(vectors.col(k))[0];
      }
      const Eigen::VectorXd relative =
          operators.norms(force - momentum * lambda.asDiagonal()).cwiseQuotient(scale);
      for (Eigen::Index k = 0; k < own; ++k) {
        const Eigen::Index n = columns[static_cast<std::size_t>(k)];
        residual[n] = relative[k];
        if (tolerance && !(relative[k] <= *tolerance) &&
            !(relative[k] <= operators.round_off(vectors.col(k))[0]))
          excess[n] = std::isfinite(relative[k]) ? relative[k] : 1;
      }
    }
    for (int t = 0; t < teams.count(); ++t) {
      std::int64_t n = own;
      MPI_Bcast(&n, 1, MPI_INT64_T, t, teams.peers());
      if (n == 0) continue;
      std::vector<Eigen::Index> theirs = columns;
      parallel::broadcast(teams.peers(), theirs, t);
      Eigen::MatrixXd product;
      if (teams.mine() != t) product.resize(shape.rows(), n);
      MPI_Bcast(teams.mine() == t ? momentum.data() : product.data(), static_cast<int>(shape.rows() * n),
                MPI_DOUBLE, t, teams.peers());
      // One product suffices for two modes that are both measured.
      if (whole && teams.mine() < t) continue;
      const Eigen::Index rows = whole && teams.mine() == t ? from + n : shape.cols();
      Eigen::MatrixXd gram =
          inner(operators.comm, shape.leftCols(rows), teams.mine() == t ? momentum : product);
      for (Eigen::Index k = 0; teams.mine() == t && k < n; ++k)
        gram(place[static_cast<std::size_t>(k)], k) -= 1;
      // A comparison with NaN is false.
      gram = gram.cwiseAbs().unaryExpr([](double value) { return value < 1 ? value : 1; });
      for (Eigen::Index i = 0; i < rows; ++i)
        for (Eigen::Index k = 0; k < n; ++k) {
          double &one = overlap[number(i)], &other = overlap[theirs[static_cast<std::size_t>(k)]];
          one = std::max(one, gram(i, k));
          other = std::max(other, gram(i, k));
        }
    }
  }
  parallel::sum(teams.peers(), residual);
  parallel::sum(teams.peers(), excess);
  MPI_Allreduce(MPI_IN_PLACE, overlap.data(), static_cast<int>(all), MPI_DOUBLE, MPI_MAX, teams.peers());
  set.residual.resize(static_cast<std::size_t>(all));
  set.overlap.resize(static_cast<std::size_t>(all));
  for (const Eigen::Index n : changed) {
    set.residual[static_cast<std::size_t>(n)] = residual[n];
    set.overlap[static_cast<std::size_t>(n)] = 0;
  }
  std::vector<Eigen::Index> doubtful;
  for (Eigen::Index n = 0; n < all; ++n) {
    double& largest = set.overlap[static_cast<std::size_t>(n)];
    largest = std::max(largest, overlap[n]);
    if (excess[n] > 0 || !(largest < bound)) doubtful.push_back(n);
  }
  return doubtful;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::ranges::max_element(values);
}

std::vector<Eigen::Index> all_modes(const ModeSet& set) {
  std::vector<Eigen::Index> all(set.angular_frequency.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

void fix_signs(const Operators& operators, Eigen::MatrixXd& shape) {
  for (Eigen::Index j = 0; j < shape.cols(); ++j) {
    const double top =
        parallel::largest(operators.comm, shape.rows() > 0 ? shape.col(j).cwiseAbs().maxCoeff() : 0);
    struct {
      double order;
      int rank;
    } mine{1e300, parallel::rank_of(operators.comm)}, first{};
    double value = 0;
    for (Eigen::Index i = 0; i < shape.rows(); ++i) {
      const auto order = static_cast<double>(operators.key[static_cast<std::size_t>(i)]);
      if (std::abs(shape(i, j)) < 0.999 * top || order >= mine.order) continue;
      mine.order = order;
      value = shape(i, j);
    }
    MPI_Allreduce(&mine, &first, 1, MPI_DOUBLE_INT, MPI_MINLOC, operators.comm);
    MPI_Bcast(&value, 1, MPI_DOUBLE, first.rank, operators.comm);
    if (value < 0) shape.col(j) = -shape.col(j);
  }
}

std::vector<Eigen::Index> certify(const parallel::Teams& teams, const Operators& operators,
                                  const std::vector<Probe>& counts, double tolerance, ModeSet& set,
                                  const std::optional<std::vector<Eigen::Index>>& changed) {
  const std::vector<Eigen::Index> doubtful =
      measure(teams, operators, tolerance, orthonormality_of_modes, changed ? *changed : all_modes(set), set);

  kernels::Certificate& certificate = set.certificate;
  certificate.shift.clear();
  certificate.modes_below.clear();
  certificate.upto_hz = std::sqrt(set.cut) / (2 * std::numbers::pi);
  certificate.count_found = static_cast<std::int64_t>(set.angular_frequency.size());
  certificate.orthonormality = largest(set.overlap);
  bool agree = !counts.empty();
  for (const Probe& at : counts) {
    const auto found =
        std::ranges::count_if(set.angular_frequency, [&](double omega) { return omega * omega < at.sigma; });
    agree = agree && found == at.below;
    certificate.shift.push_back(at.sigma);
    certificate.modes_below.push_back(static_cast<double>(at.below));
    certificate.count_by_inertia = at.below;
  }
  certificate.complete = doubtful.empty() && agree && certificate.count_by_inertia == certificate.count_found;
  return doubtful;
}

void refuse_incomplete(const ModeSet& set, const std::vector<Eigen::Index>& doubtful) {
  const kernels::Certificate& certificate = set.certificate;
  if (certificate.complete) return;
  if (!doubtful.empty()) {
    const auto n = static_cast<std::size_t>(doubtful.front());
    throw SolverError(fmt::format(
        "modes: {} modes are not accurate enough, the first of them mode {} at {:.6g} Hz with a residual of "
        "{:.2g}; the M-orthonormality of all is {:.2g}",
        doubtful.size(), n + 1, to_hertz(RadPerSecond{set.angular_frequency[n]}).value, set.residual[n],
        certificate.orthonormality));
  }
  throw SolverError(fmt::format("modes: {} found but inertia proves {} below {:.6g} Hz",
                                certificate.count_found, certificate.count_by_inertia, certificate.upto_hz));
}

void certify_basis(const parallel::Teams& teams, const Operators& operators, Hertz band, double error,
                   ModeSet& set) {
  measure(teams, operators, {}, orthonormality_of_ritz_vectors, all_modes(set), set);
  kernels::Certificate& certificate = set.certificate;
  certificate.orthonormality = largest(set.overlap);
  certificate.upto_hz = band.value;
  certificate.flexibility_error = error;
  certificate.count_by_inertia = certificate.count_found =
      static_cast<std::int64_t>(set.angular_frequency.size());
  certificate.complete = certificate.orthonormality < orthonormality_of_ritz_vectors;
  if (!certificate.complete)
    throw SolverError(fmt::format("modes: the contact-adapted basis is M-orthonormal only to {:.2g}",
                                  certificate.orthonormality));
}

Probe count_below(const parallel::Teams& teams, Factorisation& factor, double sigma) {
  Probe probe;
  if (teams.mine() == 0) {
    factor.factor(sigma);
    probe = {factor.sigma(), factor.below()};
  }
  MPI_Bcast(&probe.sigma, 1, MPI_DOUBLE, 0, teams.peers());
  MPI_Bcast(&probe.below, 1, MPI_INT64_T, 0, teams.peers());
  return probe;
}

}  // namespace ricochet::modes
