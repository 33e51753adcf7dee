// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::contact {
namespace {

constexpr double round_off = 1e-13;  // of w, relative to |r|_∞ + ‖S‖_∞ |λ|_∞
constexpr double negative =
    1e-14;  // λ_i above −negative |λ|_∞ counts as 0; this changes w by less than its tolerance
constexpr int patience_of_pivots = 10;  // p_max: block pivots allowed without progress

}  // namespace

SolveStatistics operator+(const SolveStatistics& a, const SolveStatistics& b) {
  SolveStatistics sum = a;
  for (std::int64_t SolveStatistics::*count :
       {&SolveStatistics::problems, &SolveStatistics::warm_hits, &SolveStatistics::pivots,
        &SolveStatistics::fallbacks, &SolveStatistics::renewals, &SolveStatistics::limited})
    sum.*count += b.*count;
  sum.max_active = std::max(a.max_active, b.max_active);
  return sum;
}

ComplementaritySolver::ComplementaritySolver(int capacity, const SolveOptions& options)
    : options_(options), active_set_(capacity) {
  const auto n = static_cast<std::size_t>(std::max(capacity, 1));
  for (std::vector<double>* x : {&z_, &x_, &best_.value}) x->resize(n);
  for (std::vector<int>* x : {&leaving_, &entering_, &rows_}) x->reserve(n);
  for (Eigen::VectorXd* x : {&w_, &weight_, &root_, &seen_.push}) x->setZero(n);
  best_.index.resize(n);
  refused_.resize(n);
}

void ComplementaritySolver::reset() noexcept {
  active_set_.clear();
  known_ = 0;
  warm_ = stopped_ = descending_ = false;
  changed_ = true;
}

/// Computes the diagonal and the factor of S unless they are stored. Returns false if the diagonal is not
/// finite.
bool ComplementaritySolver::know(const Symmetric& S) noexcept {
  if (options_.same_matrix && known_ == S.rows()) return true;
  if (!std::isfinite(S.diagonal().sum())) return false;
  known_ = S.rows();
  seen_.push.head(known_).setZero();
  seen_.sum = seen_.square = seen_.tolerance = 0;
  root_.head(known_) = S.diagonal().cwiseMax(0).cwiseSqrt();
  if (!renew(S)) warm_ = descending_ = false;
  return true;
}

bool ComplementaritySolver::renew(const Symmetric& S) noexcept {
  if (active_set_.size() > 0) ++statistics_.renewals;
  const bool whole = active_set_.renew(S);
  weight_.head(S.rows()).setZero();
  for (int k = 0; k < active_set_.size(); ++k) weight_.head(S.rows()) += S.col(active_set_[k]).cwiseAbs();
  changed_ = true;
  return whole;
}

bool ComplementaritySolver::enter(const Symmetric& S, int j, bool trusted) noexcept {
  if (!active_set_.enter(S, j, trusted)) return false;
  weight_.head(S.rows()) += S.col(j).cwiseAbs();
  changed_ = true;
  ++statistics_.pivots;
  --budget_.pivots;
  return true;
}

void ComplementaritySolver::drop(const Symmetric& S, int position) noexcept {
  weight_.head(S.rows()) -= S.col(active_set_[position]).cwiseAbs();
  std::copy(x_.begin() + position + 1, x_.begin() + active_set_.size(), x_.begin() + position);
  active_set_.leave(position);
  changed_ = true;
  ++statistics_.pivots;
  --budget_.pivots;
  if (active_set_.size() == 0) weight_.head(S.rows()).setZero();
}

