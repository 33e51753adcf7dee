// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/friction_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

using Eigen::Map;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double precision = 3e-13;  // of w, relative to |r|_∞ + ‖A‖_∞ |p|_∞, over normal rows or over all
constexpr double polished_to = 0.01;   // of that precision
constexpr double negligible = 1e-14;   // share of |p|_∞ that changes w by less than its tolerance
constexpr double proximal = 1e-13;     // share of max A_ii added to the diagonal against singular matrices
constexpr int patience_of_newton = 8;  // steps allowed without halving the error
constexpr int first_sweeps = 5;
constexpr double regular = 1e-11;  // smaller pivots, relative to max A_ii, leave the sign of det undecided
constexpr double distinct = 1e-6;  // of solutions, relative to the largest force
constexpr int steps_to_another = 12;
constexpr double part_of_largest = 0.5;  // contradictions above it change states
constexpr double certain = 4;            // residuals by which a slip must be reversed

Map<Vector2d> tangential(std::vector<double>& x, int row) { return Map<Vector2d>(x.data() + row + 1); }
Map<const Vector2d> tangential(const std::vector<double>& x, int row) {
  return Map<const Vector2d>(x.data() + row + 1);
}

Vector2d across(const Vector2d& t) { return {-t.y(), t.x()}; }

/// The force that makes a displacement alone; the largest number if none does.
double force_for(double displacement, double flexibility) {
  return flexibility > 0 ? displacement / flexibility : std::numeric_limits<double>::max();
}

}  // namespace

FrictionSystem::FrictionSystem(int capacity) : factor_(capacity) {
  const auto n = static_cast<std::size_t>(std::max(capacity, 1));
  touch_.resize(n);
  best_touch_.resize(n);
  answer_touch_.resize(n);
  factor_state_.resize(n);
  A_.resize(n * n);
  for (std::vector<double>* x :
       {&p_, &w_, &r_, &x_, &column_, &best_p_, &answer_, &plain_A_, &plain_r_, &centre_})
    x->resize(n);
}

void FrictionSystem::clear() noexcept { count_ = rows_ = factor_count_ = 0; }

void FrictionSystem::add(double coefficient) noexcept {
  touch_[count_] = {.row = rows_, .coefficient = coefficient};
  rows_ += touch_[count_++].rows();
}

void FrictionSystem::set_matrix() noexcept {
  norm_ = rows_ > 0 ? A().cwiseAbs().colwise().sum().maxCoeff() : 0;
  diagonal_ = rows_ > 0 ? A().diagonal().maxCoeff() : 0;
  factor_count_ = 0;
}

double FrictionSystem::scale() const { return largest_r_ + norm_ * largest_of(p_, rows_); }

void FrictionSystem::evaluate() noexcept {
  Map<Eigen::VectorXd> w(w_.data(), rows_);
  const double* const A = A_.data();
  for (int i = 0; i < rows_; ++i) w_[i] = -r_[i];
  for (int k = 0; k < count_; ++k) {
    const int row = touch_[k].row;
    const double* const column = A + static_cast<std::ptrdiff_t>(row) * rows_;
    const double a = p_[row];
    if (touch_[k].rows() == 1) {
      if (a == 0) continue;
#pragma GCC ivdep
      for (int i = 0; i < rows_; ++i) w_[i] += a * column[i];
      continue;
    }
    const double b = p_[row + 1], c = p_[row + 2];
    if (a == 0 && b == 0 && c == 0) continue;
    const double *const second = column + rows_, *const third = second + rows_;
    double* const out = w_.data();
#pragma GCC ivdep
    for (int i = 0; i < rows_; ++i) out[i] += a * column[i] + b * second[i] + c * third[i];
  }
  const double by_forces = norm_ * largest_of(p_, rows_);
  tolerance_ = precision * (largest_r_ + by_forces);
  normal_tolerance_ = precision * (largest_normal_r_ + by_forces);
}

