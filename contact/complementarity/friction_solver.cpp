// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/friction_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

/// If ‖S‖_∞ |p|_∞ exceeds this times |r|_∞, it is checked whether any forces close the gaps.
constexpr double ill_conditioned = 1e7;

}  // namespace

FrictionSolver::FrictionSolver(int capacity, const FrictionOptions& options)
    : options_(options),
      frictionless_(capacity, {.same_matrix = options.same_matrix}),
      system_(capacity),
      normal_(std::max(capacity, 1)) {
  const auto n = static_cast<std::size_t>(std::max(capacity, 1));
  points_.resize(n);
  touching_.resize(n);
  states_.resize(n);
  slips_.resize(n);
  runs_.reserve(n);
  for (Eigen::VectorXd* x : {&root_, &work_, &forces_}) x->setZero(static_cast<Eigen::Index>(n));
}

void FrictionSolver::reset() noexcept {
  frictionless_.reset();
  choose_none();
  known_ = 0;
  point_count_ = 0;
  gathered_ = false;
  std::fill_n(states_.begin(), contact_count_, ContactState::open);
  std::fill_n(slips_.begin(), contact_count_, 0.0);
}

/// Lists the points, unless they are known, and takes over the coefficients. Returns false if a coefficient
/// or the diagonal of S is not finite.
bool FrictionSolver::know(const Symmetric& S, std::span<const FrictionContact> contacts) noexcept {
  for (const FrictionContact& contact : contacts)
    if (!(contact.coefficient < std::numeric_limits<double>::infinity())) return false;
  const bool same_points = known_ == S.rows() && contact_count_ == contacts.size();
  if (!same_points) {
    contact_count_ = contacts.size();
    reset();
    auto taken = work_.head(S.rows());
    taken.setZero();
    for (const FrictionContact& contact : contacts) {
      points_[point_count_] = {contact.normal, contact.tangential, point_count_, -1, false};
      ++point_count_;
      taken(contact.normal) = taken(contact.tangential) = taken(contact.tangential + 1) = 1;
    }
    for (int i = 0; i < S.rows(); ++i)
      if (taken(i) == 0) points_[point_count_++] = {.normal = i};
  }
  if (!same_points || !options_.same_matrix || changed_) {
    if (!std::isfinite(S.diagonal().sum())) return false;
    changed_ = false;
    // Factors of other matrices are far from it, and so are those of a problem that needed several.
    if (!options_.same_matrix || !gathered_) choose_none();
    root_.head(S.rows()) = S.diagonal().cwiseMax(0).cwiseSqrt();
    gathered_ = false;
  }
  known_ = S.rows();
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const double coefficient = std::max(contacts[k].coefficient, 0.0);
    if ((points_[k].coefficient > 0) != (coefficient > 0)) choose_none();
    points_[k].coefficient = coefficient;
  }
  return true;
}

void FrictionSolver::choose_none() noexcept {
  system_.clear();
  for (int k = 0; k < point_count_; ++k) points_[k].touches = false;
}

/// Chooses the points of the system: those with a force in the guess. Those of the last choice are kept
/// unless they are many more, because their factor is known.
void FrictionSolver::choose(const Forces& p) noexcept {
  const auto is_needed = [&](const Point& point) { return p(point.normal) > 0 || point_count_ == 1; };
  int forces = 0, missing = 0;
  for (int k = 0; k < point_count_; ++k) {
    if (!is_needed(points_[k])) continue;
    ++forces;
    missing += points_[k].touches ? 0 : 1;
  }
  if (system_.points() + missing > forces + forces / 4 + 1) {
    choose_none();
    missing = forces;
  }
  gathered_ = gathered_ && missing == 0;
  for (int k = 0; k < point_count_ && missing > 0; ++k)
    if (is_needed(points_[k]) && !points_[k].touches) add(k);
}

void FrictionSolver::add(int k) noexcept {
  points_[k].touches = true;
  touching_[system_.points()] = k;
  system_.add(points_[k].coefficient);
  gathered_ = false;
}

/// Lists the rows of the chosen points.
void FrictionSolver::list_runs() noexcept {
  runs_.clear();
  for (int k = 0; k < system_.points(); ++k)
    for (int d = 0; d < system_[k].rows(); ++d) {
      const int row = points_[touching_[k]].row(d);
      if (!runs_.empty() && runs_.back().row + runs_.back().size == row)
        ++runs_.back().size;
      else
        runs_.push_back({.row = row, .of_system = system_[k].row + d, .size = 1});
    }
}

