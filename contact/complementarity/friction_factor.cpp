// SPDX-License-Identifier: BSD-2-Clause
// Newton's matrix of a friction system, Eᵀ A D + C, and its steps. The factor is that of the states of some
// earlier iterate. A point whose state has changed since then is held by a border (bordered_factor.hpp):
//
//   closes          its unknowns and equations are appended
//   opens           x = 0 for its unknowns; multipliers take up its equations
//   slips, stuck    μ x_n + t·x_t = 0; a multiplier takes up the equation along t; C is added across t
//   sticks, slid    C is taken away; the unknown and the equation along t are appended
#include <algorithm>
#include <cmath>

#include "contact/complementarity/friction_system.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Map;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double regular = 1e-11;   // smaller pivots, relative to max A_ii, leave the sign of det undecided
constexpr double least_part = 0.2;  // of a step; Broyden's update that leaves less is not made

Vector3d in_plane(const Vector2d& t) { return {0, t.x(), t.y()}; }

int unknowns_of(const FrictionSystem::Touch& touch, ContactState state) {
  return state == ContactState::open                        ? 0
         : touch.rows() == 3 && state == ContactState::slip ? 2
                                                            : touch.rows();
}

}  // namespace

void FrictionSystem::discard_factor() noexcept { has_factor_ = false; }

/// Direction in which the factor's unknowns of point k are meant.
const Vector2d& FrictionSystem::direction_in_factor(int k) const noexcept {
  return held_[k].state == held_[k].factored ? touch_[k].direction : held_[k].direction;
}

/// out = Eᵀ column of the unknowns of the factor, or Dᵀ column.
void FrictionSystem::compress(const double* column, Columns of, double* out) const noexcept {
  for (int k = 0; k < count_; ++k) {
    if (held_[k].factored == ContactState::open) continue;
    const double* const c = column + touch_[k].row;
    if (touch_[k].rows() == 1) {
      *out++ = c[0];
    } else if (held_[k].factored == ContactState::stick) {
      *out++ = c[0];
      *out++ = c[1];
      *out++ = c[2];
    } else {
      const Vector2d& t = direction_in_factor(k);
      const double s = of == Columns::D ? touch_[k].coefficient : 0;
      *out++ = c[0] - s * (t.x() * c[1] + t.y() * c[2]);
      *out++ = t.x() * c[2] - t.y() * c[1];
    }
  }
}

/// |w_t| / (μ p_n) of a slipping point.
double FrictionSystem::turning(const Touch& touch) const noexcept {
  const double flexibility = entry(touch.row);
  const double alone = flexibility > 0 ? -w_[touch.row] / flexibility : 0;
  const double normal = std::max(p_[touch.row], alone);
  return normal > 0 ? touch.slip / (touch.coefficient * normal) : 1e12 * sizes_.diagonal;
}

void FrictionSystem::renew_factor() noexcept {
  int unknowns = 0;
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    held_[k] = {.factored = touch.state, .state = touch.state, .at = unknowns, .direction = touch.direction};
    unknowns += unknowns_of(touch, touch.state);
  }
  auto J = factor_.begin(unknowns);
  const double ridge = proximal * sizes_.diagonal;
  int c = 0;
  const auto set_column = [&](const double* of) {
    compress(of, Columns::E, &J(0, c));
    J(c, c) += ridge;
    ++c;
  };
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    if (touch.state == ContactState::open) continue;
    const double *const first = A_.column(touch.row), *const second = first + A_.stride(),
                        *const third = second + A_.stride();
    if (touch.rows() == 1 || touch.state == ContactState::stick) {
      for (int d = 0; d < touch.rows(); ++d) set_column(A_.column(touch.row + d));
      continue;
    }
    const double x = touch.direction.x(), y = touch.direction.y(), mu = touch.coefficient;
    double* const __restrict moved = column_.data();
    for (int i = 0; i < rows_; ++i) moved[i] = first[i] - mu * (x * second[i] + y * third[i]);
    set_column(moved);
    for (int i = 0; i < rows_; ++i) moved[i] = x * third[i] - y * second[i];
    set_column(moved);
    held_[k].turning = turning(touch);
    J(c - 1, c - 1) += held_[k].turning;
  }
  factor_.factor();
  has_factor_ = true;
  entries_.clear();
  steps_.count = 0;
}

bool FrictionSystem::holds_states() const noexcept {
  if (!has_factor_) return false;
  for (int k = 0; k < count_; ++k)
    if (held_[k].state != touch_[k].state) return false;
  return true;
}

