// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/approximate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/mesh/order_reduction.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/symmetric.hpp"

namespace ricochet::modes {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Relative distance in λ below which modes are not separated: a cut never falls between them.
constexpr double apart = 1e-3;

/// Shift of the iteration, relative to the largest λ of interest. K − σM is definite, and rigid motions do
/// not dominate.
constexpr double near_zero = -1e-3;

/// Maximum number of further iterations if the counts do not agree.
constexpr int further = 3;

/// With fewer displacements than this, computing the modes directly is faster than starting from a lower
/// order.
constexpr std::int64_t few = 2000;

constexpr Index panel = 64;

/// Number of iterated vectors per requested mode, and their range of frequency relative to that of the
/// request. Linear elements are so stiff in bending that the requested modes spread over many more modes of
/// these elements.
double surplus(int order) { return order == 1 ? 1.45 : 1.2; }
double reach(int order) { return order == 1 ? 1.4 : 1.2; }

/// Returns the index of the first column of each team, followed by the number of all columns, (teams + 1).
/// Collective.
std::vector<Index> shares_of(const parallel::Teams& teams, const MatrixXd& mine) {
  std::vector<Index> first(static_cast<std::size_t>(teams.count()) + 1, 0);
  const std::int64_t own = mine.cols();
  MPI_Allgather(&own, 1, MPI_INT64_T, first.data() + 1, 1, MPI_INT64_T, teams.peers());
  std::partial_sum(first.begin(), first.end(), first.begin());
  return first;
}

/// Block inverse iteration with a projection onto the span of the columns of all teams.
class Iteration {
 public:
  Iteration(const parallel::Teams& teams, const Operators& operators, Factorisation& factor)
      : teams_(teams), operators_(operators), factor_(factor) {}

  /// Solves (K − σM) Y = M X for the columns X of all teams, and computes Ritz values and vectors in the span
  /// of Y.
  void step(const MatrixXd& x) {
    share_ = shares_of(teams_, x);
    momentum_ = operators_.mass(x);
    momentum_ -= operators_.rigid_momentum * inner(operators_.comm, operators_.rigid, momentum_);
    y_ = factor_.solve(momentum_);
    force_ = std::move(momentum_);
    y_ -= operators_.rigid * inner(operators_.comm, operators_.rigid_momentum, y_);
    momentum_ = operators_.mass(y_);
    // K Y = M X + σ M Y.
    force_ += factor_.sigma() * momentum_;
    VectorXd square = y_.cwiseProduct(momentum_).colwise().sum();
    parallel::sum(operators_.comm, square);
    const VectorXd scale = square.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    for (MatrixXd* columns : {&y_, &momentum_, &force_}) *columns *= scale.asDiagonal();
    project();
    momentum_.resize(0, 0);
    force_.resize(0, 0);
  }

  const VectorXd& lambda() const { return lambda_; }

  /// Returns the leading `n` Ritz vectors, distributed evenly among the teams.
  MatrixXd vectors(Index n) const {
    const auto [first, own] = teams_.share(n);
    const auto part = vector_.middleCols(first, own);
    MatrixXd found = MatrixXd::Zero(y_.rows(), own);
    each_panel(y_, [&](std::size_t, Index at, const MatrixXd& columns) {
      found.noalias() += columns * part.middleRows(at, columns.cols());
    });
    return found;
  }

 private:
  /// Broadcasts the columns of every team to all teams, in panels. Calls visit(team, index among all columns,
  /// columns) for each panel.
  template <class Visit>
  void each_panel(const MatrixXd& mine, Visit&& visit) const {
    MatrixXd columns;
    for (std::size_t t = 0; t + 1 < share_.size(); ++t)
      for (Index at = share_[t]; at < share_[t + 1]; at += panel) {
        const Index width = std::min(panel, share_[t + 1] - at);
        const bool own = static_cast<int>(t) == teams_.mine();
        columns = own ? mine.middleCols(at - share_[t], width) : MatrixXd(mine.rows(), width);
        MPI_Bcast(columns.data(), static_cast<int>(columns.size()), MPI_DOUBLE, static_cast<int>(t),
                  teams_.peers());
        visit(t, at, columns);
      }
  }

  /// Computes Yᵀ A Y from A Y. By symmetry, two teams share the products of their columns: each computes half
  /// of them.
  MatrixXd projected(const MatrixXd& image) const {
    const Index k = share_.back();
    MatrixXd whole = MatrixXd::Zero(k, k);
    const auto me = static_cast<std::size_t>(teams_.mine());
    each_panel(image, [&](std::size_t t, Index at, const MatrixXd& columns) {
      const Index half = share_[t] + (share_[t + 1] - share_[t]) / 2, behind = at + columns.cols();
      if (me > t && behind <= half) return;
      const Index rows = me < t ? y_.cols() / 2 : me == t ? behind - share_[t] : y_.cols();
      whole.block(share_[me], at, rows, columns.cols()).noalias() = y_.leftCols(rows).transpose() * columns;
    });
    parallel::sum(teams_.world(), whole);
    // An entry that no team has computed is 0; its value is then on the other side of the diagonal.
    for (Index j = 0; j < k; ++j)
      for (Index i = 0; i < j; ++i) {
        const double value = whole(i, j) != 0 ? whole(i, j) : whole(j, i);
        whole(i, j) = whole(j, i) = value;
      }
    return whole;
  }