/// Moves the force of point k to the set of its state. Returns whether the state changes: a force outside the
/// cone slips, a tensile one opens.
bool FrictionSystem::project(int k) noexcept {
  Touch& touch = touch_[k];
  const ContactState before = touch.state;
  double& normal = p_[touch.row];
  if (before != ContactState::open && normal < 0) touch.state = ContactState::open;
  if (touch.state == ContactState::open) {
    std::fill_n(&normal, touch.rows(), 0.0);
    return before != ContactState::open;
  }
  if (touch.rows() == 1) return false;
  auto t = tangential(p_, touch.row);
  const double size = t.norm(), most = touch.coefficient * normal;
  if (touch.state == ContactState::stick && size > most) {
    touch.state = ContactState::slip;
    touch.direction = -t / size;
    touch.slip = 0;
  }
  if (touch.state == ContactState::slip) t = -most * touch.direction;
  return touch.state != before;
}

/// By how much the force of point k contradicts its state, or would change if another state stopped it alone;
/// 0 if the state stays. With caution, a reversed slip must exceed the residual of the rows that Newton's
/// method solves, of which it can be an effect.
double FrictionSystem::contradiction(int k) const noexcept {
  const Touch& touch = touch_[k];
  const int row = touch.row;
  const double normal = w_[row];
  if (touch.state == ContactState::open)
    return normal < -normal_tolerance_ ? force_for(-normal, entry(row)) : 0;
  double worst = std::max(0.0, -p_[row]);
  if (touch.rows() == 1) return worst;
  if (touch.state == ContactState::stick)
    return std::max(worst, tangential(p_, row).norm() - touch.coefficient * std::max(p_[row], 0.0));
  const auto w = tangential(w_, row);
  const double along = touch.direction.dot(w);
  const double residual = std::max(std::abs(normal), std::abs(across(touch.direction).dot(w)));
  if (along < -tolerance_ - (cautious_ ? certain * residual : 0))
    worst = std::max(worst, force_for(-along, tangential_entry(row)));
  return worst;
}

/// Changes the state of point k, whose force contradicts it, and moves the force to the set of the new state.
/// An open point that closes sticks if the forces that would stop it alone, were its rows not coupled, are in
/// the cone.
void FrictionSystem::change_state(int k) noexcept {
  Touch& touch = touch_[k];
  const int row = touch.row;
  if (touch.state == ContactState::open) {
    touch.state = ContactState::stick;
    if (touch.rows() == 1) return;
    touch.slip = tangential(w_, row).norm();
    if (touch.slip * entry(row) <= touch.coefficient * -w_[row] * tangential_entry(row)) return;
    touch.state = ContactState::slip;
    touch.direction = tangential(w_, row) / touch.slip;
  } else if (touch.state == ContactState::slip && p_[row] >= 0) {
    touch.state = ContactState::stick;
  } else {
    project(k);
  }
}

/// Measures the slip of all points and changes the states that the forces contradict, or with caution those
/// that they contradict most: these are often the reason for the others. Returns whether anything has
/// changed.
bool FrictionSystem::classify() noexcept {
  const double negligible_force = negligible * largest_of(p_, rows_);
  bool changed = false;
  double largest = 0;
  for (int k = 0; k < count_; ++k) {
    Touch& touch = touch_[k];
    double& normal = p_[touch.row];
    if (touch.state == ContactState::slip)
      touch.slip = std::max(0.0, touch.direction.dot(tangential(w_, touch.row)));
    if (normal < 0 && normal >= -negligible_force) {
      normal = 0;
      changed = true;
    }
    largest = std::max(largest, x_[k] = contradiction(k));
  }
  contradicted_ = false;
  if (largest == 0) return changed;
  for (int k = 0; k < count_; ++k) {
    if (x_[k] == 0) continue;
    if (!cautious_ || x_[k] >= part_of_largest * largest)
      change_state(k);
    else
      contradicted_ = true;
  }
  return true;
}

