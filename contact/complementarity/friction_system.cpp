// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/friction_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/simd/dense.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Map;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double precision = 3e-13;  // of w, relative to |r|_∞ + ‖A‖_∞ |p|_∞, over normal rows or over all
constexpr double polished_to = 0.01;   // of that precision
constexpr double rounded = 2e-15;      // relative to |p|_∞: forces rounded to their cones
constexpr double negligible = 1e-14;   // share of |p|_∞ that changes w by less than its tolerance
constexpr int patience_of_newton = 8;  // steps allowed without halving the error
constexpr int first_sweeps = 5;
constexpr double distinct = 1e-6;  // of solutions, relative to the largest force
constexpr int steps_to_another = 12;
constexpr int few_steps = 2,
              unknowns_of_a_step = 20;   // a factor of n unknowns costs as much as 2 + n/20 steps
constexpr double part_of_largest = 0.5;  // contradictions above it change states
constexpr double certain = 4;            // residuals by which a slip must be reversed

Map<Vector2d> tangential(std::vector<double>& x, int row) { return Map<Vector2d>(x.data() + row + 1); }
Map<const Vector2d> tangential(const std::vector<double>& x, int row) {
  return Map<const Vector2d>(x.data() + row + 1);
}

/// The force that makes a displacement alone; the largest number if none does.
double force_for(double displacement, double flexibility) {
  return flexibility > 0 ? displacement / flexibility : std::numeric_limits<double>::max();
}

}  // namespace

FrictionSystem::FrictionSystem(int capacity) : factor_(capacity), A_{.own = ReservedMatrix(capacity)} {
  const auto n = static_cast<std::size_t>(std::max(capacity, 1));
  touch_.resize(n);
  best_.touch.resize(n);
  answer_.touch.resize(n);
  held_.resize(n);
  const auto border = static_cast<std::size_t>(BorderedFactor::most(capacity));
  entries_.reserve(border);
  kept_.reserve(border);
  changed_.reserve(n);
  for (std::vector<double>* x : {&p_, &w_, &r_, &column_, &product_.p, &product_.Ap, &best_.p, &answer_.p,
                                 &plain_.A, &plain_.r, &plain_.centre})
    x->resize(n);
  x_.resize(n + border);
  steps_.stride = static_cast<std::ptrdiff_t>(n + border);
  steps_.step.resize((n + border) * Steps::most);
}

void FrictionSystem::clear() noexcept {
  count_ = rows_ = 0;
  A_.own.begin(0);
  discard_factor();
}

void FrictionSystem::add(double coefficient) noexcept {
  touch_[count_] = {.row = rows_, .coefficient = coefficient};
  held_[count_] = {};
  rows_ += touch_[count_++].rows();
}

void FrictionSystem::set_matrix() noexcept {
  product_.rows = 0;
  sizes_.norm = simd::dense().norm(static_cast<std::size_t>(rows_), A_.column(0),
                                   static_cast<std::size_t>(A_.stride()));
  sizes_.diagonal = 0;
  for (int i = 0; i < rows_; ++i) sizes_.diagonal = std::max(sizes_.diagonal, entry(i));
}

double FrictionSystem::scale() const { return sizes_.r + sizes_.norm * largest_of(p_, rows_); }

void FrictionSystem::evaluate() noexcept {
  std::copy_n(p_.begin(), rows_, product_.p.begin());
  product_.rows = rows_;
  const auto n = static_cast<std::size_t>(rows_);
  // Rounding is least if the sum begins with −r, which it nearly cancels.
  for (int i = 0; i < rows_; ++i) w_[i] = -r_[i];
  simd::add_product(n, A_.column(0), static_cast<std::size_t>(A_.stride()), p_.data(), w_.data());
  for (int i = 0; i < rows_; ++i) product_.Ap[i] = w_[i] + r_[i];
  set_tolerances();
}

