// SPDX-License-Identifier: BSD-2-Clause
#include "contact/table/table_stepper.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Round-off of the convolution: a point touches if u − g is within this share of its terms.
constexpr double touch = 1e-12;

/// Asymmetry and negative eigenvalues up to this share of the largest entry of lag 0 are round-off.
constexpr double definite = 1e-9;

/// Mean rate over the step after each sample (L − 1, m, m).
std::vector<double> difference(const std::vector<double>& x, std::size_t width, double step) {
  std::vector<double> out(x.size() - width);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = (x[k + width] - x[k]) / step;
  return out;
}

/// The samples (L, rows, m) that are convolved with the forces, and the block of lag 0, which multiplies the
/// unknown force.
struct SampledResponse {
  std::span<const double> values;  ///< those of the table, or `made`
  std::vector<double> made;
  Eigen::MatrixXd at_once;
  int rows = 0;
};

Eigen::MatrixXd first_sample(std::span<const double> response, Eigen::Index m) {
  return Eigen::Map<const Matrix>(response.data(), m, m);
}

SampledResponse response_of(const Table& table, const StepOptions& options) {
  const std::size_t m = table.points(), width = m * m;
  SampledResponse out;
  if (options.contact.scheme == Scheme::compliant) {
    out.rows = static_cast<int>(m);
    if (!table.flexibility.empty()) {
      out.values = table.flexibility;
    } else {
      const std::vector<double>& N = table.displacement;
      out.made.resize(N.size() - width);
      for (std::size_t k = 0; k < out.made.size(); ++k)
        out.made[k] = 0.5 * table.step * (N[k] + N[k + width]);
      out.values = out.made;
    }
    out.at_once = first_sample(out.values, table.points());
    return out;
  }
  if (table.displacement.empty())
    throw InputError(
        "contact.scheme = \"impulse\": the table holds no displacement and velocity. Add them, or use "
        "\"compliant\".");
  const std::vector<double> rate = options.contact.admittance == Admittance::jump
                                       ? table.velocity
                                       : difference(table.displacement, width, table.step);
  out.rows = static_cast<int>(2 * m);
  out.made.reserve(2 * rate.size());
  const auto append = [&](const std::vector<double>& from, std::size_t at) {
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(at);
    out.made.insert(out.made.end(), first, first + static_cast<std::ptrdiff_t>(width));
  };
  for (std::size_t at = 0; at < rate.size(); at += width) {
    append(table.displacement, at);
    append(rate, at);
  }
  out.values = out.made;
  out.at_once = first_sample(rate, table.points());
  return out;
}

/// Returns lag 0, made exactly symmetric and, for impulses, definite.
Eigen::MatrixXd semidefinite(const Eigen::MatrixXd& lag, bool impulse) {
  const char* what = impulse ? "the admittance" : "the flexibility of a step";
  const double largest = lag.cwiseAbs().maxCoeff();
  if ((lag - lag.transpose()).cwiseAbs().maxCoeff() > definite * largest)
    throw InputError(base::format(
        "contact.table: {} at lag 0 is not symmetric. Forces and displacements must be dual: average it with "
        "its transpose if they are.",
        what));
  Eigen::MatrixXd S = 0.5 * (lag + lag.transpose());
  const double lowest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S, Eigen::EigenvaluesOnly).eigenvalues()(0);
  if (lowest < -definite * largest || !(largest > 0))
    throw InputError(base::format(
        "contact.table: {} at lag 0 has the eigenvalue {:.3g} beside the largest entry {:.3g}: it must "
        "be positive semidefinite and not 0. Check signs, and what sample 0 means.",
        what, lowest, largest));
  return S;
}

/// Throws an InputError that names the keys of the scene if the options do not fit the table.
const StepOptions& checked(const StepOptions& options, const Table& table) {
  if (std::abs(options.step - table.step) > 1e-9 * table.step)
    throw InputError(base::format("time.rate_hz = {:.12g}: the table has a step of {:.12g} s. Set {:.12g}.",
                                  1 / options.step, table.step, 1 / table.step));
  if (options.contact.scheme == Scheme::impulse &&
      !(options.contact.restitution >= 0 && options.contact.restitution <= 1))
    throw InputError(
        base::format("contact.restitution = {}: must be between 0 and 1.", options.contact.restitution));
  return options;
}

}  // namespace

