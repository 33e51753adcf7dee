// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/slip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::contact {

Slip::Slip(Eigen::Index points, Eigen::Index rows, double step) : step_(step) {
  belt_.setZero(points > 0 ? rows : 0);
  for (Vector* x : {&speed_, &heat_, &next_speed_, &next_heat_}) x->setZero(points);
  state_.assign(static_cast<std::size_t>(points), ContactState::open);
  next_state_ = state_;
  is_next_listed_.assign(state_.size(), false);
  for (List* x : {&list_, &next_list_}) x->point.resize(state_.size());
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

/// Of all points, few are recorded, so that only these are undone.
void Slip::begin_trial() noexcept {
  for (std::size_t k = 0; k < next_list_.count; ++k) {
    const int f = next_list_.point[k];
    next_speed_(f) = next_heat_(f) = 0;
    next_state_[f] = ContactState::open;
    is_next_listed_[f] = false;
  }
  next_list_.count = 0;
}

double Slip::record(Eigen::Index f, ContactState state, const double* mean, const double* slip) noexcept {
  const double heat = mean[0] * slip[0] + mean[1] * slip[1];
  if (!is_next_listed_[f]) {
    is_next_listed_[f] = true;
    next_list_.point[next_list_.count++] = static_cast<int>(f);
  }
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
  for (const auto& [list, is_listed] : {std::pair(&next_list_, false), {&list_, true}})
    for (std::size_t k = 0; k < list->count; ++k) is_next_listed_[list->point[k]] = is_listed;
  std::swap(list_, next_list_);
}

void Slip::let_sleep(Eigen::Index f) noexcept {
  for (List* list : {&list_, &next_list_}) {
    const auto end = list->point.begin() + static_cast<std::ptrdiff_t>(list->count);
    list->count = static_cast<std::size_t>(std::remove(list->point.begin(), end, static_cast<int>(f)) -
                                           list->point.begin());
  }
  is_next_listed_[f] = false;
  next_state_[f] = state_[f];
  for (Vector* x : {&speed_, &heat_, &next_speed_, &next_heat_}) (*x)(f) = 0;
}

void Slip::wake(Eigen::Index f) noexcept {
  for (List* list : {&list_, &next_list_}) list->point[list->count++] = static_cast<int>(f);
  is_next_listed_[f] = true;
}

void Slip::forget(Eigen::Index f) noexcept {
  speed_(f) = heat_(f) = 0;
  state_[static_cast<std::size_t>(f)] = ContactState::open;
}

void Slip::take(const Slip& earlier, const Correspondence& from) {
  carry(earlier.speed_, speed_, from.friction);
  carry(earlier.heat_, heat_, from.friction);
  const std::vector<int> now = Correspondence::places(from.friction, earlier.speed_.size());
  for (std::size_t k = 0; k < earlier.list_.count; ++k) {
    const int then = earlier.list_.point[k], f = now[static_cast<std::size_t>(then)];
    if (f < 0) continue;
    state_[static_cast<std::size_t>(f)] = earlier.state_[static_cast<std::size_t>(then)];
    list_.point[list_.count++] = f;
    is_next_listed_[static_cast<std::size_t>(f)] = false;
  }
}

void Slip::clear() noexcept {
  for (std::size_t k = 0; k < list_.count; ++k) {
    const int f = list_.point[k];
    speed_(f) = heat_(f) = 0;
    state_[f] = ContactState::open;
  }
  list_.count = 0;
}

}  // namespace ricochet::contact