  void project() {
    const Index k = share_.back();
    MatrixXd mass = projected(momentum_), stiffness = projected(force_);
    lambda_.resize(k);
    vector_.resize(k, k);
    // One rank computes the result for all, so that they agree bitwise.
    if (parallel::rank_of(teams_.world()) == 0) {
      const VectorXd size = eigen_decomposition(mass);
      MatrixXd normal = mass * size.cwiseMax(1e-14 * size[k - 1]).cwiseSqrt().cwiseInverse().asDiagonal();
      MatrixXd inside = normal.transpose() * stiffness * normal;
      lambda_ = eigen_decomposition(inside);
      vector_.noalias() = normal * inside;
    }
    MPI_Bcast(lambda_.data(), static_cast<int>(k), MPI_DOUBLE, 0, teams_.world());
    MPI_Bcast(vector_.data(), static_cast<int>(k * k), MPI_DOUBLE, 0, teams_.world());
  }

  const parallel::Teams& teams_;
  const Operators& operators_;
  Factorisation& factor_;
  std::vector<Index> share_;       ///< distribution of the columns of Y
  MatrixXd y_, momentum_, force_;  ///< of this team: Y, M Y, K Y
  VectorXd lambda_;
  MatrixXd vector_;
};

/// Converts a request to one for the next lower order, `order`, of which `body` is the discretisation.
ApproximateRequest request_below(const ApproximateRequest& request, const elasticity::Body& body, int order) {
  ApproximateRequest below;
  if (request.up_to) below.up_to = Hertz{reach(order) * request.up_to->value};
  if (!request.count) return below;
  // The upper half of the spectrum of a mesh is unrelated to modes of the body.
  const std::int64_t most = body.free_rows / 2;
  if (*request.count >= most)
    throw InputError(fmt::format(
        "modes.approximate: {} modes are too many to start from elements of order {} with their {} free "
        "displacements: leave approximate out, request fewer, or refine the mesh",
        *request.count, order, body.free_rows));
  const auto more = static_cast<std::int64_t>(surplus(order) * static_cast<double>(*request.count));
  below.count = std::min(more + 16, most);
  return below;
}

/// Returns how many of the ascending λ are requested.
Index wanted_of(const ApproximateRequest& request, const VectorXd& lambda, Index rigid) {
  if (request.count) return std::max<Index>(*request.count - rigid, 0);
  const double end = std::pow(static_cast<RadPerSecond>(*request.up_to).value, 2);
  return std::upper_bound(lambda.begin(), lambda.end(), end) - lambda.begin();
}

/// Elastic modes of the lower order, prolonged to the higher order.
struct Start {
  MatrixXd shape;  ///< (local rows, n), of this team
  double end = 0;  ///< approximate λ of the last mode
};

/// Whether the modes of this order are in turn started from the next lower order. That order must have more
/// than four displacements for each requested mode.
bool starts_below(const ApproximateRequest& request, const elasticity::Body& body, int order) {
  if (order == 1 || body.free_rows <= few) return false;
  const double left = static_cast<double>(body.free_rows) * std::pow((order - 1.0) / order, 3);
  return 4 * static_cast<double>(request.count.value_or(0)) < left;
}

/// Computes the modes of the lower order, directly or from the order below it. Collective.
Start start_of(const parallel::Teams& teams, const mesh::Mesh& mesh,
               const std::vector<scene::Material>& materials, const std::string& file,
               const ApproximateRequest& request, const Progress& progress) {
  const mesh::OrderReduction lower(mesh);
  const int order = lower.mesh().order;
  const elasticity::Body body = elasticity::assemble(lower.mesh(), materials, file);
  const ApproximateRequest below = request_below(request, body, order);
  if (starts_below(below, body, order)) {
    const auto [x, end] = start_of(teams, lower.mesh(), materials, file, below, progress);
    progress.begin(fmt::format("block iteration, order {}", order));
    if (shares_of(teams, x).back() == 0) return {MatrixXd(mesh.owned_nodes * mesh.components(), 0), end};
    const Operators operators(lower.mesh(), body);
    Factorisation factor(body.stiffness, body.mass);
    factor.factor(near_zero * end);
    Iteration iteration(teams, operators, factor);
    iteration.step(x);
    const VectorXd& lambda = iteration.lambda();
    const Index kept = std::min(wanted_of(below, lambda, operators.rigid.cols()), lambda.size());
    return {lower.prolong(iteration.vectors(kept)), kept > 0 ? lambda[kept - 1] : end};
  }
  Factorisation factor(body.stiffness, body.mass);
  const ModeSet found =
      compute_modes(teams, lower.mesh(), body, factor,
                    {.up_to = below.up_to, .count = below.count, .relative_residual = 1e-2}, progress);
  const auto rigid = std::count_if(found.index.begin(), found.index.end(), [&](Index n) {
    return found.angular_frequency[static_cast<std::size_t>(n)] == 0;
  });
  return {lower.prolong(found.shape.rightCols(found.shape.cols() - rigid)), found.cut};
}

/// A number of Ritz values, and a shift above the last of them.
struct Cut {
  Index modes = 0;
  double sigma = 0;
};

/// Returns cuts in the widest gaps of the spectrum, at most `most`. A gap may follow the first `wanted` Ritz
/// values or a few more.
std::vector<Cut> gaps(const VectorXd& lambda, Index wanted, double above, std::size_t most) {
  std::vector<std::pair<double, Cut>> found;
  const Index last = std::min(wanted + std::max<Index>(8, wanted / 12), lambda.size() - 1);
  for (Index m = wanted; m <= last; ++m) {
    const double from = std::max(m > 0 ? lambda[m - 1] : 0, above), to = lambda[m];
    // Modes lie below their Ritz values, so the shift must keep a distance from the upper end of the gap.
    found.push_back({(to - from) / to, {m, from + 0.2 * (to - from)}});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Cut> cuts;
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) cuts.push_back(found[i].second);
  return cuts;
}

/// Returns the first cut at which the inertia count equals the number of Ritz values. Each team tests one
/// cut. Collective.
std::optional<Cut> proved(const parallel::Teams& teams, Factorisation& factor, Index rigid,
                          const std::vector<Cut>& cuts) {
  const auto me = static_cast<std::size_t>(teams.mine());
  std::vector<double> agreed(static_cast<std::size_t>(teams.count()), 0.0);
  if (me < cuts.size()) {
    factor.factor(cuts[me].sigma);
    agreed[me] = factor.below() == rigid + cuts[me].modes ? 1 : 0;
  }
  parallel::sum(teams.peers(), agreed);
  for (std::size_t t = 0; t < cuts.size(); ++t)
    if (agreed[t] > 0) return cuts[t];
  return std::nullopt;
}

}  // namespace