/// Takes rows and columns of the chosen points: copies them, unless they follow one another in S.
void FrictionSolver::gather(const Symmetric& S, const Right& r) noexcept {
  for (int k = 0; k < system_.points(); ++k) {
    const Point& point = points_[touching_[k]];
    for (int d = 0; d < system_[k].rows(); ++d) system_.r()[system_[k].row + d] = r(point.row(d));
    system_[k].coefficient = point.coefficient;
  }
  if (!gathered_) list_runs();
  if (runs_.size() == 1) system_.use(&S.coeffRef(runs_[0].row, runs_[0].row), S.outerStride());
  if (gathered_) return;
  if (runs_.size() != 1) {
    auto A = system_.A();
    for (const Run& of_columns : runs_)
      for (int j = 0; j < of_columns.size; ++j) {
        const double* const column = &S.coeffRef(0, of_columns.row + j);
        double* const out = &A.coeffRef(0, of_columns.of_system + j);
        for (const Run& run : runs_) std::copy_n(column + run.row, run.size, out + run.of_system);
      }
  }
  system_.set_matrix();
  gathered_ = true;
}

/// Adds to the system all other points whose gap its forces do not keep open. S is semidefinite, so that
/// |S_i p| ≤ √S_ii √(pᵀSp), which decides most of them. Returns whether there are any. A new point begins
/// open, without force.
bool FrictionSolver::add_closing(const Symmetric& S, const Right& r) noexcept {
  const int before = system_.points(), rows = system_.rows();
  double square = 0, sum = 0;
  for (int i = 0; i < rows; ++i) {
    square += system_.p()[i] * (system_.w()[i] + system_.r()[i]);
    sum += std::abs(system_.p()[i]);
  }
  const double reach = std::sqrt(std::max(square, 0.0) + sum * system_.tolerance());
  const double tolerance = std::max(system_.normal_tolerance(), 1e-15 * largest_normal_r_);
  const auto gap_of = [&](int row) {
    const double* const column = &S.coeffRef(0, row);
    double w = -r(row);
    for (int k = 0; k < before; ++k) {
      if (system_[k].state == ContactState::open) continue;
      const Point& point = points_[touching_[k]];
      const double* const p = system_.p() + system_[k].row;
      w += column[point.normal] * p[0];
      if (system_[k].rows() == 3) w += column[point.tangential] * p[1] + column[point.tangential + 1] * p[2];
    }
    return w;
  };
  for (int k = 0; k < point_count_; ++k) {
    const Point& point = points_[k];
    if (point.touches) continue;
    if (r(point.normal) < -root_(point.normal) * reach || gap_of(point.normal) >= -tolerance) continue;
    add(k);
  }
  for (int i = rows; i < system_.rows(); ++i) system_.p()[i] = 0;
  return system_.points() > before;
}

/// Whether no forces close all gaps. A direction d ≥ 0 of normal forces with S d = 0 and rᵀd > 0 has dᵀw < 0,
/// whatever the friction. There is one if and only if the problem without friction has no solution.
bool FrictionSolver::is_unsolvable(const Symmetric& S, const Right& r) noexcept {
  auto right = work_.head(point_count_);
  auto normal = normal_.begin(point_count_);
  for (int j = 0; j < point_count_; ++j) {
    right(j) = r(points_[j].normal);
    for (int i = 0; i < point_count_; ++i) normal(i, j) = S(points_[i].normal, points_[j].normal);
  }
  frictionless_.reset();
  const bool unsolvable =
      frictionless_.solve(normal, right, forces_.head(point_count_)) == SolveStatus::no_solution;
  frictionless_.reset();
  return unsolvable;
}

SolveStatus FrictionSolver::iterate(const Symmetric& S, const Right& r, Forces p) noexcept {
  choose(p);
  gather(S, r);
  for (int k = 0; k < system_.points(); ++k) {
    const Point& point = points_[touching_[k]];
    for (int d = 0; d < system_[k].rows(); ++d) system_.p()[system_[k].row + d] = p(point.row(d));
    system_.guess_state(k, point.contact < 0 ? ContactState::open : states_[point.contact],
                        point.contact < 0 ? 0 : slips_[point.contact]);
  }
  int left = options_.max_iterations;
  SolveStatus status;
  do {
    gather(S, r);
    status = system_.solve(largest_r_, largest_normal_r_, left, statistics_);
  } while (status == SolveStatus::solved && add_closing(S, r));
  return status;
}