/// Computes w = S λ − r and its tolerance for λ_P = on_set, the minimiser on the active set. Rows that cannot
/// be negative are set to 0. S is semidefinite, so for any μ with a known f = S μ
///
///   |S_i λ − f_i| ≤ √S_ii ‖λ − μ‖,   ‖λ − μ‖² = λᵀSλ − 2 λᵀf + μᵀf,   λᵀSλ = λᵀr up to the tolerance of w;
///
/// μ is the λ for which all rows were last evaluated, or 0. Returns false if a value is not finite.
bool ComplementaritySolver::evaluate(const Symmetric& S, const Right& r,
                                     const std::vector<double>& on_set) noexcept {
  const int n = static_cast<int>(r.size()), p = active_set_.size();
  auto w = w_.head(n);
  if (changed_) heaviest_ = weight_.head(n).maxCoeff<Eigen::PropagateNaN>();
  changed_ = false;
  double sum = 0, work = 0, common = 0;
  for (int k = 0; k < p; ++k) {
    sum += std::abs(on_set[k]);
    work += on_set[k] * r(active_set_[k]);
    common += on_set[k] * seen_.push(active_set_[k]);
  }
  tolerance_ = round_off * (r.cwiseAbs().maxCoeff() + heaviest_ * largest_of(on_set, p));
  if (!std::isfinite(sum + work + tolerance_)) return false;

  const double slack = (sum + seen_.sum) * (tolerance_ + seen_.tolerance);
  const double from_zero = std::sqrt(std::max(work, 0.0) + slack);
  const double from_seen = std::sqrt(std::max(work - 2 * common + seen_.square, 0.0) + 4 * slack);
  rows_.clear();
  for (int i = 0; i < n; ++i)
    if (r(i) > -root_(i) * from_zero && r(i) > seen_.push(i) - seen_.tolerance - root_(i) * from_seen &&
        !active_set_.contains(i))
      rows_.push_back(i);

  if (4 * rows_.size() > static_cast<std::size_t>(n)) {  // a gathered row costs about four times as much
    auto push = seen_.push.head(n);
    push.setZero();
    int k = 0;
    for (; k + 4 <= p; k += 4)
      push += on_set[k] * S.col(active_set_[k]) + on_set[k + 1] * S.col(active_set_[k + 1]) +
              on_set[k + 2] * S.col(active_set_[k + 2]) + on_set[k + 3] * S.col(active_set_[k + 3]);
    for (; k < p; ++k) push += on_set[k] * S.col(active_set_[k]);
    w = push - r;
    seen_.sum = sum;
    seen_.tolerance = tolerance_;
    seen_.square = 0;
    for (k = 0; k < p; ++k) seen_.square += on_set[k] * push(active_set_[k]);
  } else {
    w.setZero();
    for (const int i : rows_) {
      const double* const row = &S.coeffRef(0, i);
      double even = -r(i), odd = 0;
      int k = 0;
      for (; k + 2 <= p; k += 2) {
        even += row[active_set_[k]] * on_set[k];
        odd += row[active_set_[k + 1]] * on_set[k + 1];
      }
      if (k < p) even += row[active_set_[k]] * on_set[k];
      w(i) = even + odd;
    }
  }
  return std::isfinite(w.sum());
}

/// Sets leaving_ to the positions with λ < 0 and entering_ to the indices with w < 0.
void ComplementaritySolver::find_infeasible(int n) noexcept {
  const double least = -negative * largest_of(z_, active_set_.size());
  leaving_.clear();
  entering_.clear();
  for (int k = 0; k < active_set_.size(); ++k)
    if (z_[k] < least) leaving_.push_back(k);
  for (int i = 0; i < n; ++i)
    if (w_[i] < -tolerance_ && !active_set_.contains(i)) entering_.push_back(i);
}

/// Shortens both lists to the remaining pivots. Indices in tension leave first; those with the deepest
/// penetration enter.
void ComplementaritySolver::cut_to_budget() noexcept {
  const auto left = static_cast<std::size_t>(budget_.pivots);
  if (leaving_.size() > left) leaving_.resize(left);
  const std::size_t enter = left - leaving_.size();
  if (entering_.size() <= enter) return;
  std::nth_element(entering_.begin(), entering_.begin() + static_cast<std::ptrdiff_t>(enter), entering_.end(),
                   [this](int i, int j) { return w_[i] < w_[j]; });
  entering_.resize(enter);
}

/// Block principal pivoting from the current active set, after Kostreva 1978 and Júdice & Pires 1994: all
/// infeasible indices change sides at once, as long as their number falls at least once in ten rounds. After
/// `solved`, x_ contains λ_P. After `no_solution`, `descend` takes over.
SolveStatus ComplementaritySolver::pivot(const Symmetric& S, const Right& r) noexcept {
  const int n = static_cast<int>(r.size());
  if (!stopped_) {
    budget_.fewest = n + 1;
    budget_.rounds = patience_of_pivots;
  }
  while (true) {
    active_set_.minimise(r, z_);
    if (!evaluate(S, r, z_)) return SolveStatus::not_finite;
    find_infeasible(n);
    const int infeasible = static_cast<int>(leaving_.size() + entering_.size());
    if (infeasible == 0) {
      for (int k = 0; k < active_set_.size(); ++k) x_[k] = std::max(z_[k], 0.0);
      return SolveStatus::solved;
    }
    if (bounded()) {
      offer(S, r, z_);
      if (budget_.pivots <= 0) return SolveStatus::limited;
    }
    if (infeasible < budget_.fewest) {
      budget_.fewest = infeasible;
      budget_.rounds = patience_of_pivots;
    } else if (budget_.rounds-- <= 0) {
      budget_.rounds = 0;
      return SolveStatus::no_solution;
    }
    if (infeasible > budget_.pivots) cut_to_budget();
    for (auto k = leaving_.rbegin(); k != leaving_.rend(); ++k) drop(S, *k);
    for (const int j : entering_)
      if (!enter(S, j, false)) return SolveStatus::no_solution;
  }
}