bool FrictionSystem::has_product(const double* p) const noexcept {
  if (product_.rows != rows_) return false;
  const double most = rounded * largest_of(product_.p, rows_);
  for (int i = 0; i < rows_; ++i)
    if (!(std::abs(p[i] - product_.p[i]) <= most)) return false;
  return true;
}

void FrictionSystem::set_tolerances() noexcept {
  const double by_forces = sizes_.norm * largest_of(p_, rows_);
  sizes_.tolerance = precision * (sizes_.r + by_forces);
  sizes_.of_normals = precision * (sizes_.normal_r + by_forces);
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
    return normal < -sizes_.of_normals ? force_for(-normal, entry(row)) : 0;
  double worst = std::max(0.0, -p_[row]);
  if (touch.rows() == 1) return worst;
  if (touch.state == ContactState::stick)
    return std::max(worst, tangential(p_, row).norm() - touch.coefficient * std::max(p_[row], 0.0));
  const auto w = tangential(w_, row);
  const double along = touch.direction.dot(w);
  const double residual = std::max(std::abs(normal), std::abs(across(touch.direction).dot(w)));
  if (along < -sizes_.tolerance - (cautious_ ? certain * residual : 0))
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
  const double weight = sizes_.of_normals > 0 ? sizes_.tolerance / sizes_.of_normals : 1;
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
  if (sizes_.tolerance > 0) error /= sizes_.tolerance;
  const bool halved = error < 0.5 * best_.error;
  if (error < best_.error) {
    best_.error = error;
    std::copy_n(p_.begin(), rows_, best_.p.begin());
    std::copy_n(touch_.begin(), count_, best_.touch.begin());
  }
  return halved;
}

void FrictionSystem::restore_best() noexcept {
  std::copy_n(best_.p.begin(), rows_, p_.begin());
  std::copy_n(best_.touch.begin(), count_, touch_.begin());
  evaluate();
}

