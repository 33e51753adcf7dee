#include "contact/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

constexpr double round_off = 1e-13;  // of w, relative to |r|_∞ + ‖S‖_∞ |λ|_∞
constexpr double negative =
    1e-14;  // λ_i above −negative |λ|_∞ counts as 0: moves w by less than its tolerance
constexpr int patience_of_pivots = 10;  // p_max: block pivots allowed without progress

/// A Schur complement this far below its diagonal is looked at more closely.
constexpr double suspicious = 1e-8;

}  // namespace

ComplementaritySolver::ComplementaritySolver(int capacity)
    : stride_(static_cast<std::size_t>(std::max(capacity, 1)) + 1) {
  active_.resize(stride_);
  next_.resize(stride_);
  is_active_.resize(stride_);
  refused_.resize(stride_);
  factor_.resize(stride_ * stride_);
  z_.resize(stride_);
  x_.resize(stride_);
  d_.resize(stride_);
  w_.resize(static_cast<Eigen::Index>(stride_));
  weight_.resize(static_cast<Eigen::Index>(stride_));
}

void ComplementaritySolver::reset() noexcept {
  count_ = 0;
  warm_ = false;
}

/// Appends j to P and its row to the factor. False, P unchanged and d_ the null direction, when j depends on
/// P: its Schur complement dᵀ S d, d_j = 1, d_P = −S_PP⁻¹ S_Pj, is then within the round-off of that sum, n ε
/// (Σ |d_i| √S_ii)². `trusted`: P ∪ j is known to be regular, so any positive Schur complement will do.
bool ComplementaritySolver::enter(const Problem& S, int j, bool trusted) noexcept {
  double* const l = row(count_);
  double schur = S(j, j);
  for (int c = 0; c < count_; ++c) {
    const double* const above = row(c);
    double sum = S(active_[c], j);
    for (int k = 0; k < c; ++k) sum -= l[k] * above[k];
    l[c] = sum / above[c];
    schur -= l[c] * l[c];
  }
  if (!(schur > (trusted ? 0.0 : suspicious * S(j, j)))) {
    if (trusted) return false;
    for (int k = 0; k < count_; ++k) d_[k] = -l[k];
    for (int k = count_ - 1; k >= 0; --k) {
      const double* const above = row(k);
      d_[k] /= above[k];
      for (int i = 0; i < k; ++i) d_[i] -= above[i] * d_[k];
    }
    double sum = std::sqrt(S(j, j));
    for (int k = 0; k < count_; ++k) sum += std::abs(d_[k]) * std::sqrt(S(active_[k], active_[k]));
    const double n = static_cast<double>(std::max<Eigen::Index>(S.rows(), 10));
    if (!(schur > 4 * n * std::numeric_limits<double>::epsilon() * sum * sum)) return false;
  }
  l[count_] = std::sqrt(schur);
  active_[count_++] = j;
  is_active_[j] = 1;
  return true;
}

/// Rows `from`… of the factor anew. False at the first index that depends on those before it: it and all
/// behind it are dropped.
bool ComplementaritySolver::factor(const Problem& S, int from, bool trusted) noexcept {
  const int wanted = count_;
  count_ = from;
  for (int k = from; k < wanted; ++k)
    if (!enter(S, active_[k], trusted)) {
      for (int rest = k; rest < wanted; ++rest) is_active_[active_[rest]] = 0;
      return false;
    }
  return true;
}

/// Takes the index at `position` out of P; the factor's rows from there on are stale.
void ComplementaritySolver::drop(int position) noexcept {
  is_active_[active_[position]] = 0;
  std::copy(active_.begin() + position + 1, active_.begin() + count_, active_.begin() + position);
  std::copy(x_.begin() + position + 1, x_.begin() + count_, x_.begin() + position);
  --count_;
}

/// z = S_PP⁻¹ r_P.
void ComplementaritySolver::minimise_on_face(const Right& r) noexcept {
  for (int k = 0; k < count_; ++k) {
    const double* const l = row(k);
    double sum = r(active_[k]);
    for (int i = 0; i < k; ++i) sum -= l[i] * z_[i];
    z_[k] = sum / l[k];
  }
  for (int k = count_ - 1; k >= 0; --k) {
    const double* const l = row(k);
    z_[k] /= l[k];
    for (int i = 0; i < k; ++i) z_[i] -= l[i] * z_[k];
  }
}

