// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/spring_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

constexpr double exactness = 1e-12;          // of s(λ)
constexpr double round_off_of_s = 1e-15;     // of s(λ), relative to |r|_∞
constexpr double round_off_of_gaps = 1e-13;  // of open points, as in complementarity.cpp
constexpr double fast = 0.1;                 // reduction of the error by a round that keeps D
constexpr int few_closed = 12;               // points of which a new factor costs less than another round
constexpr int first_secant = 20, last_secant = 39, many_rounds = 60;
constexpr int bounded_rounds = 8;  // if max_pivots bounds the work of a step
constexpr int halvings = 60;
constexpr double least = 1e-9;  // share of λ_b at which secants begin

/// The λ ≥ 0 with S_ii λ + s(λ) = r. With λ = λ_b t³, t ≤ 1, the left side is (S_ii λ_b − 2b) t³ + 3b t²,
/// which is convex, so that Newton's method descends to the root from above.
double force_of(const PatchSpring& spring, double flexibility, double r) noexcept {
  if (!(r > 0)) return 0;
  const double full = flexibility * spring.limit, b = spring.bulge;
  if (r >= full + b) return (r - b) / flexibility;
  const double cubic = std::max(full - 2 * b, 0.0);
  double t = std::min(1.0, std::sqrt(r / (3 * b)));
  for (int k = 0; k < 50; ++k) {
    const double step = ((cubic * t + 3 * b) * t * t - r) / (3 * t * (cubic * t + 2 * b));
    t -= step;
    if (!(std::abs(step) > 1e-15 * t)) break;
  }
  return spring.limit * t * t * t;
}

}  // namespace

SpringNewton::SpringNewton(int rows, const SolveOptions& options)
    : same_matrix_(options.same_matrix),
      most_rounds_(options.max_pivots < std::numeric_limits<int>::max() ? bounded_rounds : many_rounds),
      matrix_(rows, rows) {
  rows_.reserve(static_cast<std::size_t>(rows));
  for (Eigen::VectorXd* x : {&slope_, &at_, &right_}) x->setZero(rows);
}

void SpringNewton::set_slope(const Symmetric& S, int i, double slope) noexcept {
  if (slope == slope_(i)) return;
  slope_(i) = slope;
  matrix_(i, i) = S(i, i) + slope;
  renewed_ = true;
}

void SpringNewton::begin(const Symmetric& S, const Right& r, std::span<const PatchSpring> springs,
                         const Forces& p) noexcept {
  springs_ = springs;
  largest_r_ = r.size() > 0 ? r.cwiseAbs().maxCoeff() : 0;
  error_ = std::numeric_limits<double>::infinity();
  const bool fresh = !same_matrix_ || known_ != S.rows();
  if (fresh) {
    known_ = S.rows();
    matrix_.topLeftCorner(known_, known_) = S;
    slope_.head(known_).setZero();
    renewed_ = true;
    rows_.clear();
    for (std::size_t i = 0; i < springs.size(); ++i)
      if (springs[i].bulge > 0) rows_.push_back(static_cast<int>(i));
  }
  for (const int i : rows_) {
    at_(i) = p(i) > 0 && std::isfinite(p(i)) ? p(i) : 0;
    if (fresh && at_(i) > 0) set_slope(S, i, springs_[i].slope(at_(i)));
  }
}

/// r − s(x) + D x
void SpringNewton::set_right(const Right& r) noexcept {
  right_.head(r.size()) = r;
  for (const int i : rows_)
    if (at_(i) > 0) right_(i) -= springs_[i].displacement(at_(i)) - slope_(i) * at_(i);
}

bool SpringNewton::is_met(const Forces& p) noexcept {
  before_ = error_;
  error_ = misfit_ = 0;
  closed_ = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i) closed_ += p(i) != 0 ? 1 : 0;
  for (const int i : rows_) {
    if (p(i) == at_(i)) continue;
    const PatchSpring& spring = springs_[i];
    const double linear = (at_(i) > 0 ? spring.displacement(at_(i)) : 0) + slope_(i) * (p(i) - at_(i));
    const double s = p(i) > 0 ? spring.displacement(p(i)) : 0;
    const double misfit = std::abs(s - linear);
    const double tolerance =
        p(i) > 0 ? exactness * s + round_off_of_s * largest_r_ : round_off_of_gaps * largest_r_;
    misfit_ = std::max(misfit_, misfit);
    error_ = std::max(error_, misfit / tolerance);
  }
  return error_ <= 1;
}

/// The force of point i if all others keep theirs.
double SpringNewton::alone(const Symmetric& S, const Right& r, const Forces& p, int i) const noexcept {
  const double* const column = &S.coeffRef(0, i);
  double rest = r(i);
  for (Eigen::Index j = 0; j < r.size(); ++j)
    if (p(j) != 0 && j != i) rest -= column[j] * p(j);
  return force_of(springs_[i], column[i], rest);
}

/// Scales p by the t ≤ 1 for which t pᵀSp + λᵀs(tλ) ≤ pᵀr. As s does not decrease, one step of t suffices
/// where pᵀr exceeds λᵀs.
void SpringNewton::hold_back(const Symmetric& S, const Right& r, Forces p) const noexcept {
  double quadratic = 0, share = 1;
  for (Eigen::Index j = 0; j < p.size(); ++j)
    if (p(j) != 0) quadratic += p(j) * S.col(j).dot(p);
  const double gain = p.dot(r);
  for (int k = 0; k < halvings && share > 0; ++k) {
    double stretch = 0;
    for (const int i : rows_)
      if (p(i) > 0) stretch += p(i) * springs_[i].displacement(share * p(i));
    if (share * quadratic + stretch <= gain) {
      p *= share;
      return;
    }
    share = gain > stretch ? std::min((1 - exactness) * (gain - stretch) / quadratic, share / (1 + exactness))
                           : share / 2;
  }
  p.setZero();
}

/// Chooses the forces x of the next round, and D.
void SpringNewton::improve(const Symmetric& S, const Right& r, const Forces& p, int round) noexcept {
  const int next = round + 1;
  if (next >= first_secant && next <= last_secant) {
    for (const int i : rows_) {
      const PatchSpring& spring = springs_[i];
      const double x = std::max(p(i), least * spring.limit);
      set_slope(S, i, spring.displacement(x) / x);
      at_(i) = 0;
    }
    return;
  }
  bool renews = closed_ <= few_closed || !(error_ < fast * before_);
  const bool by_secant = round >= first_secant && round <= last_secant;
  for (const int i : rows_) {
    const bool was_open = at_(i) == 0 && !by_secant, is_open = p(i) == 0;
    if (was_open && is_open) continue;
    at_(i) = was_open || is_open ? alone(S, r, p, i) : p(i);
    renews = renews || was_open;
  }
  if (!renews) return;
  for (const int i : rows_)
    if (at_(i) > 0) set_slope(S, i, springs_[i].slope(at_(i)));
}

}  // namespace ricochet::contact