/// Appends an unknown of point k that moves its force along `move`, and its equation with an entry of C.
void FrictionSystem::append_unknown(int k, const Vector3d& move, const Vector3d& equation,
                                    double turning) noexcept {
  const auto multiply = [&](const Vector3d& x) {
    std::fill_n(column_.begin(), rows_, 0.0);
    for (int d = 0; d < touch_[k].rows(); ++d) {
      const double* const a = A_.column(touch_[k].row + d);
      if (const double factor = x(d); factor != 0)
        for (int i = 0; i < rows_; ++i) column_[i] += factor * a[i];
    }
  };
  const auto part = [&](const Entry& entry, const Vector3d& x) {
    const double* const c = &column_[touch_[entry.point].row];
    double sum = 0;
    for (int d = 0; d < touch_[entry.point].rows(); ++d) sum += c[d] * x(d);
    return sum;
  };
  const int at = factor_.border();
  factor_.append();
  entries_.push_back(
      {.point = k, .is_unknown = true, .turns = turning > 0, .move = move, .equation = equation, .sign = 1});
  multiply(equation);
  compress(column_.data(), Columns::D, factor_.row(at));
  for (int i = 0; i <= at; ++i)
    if (entries_[i].is_unknown) factor_.corner(at, i) = part(entries_[i], entries_[i].move);
  multiply(move);
  compress(column_.data(), Columns::E, factor_.column(at));
  for (int i = 0; i <= at; ++i)
    if (entries_[i].is_unknown) factor_.corner(i, at) = part(entries_[i], entries_[i].equation);
  factor_.corner(at, at) += proximal * sizes_.diagonal + turning;
}

/// Appends a multiplier: the unknowns of point k satisfy `condition` · x = 0 and its equations are taken up
/// along `free`; or with a compliance c, x · condition is added to them with 1/c. The rows are scaled so that
/// all pivots have the unit of A.
void FrictionSystem::append_multiplier(int k, const Vector3d& free, const Vector3d& condition,
                                       double compliance) noexcept {
  const int at = factor_.border();
  factor_.append();
  entries_.push_back({.point = k, .sign = compliance > 0 ? 1.0 : -1.0});
  const int unknowns = unknowns_of(touch_[k], held_[k].factored);
  for (int d = 0; d < unknowns; ++d) {
    factor_.column(at)[held_[k].at + d] = sizes_.diagonal * free(d);
    factor_.row(at)[held_[k].at + d] = sizes_.diagonal * condition(d);
  }
  factor_.corner(at, at) = compliance * sizes_.diagonal * sizes_.diagonal;
}

/// Makes the border hold the states. Returns false if that costs more than a new factor.
bool FrictionSystem::update_factor() noexcept {
  if (!has_factor_) return false;
  steps_.count = 0;
  kept_.clear();
  std::size_t count = 0;
  for (int i = 0; i < factor_.border(); ++i) {
    const int k = entries_[i].point;
    if (held_[k].state != touch_[k].state) continue;
    kept_.push_back(i);
    entries_[count++] = entries_[i];
  }
  entries_.resize(count);
  int wanted = static_cast<int>(count);
  changed_.clear();
  for (int k = 0; k < count_; ++k) {
    const Held& held = held_[k];
    if (held.state == touch_[k].state) continue;
    changed_.push_back(k);
    if (held.factored == touch_[k].state) continue;
    wanted += held.factored == ContactState::open     ? unknowns_of(touch_[k], touch_[k].state)
              : touch_[k].state == ContactState::open ? unknowns_of(touch_[k], held.factored)
                                                      : 2;
  }
  if (wanted > factor_.most()) return false;
  factor_.keep(kept_.data(), static_cast<int>(count));
  for (const int k : changed_) held_[k].state = touch_[k].state;
  for (const int k : changed_) {
    Held& held = held_[k];
    const Touch& touch = touch_[k];
    if (held.state == held.factored) continue;
    const Vector2d& t = touch.direction;
    if (touch.state == ContactState::open) {
      for (int d = 0; d < unknowns_of(touch, held.factored); ++d)
        append_multiplier(k, Vector3d::Unit(d), Vector3d::Unit(d), 0);
    } else if (held.factored == ContactState::open) {
      if (touch.rows() == 3 && touch.state == ContactState::slip) {
        append_unknown(k, Vector3d::UnitX() - touch.coefficient * in_plane(t), Vector3d::UnitX(), 0);
        held.turning = turning(touch);
        append_unknown(k, in_plane(across(t)), in_plane(across(t)), held.turning);
      } else {
        for (int d = 0; d < touch.rows(); ++d) append_unknown(k, Vector3d::Unit(d), Vector3d::Unit(d), 0);
      }
    } else if (touch.state == ContactState::slip) {
      append_multiplier(k, in_plane(t), in_plane(t) + touch.coefficient * Vector3d::UnitX(), 0);
      if (const double c = turning(touch); c > 0)
        append_multiplier(k, in_plane(across(t)), in_plane(across(t)), -1 / c);
    } else {
      append_unknown(k, in_plane(held.direction), in_plane(held.direction), 0);
      if (held.turning > 0) append_multiplier(k, Vector3d::UnitY(), Vector3d::UnitY(), 1 / held.turning);
    }
  }
  factor_.complete(static_cast<int>(count));
  return true;
}