/// w = S λ − r and its tolerance, for λ_P = on_face.
void ComplementaritySolver::evaluate(const Problem& S, const Right& r,
                                     const std::vector<double>& on_face) noexcept {
  const Eigen::Index n = r.size();
  auto w = w_.head(n);
  auto weight = weight_.head(n);
  w = -r;
  weight.setZero();
  double largest = 0;
  for (int k = 0; k < count_; ++k) {
    const auto column = S.col(active_[k]);
    w += on_face[k] * column;
    weight += column.cwiseAbs();
    largest = std::max(largest, std::abs(on_face[k]));
  }
  tolerance_ = round_off * (r.cwiseAbs().maxCoeff() + weight.maxCoeff() * largest);
}

/// Block principal pivoting from the active set at hand, after Kostreva 1978 and Júdice & Pires 1994: every
/// infeasible index changes sides at once, as long as their number falls now and then. `solved` leaves λ_P in
/// x_; anything else but not_finite hands over to `descend`.
SolveStatus ComplementaritySolver::pivot(const Problem& S, const Right& r) noexcept {
  const int n = static_cast<int>(r.size());
  int fewest = n + 1, patience = patience_of_pivots, from = 0;
  while (true) {
    if (!factor(S, from, false)) return SolveStatus::no_solution;
    minimise_on_face(r);
    evaluate(S, r, z_);
    if (!std::isfinite(w_.head(n).sum())) return SolveStatus::not_finite;

    double largest = 0;
    for (int k = 0; k < count_; ++k) largest = std::max(largest, std::abs(z_[k]));
    int kept = 0, infeasible = 0;
    from = count_;
    for (int k = 0; k < count_; ++k) {
      if (z_[k] >= -negative * largest) {
        next_[kept++] = active_[k];
      } else {
        from = std::min(from, k);
        ++infeasible;
      }
    }
    for (int i = 0; i < n; ++i)
      if (!is_active_[i] && w_[i] < -tolerance_) {
        next_[kept++] = i;
        ++infeasible;
      }
    if (infeasible == 0) {
      for (int k = 0; k < count_; ++k) x_[k] = std::max(z_[k], 0.0);
      return SolveStatus::solved;
    }
    if (infeasible < fewest) {
      fewest = infeasible;
      patience = patience_of_pivots;
    } else if (patience-- == 0) {
      return SolveStatus::no_solution;
    }
    ++statistics_.pivots;
    std::copy(next_.begin(), next_.begin() + kept, active_.begin());
    std::fill(is_active_.begin(), is_active_.begin() + n, char{0});
    for (int k = 0; k < kept; ++k) is_active_[active_[k]] = 1;
    count_ = kept;
  }
}

/// From λ_P = x_ ≥ 0 to the minimiser on a face of P where it is ≥ 0: steps towards it, dropping what reaches
/// 0 first.
bool ComplementaritySolver::move_on_face(const Problem& S, const Right& r) noexcept {
  while (true) {
    minimise_on_face(r);
    double largest = 0;
    for (int k = 0; k < count_; ++k) largest = std::max(largest, std::abs(z_[k]));
    double reach = 1;
    int blocking = -1;
    for (int k = 0; k < count_; ++k)
      if (z_[k] < -negative * largest && x_[k] / (x_[k] - z_[k]) < reach) {
        reach = x_[k] / (x_[k] - z_[k]);
        blocking = k;
      }
    for (int k = 0; k < count_; ++k)
      x_[k] = std::max(0.0, blocking < 0 ? z_[k] : x_[k] + reach * (z_[k] - x_[k]));
    if (blocking < 0) return true;
    drop(blocking);
    if (!factor(S, blocking, true)) return false;
  }
}