void FrictionSolver::answer(Forces p) noexcept {
  const double* const forces = system_.p();
  std::fill_n(states_.begin(), contact_count_, ContactState::open);
  int closed = 0;
  for (int k = 0; k < system_.points(); ++k) {
    const Point& point = points_[touching_[k]];
    const FrictionSystem::Touch& touch = system_[k];
    if (touch.state == ContactState::open || !(forces[touch.row] > 0)) continue;
    ++closed;
    p(point.normal) = forces[touch.row];
    ContactState state = touch.state;
    if (touch.rows() == 3) {
      const double most = point.coefficient * p(point.normal);
      double x = forces[touch.row + 1], y = forces[touch.row + 2];
      if (const double size = std::hypot(x, y); size > most) {
        const double scale = (1 - 4e-16) * most / size;
        x *= scale;
        y *= scale;
      }
      p(point.tangential) = x;
      p(point.tangential + 1) = y;
      if (state == ContactState::slip &&
          std::hypot(system_.w()[touch.row + 1], system_.w()[touch.row + 2]) <= system_.tolerance())
        state = ContactState::stick;
    } else if (point.contact >= 0) {
      state = ContactState::slip;
    }
    if (point.contact >= 0) {
      states_[point.contact] = state;
      slips_[point.contact] = touch.slip;
    }
  }
  statistics_.max_active = std::max(statistics_.max_active, closed);
}

bool FrictionSolver::product(const Right& p, Forces out) noexcept {
  if (system_.rows() != p.size()) return false;
  const auto each_row = [this](const auto& visit) {
    for (int k = 0; k < system_.points(); ++k)
      for (int d = 0; d < system_[k].rows(); ++d) visit(system_[k].row + d, points_[touching_[k]].row(d));
  };
  each_row([&](int of_system, int row) { work_(of_system) = p(row); });
  if (!system_.has_product(work_.data())) return false;
  each_row([&](int of_system, int row) { out(row) = system_.product()[of_system]; });
  return true;
}

/// Scales p so that pᵀ(r − S p) ≥ 0 and states the residual.
void FrictionSolver::limit(const Symmetric& S, const Right& r, Forces p) noexcept {
  auto w = work_.head(r.size());
  w.setZero();
  for (Eigen::Index j = 0; j < r.size(); ++j)
    if (p(j) != 0) w += p(j) * S.col(j);
  const double gain = p.dot(r), quadratic = p.dot(w);
  const double scale = gain > 0 ? (quadratic > gain ? gain / quadratic : 1) : 0;
  p *= scale;
  w = scale * w - r;
  double violation = 0;
  for (int k = 0; k < point_count_; ++k) violation = std::max(violation, -w(points_[k].normal));
  residual_ = {.violation = violation, .scale = system_.scale(), .work = std::abs(w.dot(p))};
}

SolveStatus FrictionSolver::solve(const Symmetric& S, const Right& r,
                                  std::span<const FrictionContact> contacts, Forces p) noexcept {
  ++statistics_.problems;
  residual_ = {};
  several_ = false;
  if (contacts.empty()) {
    contact_count_ = 0;
    const SolveStatus status = frictionless_.solve(S, r, p);
    residual_ = frictionless_.residual();
    return status;
  }
  if (!std::isfinite(r.sum()) || !know(S, contacts)) {
    contact_count_ = contacts.size();
    reset();
    p.setZero();
    return SolveStatus::not_finite;
  }
  largest_r_ = r.cwiseAbs().maxCoeff();
  largest_normal_r_ = 0;
  for (int k = 0; k < point_count_; ++k)
    largest_normal_r_ = std::max(largest_normal_r_, std::abs(r(points_[k].normal)));
  if (!std::isfinite(p.sum())) p.setZero();
  const std::int64_t pivots = statistics_.pivots, fallbacks = statistics_.fallbacks,
                     renewals = statistics_.renewals;
  SolveStatus status = iterate(S, r, p);
  p.setZero();
  if (status == SolveStatus::not_finite) {
    reset();
    return status;
  }
  if ((status == SolveStatus::limited || system_.scale() > ill_conditioned * largest_r_) &&
      is_unsolvable(S, r)) {
    reset();
    return SolveStatus::no_solution;
  }
  answer(p);
  if (status == SolveStatus::limited) {
    ++statistics_.limited;
    limit(S, r, p);
  } else {
    statistics_.warm_hits += statistics_.pivots == pivots && statistics_.fallbacks == fallbacks;
    several_ =
        system_.has_negative_determinant() || (system_.find_another(statistics_) && !add_closing(S, r));
  }
  if (statistics_.renewals > renewals + 1 || statistics_.fallbacks > fallbacks) gathered_ = false;
  return status;
}

}  // namespace ricochet::contact
