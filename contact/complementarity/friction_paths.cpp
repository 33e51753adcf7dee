// SPDX-License-Identifier: BSD-2-Clause
// Newton's method along paths: of the load, from the last solution; and of a ridge, from none.
#include <algorithm>
#include <cmath>

#include "contact/complementarity/friction_system.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Map;

constexpr double first_factor = 0.1, fastest = 0.01, slowest = 0.95;  // from one ridge to the next
constexpr double first_share = 0.25;                                  // of the load
constexpr int most_shares = 16;
constexpr double enough = 1e-3;  // residual within a path, relative to the load moved

}  // namespace

/// The value that the state of its point admits and that is nearest to w_i of row i, the d-th of point k.
double FrictionSystem::admitted(int k, int d) const noexcept {
  const Touch& touch = touch_[k];
  const double w = w_[touch.row + d];
  if (touch.state == ContactState::stick) return 0;
  if (touch.state == ContactState::slip) return d == 0 ? 0 : touch.slip * touch.direction(d - 1);
  return d == 0 ? std::max(w, 0.0) : w;
}

/// Moves r in shares from a value for which the answer kept is a solution to the given one. Fewer states
/// change with each share than at once.
SolveStatus FrictionSystem::follow_load(int& left, SolveStatistics& statistics) noexcept {
  std::copy_n(r_.begin(), rows_, plain_.r.begin());
  SolveStatus status = SolveStatus::limited;
  double part = first_share;
  for (int shares = 0; shares < most_shares && left > 0; ++shares) {
    restore_answer();
    std::copy_n(plain_.r.begin(), rows_, r_.begin());
    evaluate();
    double rest = 0;
    for (int k = 0; k < count_; ++k)
      for (int d = 0; d < touch_[k].rows(); ++d) {
        const int i = touch_[k].row + d;
        const double change = w_[i] - admitted(k, d);
        r_[i] += (1 - part) * change;
        rest = std::max(rest, std::abs(change));
      }
    status = try_newton(left, statistics, part < 1 ? enough * part * rest : 0);
    if (status == SolveStatus::not_finite || (status == SolveStatus::solved && part == 1)) break;
    if (status == SolveStatus::solved) {
      keep_answer();
      part = std::min(1.0, 2 * part);
    } else {
      part /= 4;
    }
    status = SolveStatus::limited;
  }
  std::copy_n(plain_.r.begin(), rows_, r_.begin());
  return status;
}

/// Replaces A by A + ρ and r by r + ρ c.
void FrictionSystem::set_ridge(double ridge) noexcept {
  for (int i = 0; i < rows_; ++i) {
    A_.own.column(i)[i] = plain_.A[i] + ridge;
    r_[i] = plain_.r[i] + ridge * plain_.centre[i];
  }
  product_.rows = 0;
  sizes_.norm += ridge - plain_.ridge;
  plain_.ridge = ridge;
  discard_factor();
}

/// Solves the problem with a ridge ρ (p − c) added to w, and lets ρ decrease to 0. With a large ρ, points
/// hardly influence each other and the solution is unique. It changes continuously with ρ up to a turning
/// point, so that few points change their state if ρ decreases little enough. At a turning point, the last
/// solution becomes the centre c of a new path.
SolveStatus FrictionSystem::follow_paths(int& left, SolveStatistics& statistics) noexcept {
  if (A_.others != nullptr) {
    const Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> of_others(
        A_.others, rows_, rows_, Eigen::OuterStride<>(A_.stride_of_others));
    A() = of_others;
  }
  for (int i = 0; i < rows_; ++i) plain_.A[i] = entry(i);
  std::copy_n(r_.begin(), rows_, plain_.r.begin());
  std::fill_n(plain_.centre.begin(), rows_, 0.0);
  std::fill_n(p_.begin(), rows_, 0.0);
  for (int k = 0; k < count_; ++k) touch_[k].state = ContactState::open;
  SolveStatus status = SolveStatus::limited;
  double ridge = sizes_.norm, factor = first_factor, solved_at = 0;
  while (left > 0 && status != SolveStatus::not_finite) {
    set_ridge(ridge);
    status = try_newton(left, statistics);
    if (status == SolveStatus::solved) {
      if (ridge == 0) break;
      keep_answer();
      solved_at = ridge;
      factor = std::max(fastest, factor * std::sqrt(factor));
    } else {
      if (solved_at == 0) break;
      restore_answer();
      factor = std::sqrt(factor);
      if (factor > slowest) {
        std::copy_n(answer_.p.begin(), rows_, plain_.centre.begin());
        ridge = std::max(10 * solved_at, sizes_.diagonal);
        solved_at = 0;
        factor = first_factor;
        continue;
      }
    }
    ridge = solved_at * factor > 1e-11 * sizes_.diagonal ? solved_at * factor : 0;
  }
  if (status == SolveStatus::solved && plain_.ridge > 0) status = SolveStatus::limited;
  set_ridge(0);
  return status;
}

}  // namespace ricochet::contact