/// j depends on P (d_ from `enter`): the objective falls without end along d until some λ_k is 0 and j takes
/// its place. False: nothing blocks, so the problem has no solution. A slope within round-off refuses j
/// instead.
bool ComplementaritySolver::exchange(const Problem& S, int j) noexcept {
  double length = 1;
  for (int k = 0; k < count_; ++k) length += std::abs(d_[k]);
  if (-w_[j] <= tolerance_ * length) {
    refused_[j] = 1;
    return true;
  }
  int blocking = -1;
  double reach = std::numeric_limits<double>::infinity();
  // The swap changes the determinant of S_PP by the factor d_k²: a small d_k blocks only where no other does.
  for (const double least : {1e-8, 1e-12}) {
    for (int k = 0; k < count_; ++k)
      if (d_[k] < -least * length && x_[k] < -d_[k] * reach) {
        reach = -x_[k] / d_[k];
        blocking = k;
      }
    if (blocking >= 0) break;
  }
  if (blocking < 0) return false;
  for (int k = 0; k < count_; ++k) x_[k] = std::max(0.0, x_[k] + reach * d_[k]);
  drop(blocking);
  if (!factor(S, blocking, true)) return false;
  x_[count_] = reach;
  return enter(S, j, true);
}

/// Primal active set on the convex problem, after Lawson & Hanson 1974: feasible throughout, the objective
/// strictly falling, hence finite; singular S by `exchange`.
SolveStatus ComplementaritySolver::descend(const Problem& S, const Right& r) noexcept {
  const int n = static_cast<int>(r.size());
  ++statistics_.fallbacks;
  std::fill(refused_.begin(), refused_.begin() + n, char{0});

  // Start from the part of the last active set that pushes.
  factor(S, 0, false);
  minimise_on_face(r);
  int kept = 0;
  for (int k = 0; k < count_; ++k) {
    is_active_[active_[k]] = z_[k] > 0;
    if (z_[k] > 0) {
      x_[kept] = z_[k];
      active_[kept++] = active_[k];
    }
  }
  count_ = kept;
  bool regular = factor(S, 0, true);

  const int most = 1000 + 50 * n;  // far beyond what falling objectives need: round-off alone could get there
  int entered = -1;
  for (int round = 0; regular && round < most; ++round) {
    if (!move_on_face(S, r)) break;
    if (entered >= 0) {
      // Exactly, j grows from 0; where it was dropped at once, w_j was round-off. Any real progress reopens
      // all cases.
      if (is_active_[entered])
        std::fill(refused_.begin(), refused_.begin() + n, char{0});
      else
        refused_[entered] = 1;
    }
    evaluate(S, r, x_);
    if (!std::isfinite(w_.head(n).sum())) return SolveStatus::not_finite;
    do {
      entered = -1;
      for (int i = 0; i < n; ++i)
        if (!is_active_[i] && !refused_[i] && w_[i] < -tolerance_ && (entered < 0 || w_[i] < w_[entered]))
          entered = i;
      if (entered < 0) return SolveStatus::solved;
      if (enter(S, entered, false)) {
        x_[count_ - 1] = 0;
        break;
      }
      regular = exchange(S, entered);
    } while (regular && refused_[entered]);
  }
  return SolveStatus::no_solution;
}

SolveStatus ComplementaritySolver::solve(const Problem& S, const Right& r,
                                         Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  const int n = static_cast<int>(r.size());
  ++statistics_.problems;
  lambda.setZero();
  if (n == 0) return SolveStatus::solved;
  if (!std::isfinite(r.sum()) || !std::isfinite(S.diagonal().sum())) {
    reset();
    return SolveStatus::not_finite;
  }

  const bool warm = warm_;
  const std::int64_t pivots = statistics_.pivots;
  int kept = 0;
  std::fill(is_active_.begin(), is_active_.begin() + n, char{0});
  for (int k = 0; k < count_; ++k)
    if (active_[k] < n) {
      is_active_[active_[k]] = 1;
      active_[kept++] = active_[k];
    }
  count_ = kept;

  SolveStatus status = pivot(S, r);
  if (status == SolveStatus::solved && warm && statistics_.pivots == pivots) ++statistics_.warm_hits;
  if (status == SolveStatus::no_solution) status = descend(S, r);
  if (status != SolveStatus::solved) {
    reset();
    return status;
  }
  warm_ = true;
  statistics_.max_active = std::max(statistics_.max_active, count_);
  for (int k = 0; k < count_; ++k) lambda(active_[k]) = x_[k];
  return status;
}

}  // namespace ricochet::contact