/// Computes the step that Newton's method, or Broyden's from the second step with a factor on, subtracts.
/// Returns false if the matrix is singular to working precision.
bool FrictionSystem::find_step() noexcept {
  const int unknowns = factor_.size(), border = factor_.border(), size = unknowns + border;
  double* const x = x_.data();
  compress(w_.data(), Columns::E, x);
  for (int i = 0; i < border; ++i) {
    const Entry& entry = entries_[i];
    double sum = 0;
    for (int d = 0; entry.is_unknown && d < touch_[entry.point].rows(); ++d)
      sum += entry.equation(d) * w_[touch_[entry.point].row + d];
    x[unknowns + i] = sum;
  }
  if (!factor_.solve(x, x + unknowns)) return false;
  // A small force turns with little effort, and C changes with it by orders of magnitude. The part of C in
  // its own diagonal entry is therefore brought up to date.
  const auto update = [&](int k, double& turn) {
    const double alone = tangential_entry(touch_[k].row);
    turn *= (held_[k].turning + alone) / (turning(touch_[k]) + alone);
  };
  for (int k = 0; k < count_; ++k)
    if (held_[k].factored == ContactState::slip && held_[k].state == ContactState::slip)
      update(k, x[held_[k].at + 1]);
  for (int i = 0; i < border; ++i)
    if (entries_[i].turns) update(entries_[i].point, x[unknowns + i]);

  // The good update in the form that stores only the steps (Kelley 1995, section 7.3).
  Map<Eigen::VectorXd> step(x, size);
  const auto earlier = [&](int j) {
    return Map<Eigen::VectorXd>(steps_.step.data() + static_cast<std::ptrdiff_t>(j) * steps_.stride, size);
  };
  if (steps_.count == Steps::most) steps_.count = 0;
  for (int j = 0; j + 1 < steps_.count; ++j)
    step += earlier(j).dot(step) / steps_.squares[j] * earlier(j + 1);
  if (steps_.count > 0) {
    const int last = steps_.count - 1;
    const double part = 1 - earlier(last).dot(step) / steps_.squares[last];
    if (std::abs(part) > least_part)
      step /= part;
    else
      steps_.count = 0;
  }
  earlier(steps_.count) = step;
  steps_.squares[steps_.count] = step.squaredNorm();
  if (steps_.squares[steps_.count] > 0) ++steps_.count;
  return true;
}

/// Subtracts the step from the forces. Returns false if they are not finite.
bool FrictionSystem::make_step() noexcept {
  const double* const x = x_.data();
  Map<Eigen::VectorXd> change(column_.data(), rows_);
  change.setZero();
  for (int k = 0; k < count_; ++k) {
    const double* const of = x + held_[k].at;
    double* const d = &column_[touch_[k].row];
    if (held_[k].factored == ContactState::open) continue;
    if (touch_[k].rows() == 3 && held_[k].factored == ContactState::slip) {
      const Vector2d& t = direction_in_factor(k);
      d[0] = of[0];
      Map<Vector2d>(d + 1) = of[1] * across(t) - touch_[k].coefficient * of[0] * t;
    } else {
      std::copy_n(of, touch_[k].rows(), d);
    }
  }
  for (int i = 0; i < factor_.border(); ++i) {
    const Entry& entry = entries_[i];
    for (int d = 0; entry.is_unknown && d < touch_[entry.point].rows(); ++d)
      column_[touch_[entry.point].row + d] += x[factor_.size() + i] * entry.move(d);
  }
  double sum = 0;
  for (int k = 0; k < count_; ++k) {
    Touch& touch = touch_[k];
    const double* const d = &column_[touch.row];
    double* const p = &p_[touch.row];
    if (touch.state == ContactState::open) continue;
    if (touch.rows() == 1 || touch.state == ContactState::stick) {
      for (int i = 0; i < touch.rows(); ++i) p[i] -= d[i];
    } else {
      p[0] -= d[0];
      const double most = touch.coefficient * std::max(p[0], 0.0);
      const double turn = across(touch.direction).dot(Map<const Vector2d>(d + 1));
      if (most > 0)
        touch.direction = (most * touch.direction + across(touch.direction) * turn).stableNormalized();
      Map<Vector2d>(p + 1) = -most * touch.direction;
    }
    for (int i = 0; i < touch.rows(); ++i) sum += p[i];
  }
  return std::isfinite(sum);
}

/// The signs of the determinants of all solutions add up to 1. If that of a regular solution is negative,
/// there are others. The factor need not be of the last iterate: iterations with it converged, which they
/// would not if the signs differed.
bool FrictionSystem::has_negative_determinant() noexcept {
  const bool slips = std::any_of(touch_.begin(), touch_.begin() + count_,
                                 [](const Touch& touch) { return touch.state == ContactState::slip; });
  if (!slips) return false;
  if (!holds_states() && !update_factor()) renew_factor();
  double sign = factor_.sign(regular * sizes_.diagonal);
  for (const Entry& entry : entries_) sign *= entry.sign;
  return sign < 0;
}

}  // namespace ricochet::contact
