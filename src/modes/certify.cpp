// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/certify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::modes {

namespace {

/// Returns the bound on max |ΦᵀMΦ − I|. Two modes from different shifts, with residuals up to r, are
/// orthogonal to within 2rλ/Δλ, and neighbours are rarely closer than 2 %; the bound is therefore 100 r. A
/// mode that was found twice would give 1. Ritz vectors of one space are orthogonal whatever their residuals.
double orthonormality_bound(std::optional<double> tolerance) {
  return tolerance ? std::clamp(100 * *tolerance, 1e-8, 0.1) : 1e-8;
}

/// Residuals of this team's elastic modes, and max |ΦᵀMΦ − I| over all pairs of modes.
struct Measured {
  Eigen::VectorXd residual;
  double orthonormality = 0;
};

/// Computes residuals and orthonormality in panels, because K Φ and M Φ are as large as Φ. Each team
/// multiplies its own columns. The M Φ of each team is then compared with the columns of the others.
Measured measure(const parallel::Teams& teams, const Operators& operators, const Eigen::VectorXd& lambda,
                 const Eigen::MatrixXd& shape) {
  constexpr Eigen::Index panel = 64;
  Measured measured{Eigen::VectorXd(shape.cols()), 0};
  const auto most =
      static_cast<Eigen::Index>(parallel::largest(teams.peers(), static_cast<double>(shape.cols())));
  for (Eigen::Index j = 0; j < most; j += panel) {
    const Eigen::Index own = std::clamp<Eigen::Index>(shape.cols() - j, 0, panel);
    Eigen::MatrixXd momentum(shape.rows(), own);
    if (own > 0) {
      const auto mine = shape.middleCols(j, own);
      momentum = operators.mass(mine);
      const Eigen::MatrixXd force = operators.stiffness(mine);
      measured.residual.segment(j, own) =
          operators.norms(force - momentum * lambda.segment(j, own).asDiagonal())
              .cwiseQuotient(operators.norms(force));
    }
    for (int t = 0; t < teams.count(); ++t) {
      std::int64_t n = own;
      MPI_Bcast(&n, 1, MPI_INT64_T, t, teams.peers());
      Eigen::MatrixXd theirs;
      if (teams.mine() != t) theirs.resize(shape.rows(), n);
      MPI_Bcast(teams.mine() == t ? momentum.data() : theirs.data(), static_cast<int>(shape.rows() * n),
                MPI_DOUBLE, t, teams.peers());
      // Of two teams, the one with the higher number computes their products.
      if (teams.mine() < t || n == 0) continue;
      const Eigen::Index rows = teams.mine() == t ? j + n : shape.cols();
      Eigen::MatrixXd gram =
          inner(operators.comm, shape.leftCols(rows), teams.mine() == t ? momentum : theirs);
      if (teams.mine() == t) gram.bottomRows(n) -= Eigen::MatrixXd::Identity(n, n);
      if (gram.size() > 0)
        measured.orthonormality = std::max(measured.orthonormality, gram.cwiseAbs().maxCoeff());
    }
  }
  measured.orthonormality = parallel::largest(teams.world(), measured.orthonormality);
  return measured;
}

/// Stores the residuals of all modes in `set`, and those of this team's modes as a row in `residual`. Returns
/// max |ΦᵀMΦ − I|.
double take_residuals(const parallel::Teams& teams, const Operators& operators, ModeSet& set,
                      Eigen::MatrixXd& residual) {
  const Eigen::Index r = operators.rigid.cols();
  Eigen::VectorXd lambda(set.shape.cols());
  for (Eigen::Index j = 0; j < lambda.size(); ++j)
    lambda[j] =
        std::pow(set.angular_frequency[static_cast<std::size_t>(set.index[static_cast<std::size_t>(j)])], 2);
  const Measured measured = measure(teams, operators, lambda, set.shape);
  residual = measured.residual.transpose();
  const double stiffest =
      parallel::largest(operators.comm, operators.diagonal.size() > 0 ? operators.diagonal.maxCoeff() : 0);
  // For rigid modes, ‖Kφ‖ vanishes, so it cannot serve as the scale.
  if (residual.size() > 0 && set.index.front() < r)
    residual.leftCols(r) = (operators.norms(operators.stiffness(set.shape.leftCols(r))).array() /
                            (stiffest * operators.norms(set.shape.leftCols(r)).array()))
                               .transpose();
  const Eigen::MatrixXd all = set.gather(teams, residual);
  set.residual.assign(all.data(), all.data() + all.cols());
  return measured.orthonormality;
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

void certify(const parallel::Teams& teams, const Operators& operators, std::int64_t counted,
             std::optional<double> tolerance, ModeSet& set) {
  Eigen::MatrixXd residual;
  const double orthonormality = take_residuals(teams, operators, set, residual);
  // Residuals above the tolerance that round-off does not explain.
  Eigen::MatrixXd excess = Eigen::MatrixXd::Zero(1, set.shape.cols());
  for (Eigen::Index j = 0; tolerance && j < excess.cols(); ++j)
    if (!(residual(0, j) <= *tolerance) && !(residual(0, j) <= operators.round_off(set.shape.col(j))[0]))
      excess(0, j) = residual(0, j);
  Eigen::Index worst = 0;
  const Eigen::MatrixXd bad = set.gather(teams, excess);
  if (bad.size() > 0 && bad.row(0).maxCoeff(&worst) > 0)
    throw SolverError(fmt::format(
        "modes: mode {} at {:.6g} Hz has a residual of {:.2g}, above {:.2g}: loosen modes.relative_residual",
        worst + 1, to_hertz(RadPerSecond{set.angular_frequency[static_cast<std::size_t>(worst)]}).value,
        bad(0, worst), *tolerance));
  kernels::Certificate& certificate = set.certificate;
  certificate.upto_hz = std::sqrt(set.cut) / (2 * std::numbers::pi);
  certificate.count_by_inertia = counted;
  certificate.count_found = static_cast<std::int64_t>(set.angular_frequency.size());
  certificate.orthonormality = orthonormality;
  certificate.complete = certificate.count_by_inertia == certificate.count_found &&
                         certificate.orthonormality < orthonormality_bound(tolerance);
  if (!certificate.complete)
    throw SolverError(
        fmt::format("modes: {} found but inertia proves {} below {:.6g} Hz, M-orthonormal to {:.2g}",
                    certificate.count_found, certificate.count_by_inertia, certificate.upto_hz,
                    certificate.orthonormality));
}

void certify_basis(const parallel::Teams& teams, const Operators& operators, Hertz band, double error,
                   ModeSet& set) {
  Eigen::MatrixXd residual;
  kernels::Certificate& certificate = set.certificate;
  certificate.orthonormality = take_residuals(teams, operators, set, residual);
  certificate.upto_hz = band.value;
  certificate.flexibility_error = error;
  certificate.count_by_inertia = certificate.count_found =
      static_cast<std::int64_t>(set.angular_frequency.size());
  certificate.complete = certificate.orthonormality < 1e-8;
  if (!certificate.complete)
    throw SolverError(fmt::format("modes: the contact-adapted basis is M-orthonormal only to {:.2g}",
                                  certificate.orthonormality));
}

}  // namespace ricochet::modes