/// Distance of w from the values that p and the states admit, in units in which all rows have the same
/// tolerance.
double FrictionSystem::violation() const noexcept {
  // A fast belt makes large slips, but no large gaps.
  const double weight = normal_tolerance_ > 0 ? tolerance_ / normal_tolerance_ : 1;
  double worst = 0;
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    const double normal = weight * w_[touch.row];
    double error = std::abs(normal);
    if (touch.state == ContactState::open) {
      error = -normal;
    } else if (touch.rows() == 3) {
      const auto w = tangential(w_, touch.row);
      if (touch.state == ContactState::stick) {
        error = std::max(error, w.norm());
      } else {
        error = std::max({error, std::abs(across(touch.direction).dot(w)), -touch.direction.dot(w)});
      }
    }
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

/// Returns whether the error has fallen to less than half of the smallest one so far.
bool FrictionSystem::keep_best(double error) noexcept {
  if (tolerance_ > 0) error /= tolerance_;
  const bool halved = error < 0.5 * best_error_;
  if (error < best_error_) {
    best_error_ = error;
    std::copy_n(p_.begin(), rows_, best_p_.begin());
    std::copy_n(touch_.begin(), count_, best_touch_.begin());
  }
  return halved;
}

void FrictionSystem::restore_best() noexcept {
  std::copy_n(best_p_.begin(), rows_, p_.begin());
  std::copy_n(best_touch_.begin(), count_, touch_.begin());
  evaluate();
}

bool FrictionSystem::has_factor() const noexcept {
  if (factor_count_ != count_) return false;
  for (int k = 0; k < count_; ++k)
    if (factor_state_[k] != touch_[k].state) return false;
  return true;
}

/// out = Eᵀ column.
void FrictionSystem::compress(const double* column, double* out) const noexcept {
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    const double* const c = column + touch.row;
    if (touch.state == ContactState::open) continue;
    if (touch.rows() == 1) {
      *out++ = c[0];
    } else if (touch.state == ContactState::stick) {
      *out++ = c[0];
      *out++ = c[1];
      *out++ = c[2];
    } else {
      const double x = touch.direction.x(), y = touch.direction.y();
      *out++ = c[0];
      *out++ = x * c[2] - y * c[1];
    }
  }
}

void FrictionSystem::renew_factor() noexcept {
  int unknowns = 0;
  for (int k = 0; k < count_; ++k)
    unknowns += touch_[k].state == ContactState::open    ? 0
                : touch_[k].rows() == 1                  ? 1
                : touch_[k].state == ContactState::stick ? 3
                                                         : 2;
  auto J = factor_.begin(unknowns);
  const double ridge = proximal * diagonal_;
  int c = 0;
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    factor_state_[k] = touch.state;
    if (touch.state == ContactState::open) continue;
    const double* const first = A_.data() + static_cast<std::ptrdiff_t>(touch.row) * rows_;
    const double *const second = first + rows_, *const third = second + rows_;
    if (touch.rows() == 1 || touch.state == ContactState::stick) {
      for (int d = 0; d < touch.rows(); ++d, ++c) {
        compress(first + static_cast<std::ptrdiff_t>(d) * rows_,
                 J.data() + static_cast<std::ptrdiff_t>(c) * unknowns);
        J(c, c) += ridge;
      }
      continue;
    }
    const double x = touch.direction.x(), y = touch.direction.y(), mu = touch.coefficient;
#pragma GCC ivdep
    for (int i = 0; i < rows_; ++i) column_[i] = first[i] - mu * (x * second[i] + y * third[i]);
    compress(column_.data(), J.data() + static_cast<std::ptrdiff_t>(c) * unknowns);
    J(c, c) += ridge;
    ++c;
#pragma GCC ivdep
    for (int i = 0; i < rows_; ++i) column_[i] = x * third[i] - y * second[i];
    compress(column_.data(), J.data() + static_cast<std::ptrdiff_t>(c) * unknowns);
    const double alone = first[touch.row] > 0 ? -w_[touch.row] / first[touch.row] : 0;
    const double normal = std::max(p_[touch.row], alone);
    J(c, c) += ridge + (normal > 0 ? touch.slip / (mu * normal) : 1e12 * diagonal_);
    ++c;
  }
  factor_count_ = count_;
  factor_.factor();
}

