// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/slip.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {

Slip::Slip(Eigen::Index points, Eigen::Index rows, double step) : step_(step) {
  belt_.setZero(points > 0 ? rows : 0);
  for (Vector* x : {&speed_, &heat_, &next_speed_, &next_heat_}) x->setZero(points);
  state_.assign(static_cast<std::size_t>(points), ContactState::open);
  next_state_ = state_;
}

void Slip::begin(std::span<const Model::Belt> belts, std::int64_t k) noexcept {
  if (belts.empty()) return;
  const double from = static_cast<double>(k - 1) * step_, to = static_cast<double>(k) * step_;
  belt_.setZero();
  for (const Model::Belt& belt : belts) belt_ += (belt.history.at(to) - belt.history.at(from)) * belt.slide;
}

double Slip::coefficient(const Friction& law, Eigen::Index f, bool closed, double free_slip) const noexcept {
  if (law.static_coefficient == law.dynamic_coefficient) return law.static_coefficient;
  const double ratio = (closed ? speed_(f) : free_slip / step_) / law.stribeck_velocity;
  return law.dynamic_coefficient +
         (law.static_coefficient - law.dynamic_coefficient) * std::exp(-ratio * ratio);
}

void Slip::begin_trial() noexcept {
  next_speed_.setZero();
  next_heat_.setZero();
  std::fill(next_state_.begin(), next_state_.end(), ContactState::open);
}

double Slip::record(Eigen::Index f, ContactState state, const double* mean, const double* slip) noexcept {
  const double heat = mean[0] * slip[0] + mean[1] * slip[1];
  next_state_[f] = state;
  next_speed_(f) = next_heat_(f) = 0;
  if (state == ContactState::stick) return heat;
  if (state == ContactState::slip) next_speed_(f) = std::hypot(slip[0], slip[1]) / step_;
  if (mean[0] == 0 && mean[1] == 0) return 0;
  next_heat_(f) = heat_(f) + heat;
  return heat;
}

void Slip::accept() noexcept {
  speed_.swap(next_speed_);
  heat_.swap(next_heat_);
  state_.swap(next_state_);
}

void Slip::clear() noexcept {
  speed_.setZero();
  heat_.setZero();
  std::fill(state_.begin(), state_.end(), ContactState::open);
}

}  // namespace ricochet::contact
