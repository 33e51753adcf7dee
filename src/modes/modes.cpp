// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/algebra.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/search.hpp"

namespace ricochet::modes {

namespace {

using kernels::multiple_mode;

/// An eigenvalue with its slice and column.
struct Place {
  double lambda;
  std::size_t slice, column;
};

std::vector<Place> places_of(const Search& found) {
  std::vector<Place> places;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    for (std::size_t k = found.share[s].first; k < found.share[s].behind; ++k)
      places.push_back({found.slices[s].lambda[k], s, k});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.lambda < b.lambda; });
  return places;
}

/// Returns the number of elastic modes to keep if `wanted` are requested. Multiple modes are kept whole.
std::size_t kept_of(const std::vector<Place>& places, std::int64_t wanted) {
  auto kept = static_cast<std::size_t>(std::max<std::int64_t>(wanted, 0));
  while (kept > 0 && kept < places.size() &&
         places[kept].lambda < (1 + multiple_mode) * places[kept - 1].lambda)
    ++kept;
  return std::min(kept, places.size());
}

/// Reduces the residuals of the leading columns of a slice by subspace iteration about σ < 0, with a
/// Rayleigh–Ritz projection in each step. Stops when the residuals meet the tolerance, or after three steps.
///
/// The lowest modes of a thin body lie thousands of times their own λ below the shift of the slice, so that
/// the round-off of its solves matters. About a shift near zero, components outside the span decay, and the
/// projected problem separates the components inside.
void polish(const Operators& operators, Factorisation& factor, double tolerance, Eigen::VectorXd& lambda,
            Eigen::MatrixXd& shape) {
  const auto too_large = [&](Eigen::Index first, Eigen::Index n) -> Eigen::Array<bool, Eigen::Dynamic, 1> {
    const auto x = shape.middleCols(first, n);
    const Eigen::VectorXd bound = operators.round_off(x).cwiseMax(tolerance);
    return operators.residuals(x, lambda.segment(first, n)).array() > bound.array();
  };
  // Round-off affects the lowest modes first, so the search ends at the first eight modes without a bad one.
  Eigen::Index bad = 0;
  for (Eigen::Index first = 0; first < shape.cols(); first += 8) {
    const auto found = too_large(first, std::min<Eigen::Index>(8, shape.cols() - first));
    if (!found.any()) break;
    for (Eigen::Index k = 0; k < found.size(); ++k)
      if (found[k]) bad = first + k + 1;
  }
  if (bad == 0) return;
  // A multiple mode is kept whole.
  while (bad < lambda.size() && lambda[bad] < (1 + multiple_mode) * lambda[bad - 1]) ++bad;
  factor.factor(-0.01 * lambda[bad - 1]);
  for (int step = 0; step < 3; ++step) {
    Eigen::MatrixXd x = factor.solve(operators.mass(shape.leftCols(bad)));
    x -= operators.rigid * inner(operators.comm, operators.rigid_momentum, x);
    x *= operators.norms(x).cwiseInverse().asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> projected(
        inner(operators.comm, x, operators.stiffness(x)), inner(operators.comm, x, operators.mass(x)));
    shape.leftCols(bad) = x * projected.eigenvectors();
    lambda.head(bad) = projected.eigenvalues();
    if (!too_large(0, bad).any()) return;
  }
}

}  // namespace

void ModeSet::store(const parallel::Teams& teams, const Operators& operators, Eigen::Index first,
                    const Eigen::MatrixXd& vectors) {
  const Eigen::Index r = operators.rigid.cols(), rigid = teams.mine() == 0 ? r : 0;
  shape.resize(vectors.rows(), rigid + vectors.cols());
  shape.leftCols(rigid) = operators.rigid.leftCols(rigid);
  shape.rightCols(vectors.cols()) = vectors;
  for (Eigen::Index j = 0; j < rigid; ++j) index.push_back(j);
  for (Eigen::Index j = 0; j < vectors.cols(); ++j) index.push_back(r + first + j);
  fix_signs(operators, shape);
}