/// The problem of point k alone, with the forces of all others.
FrictionPoint FrictionSystem::local(int k) const noexcept {
  const int row = touch_[k].row;
  FrictionPoint point;
  point.coefficient = touch_[k].coefficient;
  Vector3d w;
  for (int d = 0; d < 3; ++d) {
    const double* const of_row = A_.column(row + d);
    w(d) = Map<const Eigen::VectorXd>(of_row, rows_).dot(Map<const Eigen::VectorXd>(p_.data(), rows_)) -
           r_[row + d];
    point.S.col(d) = Map<const Vector3d>(of_row + row);
  }
  point.S.diagonal().array() += proximal * sizes_.diagonal;
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
      const double* const of_row = A_.column(row);
      const double w =
          Map<const Eigen::VectorXd>(of_row, rows_).dot(Map<const Eigen::VectorXd>(p_.data(), rows_)) -
          r_[row];
      p_[row] = std::max(0.0, p_[row] - w / (of_row[row] + proximal * sizes_.diagonal));
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

/// Whether a new factor is cheaper than the further steps that the one kept would need.
bool FrictionSystem::is_slow(double error, double before, double goal) const noexcept {
  if (error <= goal || std::isinf(before)) return false;
  if (exact_) return error > 0.1 * before;
  if (!(error < 0.9 * before)) return true;
  return std::log(error / goal) >
         (few_steps + factor_.size() / unknowns_of_a_step) * std::log(before / error);
}

/// Newton's method until the error is below `target` and no state contradicts the forces, or until the error
/// has not halved in a number of steps. The first step keeps the states, unless all points are open: w
/// belongs to forces of another r there, and would change many of them wrongly. The factor is
/// updated when states change, unless that or the further steps cost more than a new one, and serves for a
/// last step to round-off: the heat of a point that hardly slips errs by the residual.
SolveStatus FrictionSystem::try_newton(int& left, SolveStatistics& statistics, double target) noexcept {
  best_.error = std::numeric_limits<double>::infinity();
  double before = std::numeric_limits<double>::infinity();
  int patience = patience_of_newton;
  contradicted_ = false;
  bool polished = false;
  steps_.count = 0;
  // Forces of the step before: their product is known.
  if (has_product(p_.data())) {
    for (int i = 0; i < rows_; ++i) w_[i] = product_.Ap[i] - r_[i];
    set_tolerances();
  } else {
    evaluate();
  }
  const bool is_open = std::all_of(touch_.begin(), touch_.begin() + count_,
                                   [](const Touch& touch) { return touch.state == ContactState::open; });
  for (bool keeps = !is_open;; keeps = false) {
    if (!keeps && classify()) {
      evaluate();
      ++statistics.pivots;
    }
    const double error = violation();
    if (!std::isfinite(error + sizes_.tolerance)) return SolveStatus::not_finite;
    if (keep_best(error)) patience = patience_of_newton;
    if (error <= std::max(target, sizes_.tolerance) && !contradicted_) {
      if (target > 0 || polished || error <= polished_to * sizes_.tolerance || !holds_states())
        return SolveStatus::solved;
      polished = true;
    }
    if (patience-- <= 0 || left-- <= 0) return SolveStatus::limited;
    if (holds_states() ? is_slow(error, before, std::max(target, sizes_.tolerance))
                       : exact_ || !update_factor()) {
      renew_factor();
      ++statistics.renewals;
    }
    before = error;
    if (!find_step() || !make_step()) return SolveStatus::limited;
    evaluate();
  }
}

void FrictionSystem::keep_answer() noexcept {
  std::copy_n(p_.begin(), rows_, answer_.p.begin());
  std::copy_n(touch_.begin(), count_, answer_.touch.begin());
}

void FrictionSystem::restore_answer() noexcept {
  std::copy_n(answer_.p.begin(), rows_, p_.begin());
  std::copy_n(answer_.touch.begin(), count_, touch_.begin());
}

SolveStatus FrictionSystem::solve(double largest_r, double largest_normal_r, int& left,
                                  SolveStatistics& statistics) noexcept {
  sizes_.r = largest_r;
  sizes_.normal_r = largest_normal_r;
  keep_answer();
  const bool has_earlier_factor = has_factor_;  // perhaps of another matrix
  SolveStatus status = try_newton(left, statistics);
  if (status == SolveStatus::limited && has_earlier_factor) {
    discard_factor();
    restore_answer();
    status = try_newton(left, statistics);
  }
  if (status == SolveStatus::limited && left > 0) {
    ++statistics.fallbacks;
    exact_ = true;
    restore_answer();
    status = try_newton(left, statistics);
    if (status == SolveStatus::limited) status = follow_load(left, statistics);
    if (status == SolveStatus::limited) {
      cautious_ = false;
      restore_answer();
      for (int k = 0; k < first_sweeps && left > 0; ++k, --left) sweep();
      status = try_newton(left, statistics);  // without iterations left, it measures the answer
      if (status == SolveStatus::limited) status = follow_paths(left, statistics);
      cautious_ = true;
    }
    exact_ = false;
  }
  if (status == SolveStatus::limited) restore_best();
  return status;
}

/// Where p_n may reduce w_n, a point can have other forces while those of the rest stay. Newton's method from
/// there shows whether they belong to another solution.
bool FrictionSystem::find_another(SolveStatistics& statistics) noexcept {
  keep_answer();
  const auto differs = [this] {
    double difference = 0;
    for (int i = 0; i < rows_; ++i) difference = std::max(difference, std::abs(p_[i] - answer_.p[i]));
    return difference > distinct * std::max(largest_of(answer_.p, rows_), largest_of(p_, rows_));
  };
  for (int k = 0; k < count_; ++k) {
    const Touch& touch = touch_[k];
    const double* const own = A_.column(touch.row) + touch.row;
    if (touch.rows() == 1 || own[0] > touch.coefficient * std::hypot(own[1], own[2])) continue;
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