TableStepper::TableStepper(const Table& table, const StepOptions& options)
    : Stepper(checked(options, table), table.points(), {},
              options.contact.scheme == Scheme::compliant &&
                  options.contact.integration == ContactStep::conserving && !table.residual.empty()),
      free_(table.free),
      free_velocity_(table.free_velocity),
      gap_(table.gap),
      bodies_(table.bodies),
      // Also sets S_ and available_, which are declared before it and come from the same arrays.
      convolution_([&] {
        const SampledResponse response = response_of(table, options);
        S_ = semidefinite(response.at_once, options.contact.scheme == Scheme::impulse);
        if (table.tail == Tail::none)
          available_ =
              std::ssize(response.values) / (static_cast<std::int64_t>(response.rows) * table.points());
        return Convolution(response.values, response.rows, table.points(), table.tail);
      }()) {
  const Eigen::Index m = table.points();
  const bool impulse = options.contact.scheme == Scheme::impulse;
  const std::size_t width = m;
  if (impulse && !free_.empty() &&
      (options.contact.admittance == Admittance::difference || free_velocity_.empty()))
    free_velocity_ = difference(free_, width, table.step);
  if (!free_.empty()) {
    available_ = std::min(available_, std::ssize(free_) / m - 1);
    if (impulse) available_ = std::min(available_, std::ssize(free_velocity_) / m - 1);
  }

  rigid_velocity_ = rigid_acceleration_ = Vector::Zero(m);
  velocity_.resize(3, bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    rigid_velocity_ -= bodies_[b].push * bodies_[b].velocity;
    rigid_acceleration_ -= bodies_[b].push * bodies_[b].gravity;
    velocity_.col(b) = bodies_[b].velocity;
  }
  for (Vector* x : {&rhs_, &solution_, &rate_}) x->setZero(m);
  if (contact_.mean.is_conserving()) {
    R_ = Eigen::Map<const Matrix>(table.residual.data(), m, m);
    S_mean_ = conserving_mean.end * (S_ - R_) + R_;
  }
  for (Eigen::Index i = 0; i < m; ++i) law_.gap(i) = gap_(i);
  sub_.setZero(m, m);
  touching_.reserve(width);
  free_motion(0, u_);
}

/// Computes ũ_k.
void TableStepper::free_motion(std::int64_t k, Vector& u) const noexcept {
  if (free_.empty()) {
    const double t = static_cast<double>(k) * options_.step;
    u = t * rigid_velocity_ + (0.5 * t * t) * rigid_acceleration_;
  } else {
    u = Eigen::Map<const Vector>(free_.data() + k * gap_.size(), gap_.size());
  }
}

/// Computes ũ̇_k, or its mean over the next step.
void TableStepper::free_rate(std::int64_t k, Vector& v) const noexcept {
  if (free_.empty()) {
    const double later = options_.contact.admittance == Admittance::difference ? 0.5 : 0.0;
    v = rigid_velocity_ + ((static_cast<double>(k) + later) * options_.step) * rigid_acceleration_;
  } else {
    v = Eigen::Map<const Vector>(free_velocity_.data() + k * gap_.size(), gap_.size());
  }
}

StepStatus TableStepper::step() noexcept {
  const std::int64_t k = steps_ + 1;
  if (k > available_) return StepStatus::table_ended;
  free_motion(k, next_u_);
  next_force_.setZero();
  SolveStatus status = SolveStatus::solved;
  if (options_.contact.scheme == Scheme::compliant) {
    law_.free = next_u_ - convolution_.history();
    law_.start = u_;
    status = law_.solve({.R = R_, .S = S_, .S_mean = S_mean_}, contact_.mean, nullptr).status;
    next_u_ = law_.u();
    next_force_ = law_.force();
    next_end_ = law_.end();
  } else {
    status = impulses();
  }
  if (!has_forces(status)) return failure(status);
  if (!next_u_.allFinite() || !next_force_.allFinite()) return StepStatus::not_finite;

  convolution_.push(next_force_);
  const bool impulse = options_.contact.scheme == Scheme::impulse;
  const int active = static_cast<int>(((impulse ? next_force_ : next_end_).array() > 0).count());
  if (impulse) next_force_ /= options_.step;
  const double persistency = impulse ? 0 : -next_force_.dot(next_u_ - u_) / options_.step;
  complete(active, persistency, {});
  push_bodies();
  return StepStatus::ok;
}

SolveStatus TableStepper::impulses() noexcept {
  const Eigen::Index m = gap_.size();
  touching_.clear();
  for (Eigen::Index i = 0; i < m; ++i) {
    const double past = convolution_.history()(i),
                 margin = touch * (std::abs(next_u_(i)) + std::abs(past) + std::abs(gap_(i)));
    next_u_(i) -= past;
    if (!(next_u_(i) < gap_(i) - margin)) touching_.push_back(static_cast<int>(i));
  }
  if (touching_.empty()) return SolveStatus::solved;
  free_rate(steps_ + 1, rate_);
  rate_ -= convolution_.history().tail(m);
  const Eigen::Index n = touching_.size();
  for (Eigen::Index j = 0; j < n; ++j) {
    rhs_(j) = (1 + options_.contact.restitution) * rate_(touching_[j]);
    for (Eigen::Index i = 0; i < n; ++i) sub_(i, j) = S_(touching_[i], touching_[j]);
  }
  const SolveStatus status = law_.solver().solve(sub_.topLeftCorner(n, n), rhs_.head(n), solution_.head(n));
  for (Eigen::Index j = 0; j < n; ++j) next_force_(touching_[j]) = solution_(j);
  return status;
}

/// Updates the velocity of each body as a whole by Newton's law.
void TableStepper::push_bodies() noexcept {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto v = velocity_.col(b);
    v += options_.step * bodies_[b].gravity;
    v.noalias() += (options_.step / bodies_[b].mass) * (bodies_[b].push.transpose() * contact_.force);
  }
}

}  // namespace ricochet::contact