/// Returns false if the factor is singular to working precision.
bool FrictionSystem::newton() noexcept {
  compress(w_.data(), x_.data());
  if (!factor_.solve(x_.data())) return false;
  const double* x = x_.data();
  for (int k = 0; k < count_; ++k) {
    Touch& touch = touch_[k];
    if (touch.state == ContactState::open) continue;
    double* const p = &p_[touch.row];
    if (touch.state == ContactState::stick) {
      for (int d = 0; d < touch.rows(); ++d) p[d] -= *x++;
    } else {
      p[0] -= *x++;
      const double most = touch.coefficient * std::max(p[0], 0.0);
      const double turn = *x++;
      if (most > 0)
        touch.direction = (most * touch.direction + across(touch.direction) * turn).stableNormalized();
      tangential(p_, touch.row) = -most * touch.direction;
    }
  }
  double sum = 0;
  for (int i = 0; i < rows_; ++i) sum += p_[i];
  return std::isfinite(sum);
}

/// The problem of point k alone, with the forces of all others.
FrictionPoint FrictionSystem::local(int k) const noexcept {
  const int row = touch_[k].row;
  FrictionPoint point;
  point.coefficient = touch_[k].coefficient;
  Vector3d w;
  for (int d = 0; d < 3; ++d) {
    const double* const column = A_.data() + static_cast<std::ptrdiff_t>(row + d) * rows_;
    w(d) = Map<const Eigen::VectorXd>(column, rows_).dot(Map<const Eigen::VectorXd>(p_.data(), rows_)) -
           r_[row + d];
    point.S.col(d) = Map<const Vector3d>(column + row);
  }
  point.S.diagonal().array() += proximal * diagonal_;
  point.r = point.S * Map<const Vector3d>(&p_[row]) - w;
  return point;
}

void FrictionSystem::set(int k, const FrictionPoint::Solution& solution) noexcept {
  Touch& touch = touch_[k];
  touch.state = solution.state;
  touch.direction = solution.direction;
  Vector3d::Map(&p_[touch.row]) = solution.p;
}

/// Solves each point in turn with the forces of the others.
void FrictionSystem::sweep() noexcept {
  for (int k = 0; k < count_; ++k) {
    Touch& touch = touch_[k];
    const int row = touch.row;
    if (touch.rows() == 1) {
      const double* const column = A_.data() + static_cast<std::ptrdiff_t>(row) * rows_;
      const double w =
          Map<const Eigen::VectorXd>(column, rows_).dot(Map<const Eigen::VectorXd>(p_.data(), rows_)) -
          r_[row];
      p_[row] = std::max(0.0, p_[row] - w / (column[row] + proximal * diagonal_));
      touch.state = p_[row] > 0 ? ContactState::stick : ContactState::open;
      continue;
    }
    const FrictionPoint point = local(k);
    const bool ambiguous = point.may_be_ambiguous();
    const FrictionPoint::Solutions found = point.solve(ambiguous);
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < found.count; ++i) {
      const double distance = (found.at[i].p - Map<const Vector3d>(&p_[row])).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = i;
      }
    }
    if (nearest >= 0) set(k, found.at[nearest]);
  }
  evaluate();
}

void FrictionSystem::guess_state(int k, ContactState before, double slip) noexcept {
  Touch& touch = touch_[k];
  touch.slip = slip;
  touch.state = p_[touch.row] > 0 ? ContactState::stick : ContactState::open;
  if (touch.rows() == 3 && touch.state == ContactState::stick) {
    const double size = tangential(p_, touch.row).norm();
    if (size > 0 &&
        (before == ContactState::slip || size >= touch.coefficient * p_[touch.row] * (1 - 1e-9))) {
      touch.state = ContactState::slip;
      touch.direction = -tangential(p_, touch.row) / size;
    }
  }
  project(k);
}