/// Moves from λ_P = x_ ≥ 0 to the minimiser on a subset of P where it is not negative. Each step goes towards
/// the minimiser and drops the index whose force reaches 0 first. Returns false if the pivots are used up; x_
/// is then the last point reached.
bool ComplementaritySolver::move_on_active_set(const Symmetric& S, const Right& r) noexcept {
  while (true) {
    active_set_.minimise(r, z_);
    const double least = -negative * largest_of(z_, active_set_.size());
    double reach = 1;
    int blocking = -1;
    for (int k = 0; k < active_set_.size(); ++k)
      if (z_[k] < least && x_[k] / (x_[k] - z_[k]) < reach) {
        reach = x_[k] / (x_[k] - z_[k]);
        blocking = k;
      }
    for (int k = 0; k < active_set_.size(); ++k)
      x_[k] = std::max(0.0, blocking < 0 ? z_[k] : x_[k] + reach * (z_[k] - x_[k]));
    if (blocking < 0) return true;
    if (budget_.pivots <= 0) return false;
    drop(S, blocking);
  }
}

/// Called if j depends on P, with the null direction d from `enter`. The objective falls without bound along
/// d until some λ_k reaches 0; j then takes its place. Returns false if no λ_k reaches 0, because the problem
/// then has no solution. A slope within round-off refuses j instead.
bool ComplementaritySolver::exchange(const Symmetric& S, int j) noexcept {
  const std::vector<double>& d = active_set_.null_direction();
  double length = 1;
  for (int k = 0; k < active_set_.size(); ++k) length += std::abs(d[k]);
  if (-w_[j] <= tolerance_ * length) {
    refused_[j] = 1;
    return true;
  }
  int blocking = -1;
  double reach = std::numeric_limits<double>::infinity();
  // The exchange multiplies the determinant of S_PP by d_k², so a small d_k is chosen only if there is no
  // larger one.
  for (const double least : {1e-8, 1e-12}) {
    for (int k = 0; k < active_set_.size(); ++k)
      if (d[k] < -least * length && x_[k] < -d[k] * reach) {
        reach = -x_[k] / d[k];
        blocking = k;
      }
    if (blocking >= 0) break;
  }
  if (blocking < 0) return false;
  for (int k = 0; k < active_set_.size(); ++k) x_[k] = std::max(0.0, x_[k] + reach * d[k]);
  drop(S, blocking);
  x_[active_set_.size()] = reach;
  return enter(S, j, true);
}

/// Primal active-set method for the convex problem, after Lawson & Hanson 1974. All iterates are feasible and
/// the objective falls strictly, so the method is finite. `exchange` handles singular S. If the pivots are
/// used up, the next solve continues with λ_P and P.
SolveStatus ComplementaritySolver::descend(const Symmetric& S, const Right& r) noexcept {
  const int n = static_cast<int>(r.size());
  ++statistics_.fallbacks;
  active_set_.minimise(r, z_);
  if (bounded()) offer(S, r, z_);
  if (!std::exchange(descending_, false)) {
    // Start from the indices of the active set with positive forces.
    std::fill(refused_.begin(), refused_.begin() + n, char{0});
    entered_ = -1;
    std::copy(z_.begin(), z_.begin() + active_set_.size(), x_.begin());
    for (int k = active_set_.size() - 1; k >= 0; --k)
      if (!(x_[k] > 0)) {
        if (budget_.pivots <= 0) return SolveStatus::limited;
        drop(S, k);
      }
  }

  const int most = 1000 + 50 * n;  // far more than a falling objective needs; only round-off could reach it
  bool regular = true;
  for (int round = 0; regular && round < most; ++round) {
    if (!move_on_active_set(S, r)) {
      offer(S, r, x_);
      descending_ = true;
      return SolveStatus::limited;
    }
    if (entered_ >= 0) {
      // In exact arithmetic, λ_j grows from 0. If j was dropped at once, w_j was round-off, and j is refused.
      // Any real progress readmits all refused indices.
      if (active_set_.contains(entered_))
        std::fill(refused_.begin(), refused_.begin() + n, char{0});
      else
        refused_[entered_] = 1;
    }
    if (!evaluate(S, r, x_)) return SolveStatus::not_finite;
    do {
      entered_ = -1;
      for (int i = 0; i < n; ++i)
        if (!active_set_.contains(i) && !refused_[i] && w_[i] < -tolerance_ &&
            (entered_ < 0 || w_[i] < w_[entered_]))
          entered_ = i;
      if (entered_ < 0) return SolveStatus::solved;
      if (budget_.pivots <= 0) {
        offer(S, r, x_);
        entered_ = -1;
        descending_ = true;
        return SolveStatus::limited;
      }
      if (enter(S, entered_, false)) {
        x_[active_set_.size() - 1] = 0;
        break;
      }
      regular = exchange(S, entered_);
    } while (regular && refused_[entered_]);
  }
  return SolveStatus::no_solution;
}