ModeSet approximate_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                          Factorisation& factor, const std::vector<scene::Material>& materials,
                          const std::string& file, const ApproximateRequest& request,
                          const Progress& progress) {
  const Operators operators(mesh, body);
  const Index r = operators.rigid.cols();
  auto [x, above] = start_of(teams, mesh, materials, file, request, progress);
  const Index k = shares_of(teams, x).back();
  const double end = request.up_to ? std::pow(static_cast<RadPerSecond>(*request.up_to).value, 2) : 0;

  Iteration iteration(teams, operators, factor);
  ModeSet set;
  set.exact = false;
  set.static_shift = near_zero * above;
  Index wanted = 0;
  std::optional<Cut> cut;
  for (int step = 1; !cut; ++step) {
    set.certificate.approximate = step;
    progress.begin(fmt::format("block iteration {}", step));
    factor.factor(set.static_shift);
    if (k > 0) iteration.step(x);
    const VectorXd& lambda = iteration.lambda();
    if (step >= request.iterations) {
      progress.begin("inertia count");
      wanted = wanted_of(request, lambda, r);
      if (wanted >= k)
        throw InputError(
            fmt::format("modes.approximate = {}: elements of order {} have {} elastic modes to start from, "
                        "too few: leave it "
                        "out, or refine the mesh",
                        request.iterations, mesh.order - 1, k));
      cut = proved(teams, factor, r, gaps(lambda, wanted, end, static_cast<std::size_t>(teams.count())));
    }
    if (!cut && step == request.iterations + further)
      throw SolverError(fmt::format(
          "modes: inertia does not count the modes that approximate = {} finds, nor after {} more "
          "iterations: leave it out",
          request.iterations, further));
    if (!cut) x = iteration.vectors(k);
  }
  progress.begin("certificate");
  const VectorXd lambda = iteration.lambda();
  Index kept = request.up_to ? cut->modes : wanted;
  while (kept > 0 && kept < cut->modes && lambda[kept] < (1 + apart) * lambda[kept - 1]) ++kept;
  Probe counted{cut->sigma, r + cut->modes};
  if (kept < cut->modes) {
    // Frequencies are slightly high, so that a mode may lie below the middle of a narrow gap.
    const Probe middle = count_below(teams, factor, ((kept > 0 ? lambda[kept - 1] : 0) + lambda[kept]) / 2);
    if (middle.below == r + kept)
      counted = middle;
    else
      kept = cut->modes;
  }
  set.cut = counted.sigma;
  for (Index n = 0; n < r + kept; ++n) set.angular_frequency.push_back(n < r ? 0 : std::sqrt(lambda[n - r]));
  set.store(teams, operators, teams.share(kept).first, iteration.vectors(kept));
  refuse_incomplete(set, certify(teams, operators, {counted}, std::nullopt, set));
  return set;
}

double expected_approximate_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                                int teams) {
  // Each team stores three blocks of columns: X or its image, Y, and M Y.
  const auto column = static_cast<double>(local_rows) * sizeof(double) / (1 << 20);
  return factor.expected_mib() + 3 * surplus(1) * static_cast<double>(modes) / teams * column;
}

}  // namespace ricochet::modes