/// Newton's method until the error is below `target` and no state contradicts the forces, or until the error
/// has not halved in a number of steps. The first step keeps the states, unless all points are open: w
/// belongs to forces of another r there, and would change many of them wrongly. A factor serves for further
/// steps while the states stay and each step reduces the error to a tenth, and for a last one to round-off:
/// the heat of a point that hardly slips errs by the residual.
SolveStatus FrictionSystem::try_newton(int& left, SolveStatistics& statistics, double target) noexcept {
  best_error_ = std::numeric_limits<double>::infinity();
  double before = std::numeric_limits<double>::infinity();
  int patience = patience_of_newton;
  contradicted_ = false;
  bool polished = false;
  evaluate();
  const bool is_open = std::all_of(touch_.begin(), touch_.begin() + count_,
                                   [](const Touch& touch) { return touch.state == ContactState::open; });
  for (bool keeps = !is_open;; keeps = false) {
    if (!keeps && classify()) {
      evaluate();
      ++statistics.pivots;
    }
    const double error = violation();
    if (!std::isfinite(error + tolerance_)) return SolveStatus::not_finite;
    if (keep_best(error)) patience = patience_of_newton;
    if (error <= std::max(target, tolerance_) && !contradicted_) {
      if (target > 0 || polished || error <= polished_to * tolerance_ || !has_factor())
        return SolveStatus::solved;
      polished = true;
    }
    if (patience-- <= 0 || left-- <= 0) return SolveStatus::limited;
    if (!has_factor() || error > 0.1 * before) {
      renew_factor();
      ++statistics.renewals;
    }
    before = error;
    if (!newton()) return SolveStatus::limited;
    evaluate();
  }
}

void FrictionSystem::keep_answer() noexcept {
  std::copy_n(p_.begin(), rows_, answer_.begin());
  std::copy_n(touch_.begin(), count_, answer_touch_.begin());
}

void FrictionSystem::restore_answer() noexcept {
  std::copy_n(answer_.begin(), rows_, p_.begin());
  std::copy_n(answer_touch_.begin(), count_, touch_.begin());
}

SolveStatus FrictionSystem::solve(double largest_r, double largest_normal_r, int& left,
                                  SolveStatistics& statistics) noexcept {
  largest_r_ = largest_r;
  largest_normal_r_ = largest_normal_r;
  keep_answer();
  SolveStatus status = try_newton(left, statistics);
  if (status == SolveStatus::limited && left > 0) {
    ++statistics.fallbacks;
    status = follow_load(left, statistics);
    if (status == SolveStatus::limited) {
      cautious_ = false;
      restore_answer();
      for (int k = 0; k < first_sweeps && left > 0; ++k, --left) sweep();
      status = try_newton(left, statistics);  // without iterations left, it measures the answer
      if (status == SolveStatus::limited) status = follow_paths(left, statistics);
      cautious_ = true;
    }
  }
  if (status == SolveStatus::limited) restore_best();
  return status;
}

/// The signs of the determinants of all solutions add up to 1. If that of a regular solution is negative,
/// there are others. The factor need not be of the last iterate: iterations with it converged, which they
/// would not if the signs differed.
bool FrictionSystem::has_negative_determinant() noexcept {
  const bool slips = std::any_of(touch_.begin(), touch_.begin() + count_,
                                 [](const Touch& touch) { return touch.state == ContactState::slip; });
  if (!slips) return false;
  if (!has_factor()) renew_factor();
  return factor_.sign(regular * diagonal_) < 0;
}

/// Where p_n may reduce w_n, a point can have other forces while those of the rest stay. Newton's method from
/// there shows whether they belong to another solution.
bool FrictionSystem::find_another(SolveStatistics& statistics) noexcept {
  keep_answer();
  const auto differs = [this] {
    double difference = 0;
    for (int i = 0; i < rows_; ++i) difference = std::max(difference, std::abs(p_[i] - answer_[i]));
    return difference > distinct * std::max(largest_of(answer_, rows_), largest_of(p_, rows_));
  };
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    const double* const column = A_.data() + static_cast<std::ptrdiff_t>(touch.row) * (rows_ + 1);
    if (touch.rows() == 1 || column[0] > touch.coefficient * std::hypot(column[1], column[2])) continue;
    const FrictionPoint::Solutions found = local(k).solve(true);
    for (int i = 0; i < found.count; ++i) {
      set(k, found.at[i]);
      int left = steps_to_another;
      if (differs() && try_newton(left, statistics) == SolveStatus::solved && differs()) return true;
      restore_answer();
    }
  }
  return false;
}

}  // namespace ricochet::contact