/// Stores t x, with x = max(on_set, 0), if its objective is the lowest so far. The best t, xᵀr / xᵀSx, makes
/// λᵀw = 0 and F = −½ (xᵀr)² / xᵀSx < 0.
void ComplementaritySolver::offer(const Symmetric& S, const Right& r,
                                  const std::vector<double>& on_set) noexcept {
  double gain = 0, quadratic = 0;
  for (int k = 0; k < active_set_.size(); ++k) {
    if (!(on_set[k] > 0)) continue;
    const double* const column = &S.coeffRef(0, active_set_[k]);
    double sum = 0.5 * column[active_set_[k]] * on_set[k];
    for (int i = 0; i < k; ++i) sum += column[active_set_[i]] * std::max(on_set[i], 0.0);
    quadratic += 2 * on_set[k] * sum;
    gain += on_set[k] * r(active_set_[k]);
  }
  if (!(gain > 0) || !(quadratic > 0) || !(-0.5 * gain * (gain / quadratic) < best_.objective)) return;
  best_.objective = -0.5 * gain * (gain / quadratic);
  best_.count = 0;
  for (int k = 0; k < active_set_.size(); ++k) {
    if (!(on_set[k] > 0)) continue;
    best_.index[best_.count] = active_set_[k];
    best_.value[best_.count++] = gain / quadratic * on_set[k];
  }
}

void ComplementaritySolver::answer_with_best(const Symmetric& S, const Right& r,
                                             Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  auto w = w_.head(r.size());
  w = -r;
  for (int k = 0; k < best_.count; ++k) {
    lambda(best_.index[k]) = best_.value[k];
    w += best_.value[k] * S.col(best_.index[k]);
  }
  residual_ = {.violation = std::max(0.0, -w.minCoeff()),
               .scale = r.cwiseAbs().maxCoeff() + heaviest_ * largest_of(best_.value, best_.count),
               .work = std::abs(w.dot(lambda))};
}

SolveStatus ComplementaritySolver::solve(const Symmetric& S, const Right& r,
                                         Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
  ++statistics_.problems;
  residual_ = {};
  lambda.setZero();
  if (r.size() == 0) return SolveStatus::solved;
  if (!std::isfinite(r.sum()) || !know(S)) {
    reset();
    return SolveStatus::not_finite;
  }
  budget_.pivots = options_.max_pivots;
  best_.objective = 0;
  best_.count = 0;
  const std::int64_t pivots = statistics_.pivots;

  SolveStatus status = descending_ ? SolveStatus::no_solution : pivot(S, r);
  if (status == SolveStatus::solved && warm_ && statistics_.pivots == pivots) ++statistics_.warm_hits;
  if (status == SolveStatus::no_solution) status = descend(S, r);
  warm_ = status == SolveStatus::solved;
  stopped_ = status == SolveStatus::limited;
  if (stopped_) {
    ++statistics_.limited;
    answer_with_best(S, r, lambda);
  } else if (warm_) {
    statistics_.max_active = std::max(statistics_.max_active, active_set_.size());
    for (int k = 0; k < active_set_.size(); ++k) lambda(active_set_[k]) = x_[k];
  } else {
    reset();
  }
  return status;
}

}  // namespace ricochet::contact