Eigen::MatrixXd ModeSet::gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all =
      Eigen::MatrixXd::Zero(mine.rows(), static_cast<Eigen::Index>(angular_frequency.size()));
  for (std::size_t j = 0; j < index.size(); ++j) all.col(index[j]) = mine.col(static_cast<Eigen::Index>(j));
  parallel::sum(teams.peers(), all);
  return all;
}

void refuse_more_than_there_are(std::optional<std::int64_t> count, const elasticity::Body& body) {
  if (count && *count > body.free_rows)
    throw InputError(
        fmt::format("modes.count = {}: the body has {} free displacements: request fewer, or refine the mesh",
                    *count, body.free_rows));
}

ModeSet compute_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Request& request, const Progress& progress) {
  refuse_more_than_there_are(request.count, body);
  const Operators operators(mesh, body);
  if (request.up_to) operators.refuse_band(*request.up_to, true);
  const Eigen::Index r = operators.rigid.cols();
  Search found = search(teams, operators, factor, request, progress);
  progress.begin("certificate");
  const double end = found.end.sigma;

  std::vector<Place> places = places_of(found);
  const std::size_t kept = request.count ? kept_of(places, *request.count - r) : places.size();
  ModeSet set;
  // The count between the shifts of two slices is proved, and each mode is known to within its residual. The
  // cut therefore needs no inertia count of its own.
  const double last = kept > 0 ? places[kept - 1].lambda : 0;
  set.cut = kept < places.size() ? (last + places[kept].lambda) / 2 : end;
  // This shift is far enough from zero for rigid motions to be harmless, and close enough for the series in
  // σ/λ_cut to converge fast.
  set.static_shift = -1e-3 * set.cut;
  places.resize(kept);
  const std::int64_t counted = r + static_cast<std::int64_t>(kept);

  // Moves the modes of one slice after another; the shapes of a slice are released as soon as they are moved.
  const bool holds_rigid = teams.mine() == 0;
  std::vector<Eigen::Index> columns_of(found.slices.size(), 0);
  for (const Place& place : places) ++columns_of[place.slice];
  Eigen::Index own = holds_rigid ? r : 0;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    if (found.team[s] == teams.mine()) own += columns_of[s];
  set.shape.resize(body.local_rows, own);
  std::vector<double> own_lambda;
  if (holds_rigid) {
    set.shape.leftCols(r) = operators.rigid;
    for (Eigen::Index j = 0; j < r; ++j) set.index.push_back(j);
  }
  // Slices, and therefore their shares, are in ascending order.
  Eigen::Index at = static_cast<Eigen::Index>(set.index.size()), number = r;
  Eigen::MatrixXd corrected = Eigen::MatrixXd::Zero(1, r + static_cast<Eigen::Index>(kept));
  for (std::size_t s = 0; s < found.slices.size(); ++s) {
    const Eigen::Index n = columns_of[s];
    if (found.team[s] == teams.mine() && n > 0) {
      const auto first = static_cast<Eigen::Index>(found.share[s].first);
      Eigen::MatrixXd shape = found.shape[s].middleCols(first, n);
      found.shape[s].resize(0, 0);
      Eigen::VectorXd lambda = Eigen::Map<const Eigen::VectorXd>(found.slices[s].lambda.data() + first, n);
      polish(operators, factor, request.relative_residual, lambda, shape);
      set.shape.middleCols(at, n) = shape;
      corrected.row(0).segment(number, n) = lambda.transpose();
      for (Eigen::Index j = 0; j < n; ++j) set.index.push_back(number + j);
      at += n;
    }
    number += n;
  }
  parallel::sum(teams.peers(), corrected);
  for (Eigen::Index j = 0; j < corrected.cols(); ++j)
    set.angular_frequency.push_back(std::sqrt(corrected(0, j)));
  fix_signs(operators, set.shape);
  certify(teams, operators, counted, request.relative_residual, set);
  return set;
}

}  // namespace ricochet::modes
