// SPDX-License-Identifier: BSD-2-Clause
#include "contact/api/sample_forces.hpp"

#include <algorithm>
#include <utility>

namespace ricochet {

SampleForces::SampleForces(const contact::Model& model, const contact::Stepper& stepper,
                           const contact::FloatingStepper* floating)
    : model_(model),
      stepper_(stepper),
      floating_(floating),
      means_{.normal = stepper.force().head(stepper.points()),
             .along = stepper.force().tail(stepper.force().size() - stepper.points())},
      tangential_(contact::Matrix::Zero(stepper.points(), 3)),
      is_listed_(floating != nullptr ? static_cast<std::size_t>(stepper.force().size()) : 0) {
  listed_.reserve(is_listed_.size());
}

void SampleForces::add() noexcept {
  if (means_.begins_sample) clear();
  const contact::Vector& now = stepper_.force();
  const int steps = stepper_.options().steps_per_sample;
  if (floating_ == nullptr) {
    means_.normal += now.head(means_.normal.size()) / steps;
    means_.along += now.tail(means_.along.size()) / steps;
  } else {
    for (const std::span<const int> rows : floating_->forced())
      for (const int row : rows) {
        if (!std::exchange(is_listed_[static_cast<std::size_t>(row)], true)) listed_.push_back(row);
        of_row(row) += now(row) / steps;
      }
  }
  means_.begins_sample = stepper_.at_sample();
  if (means_.begins_sample) turn_to_world();
}

void SampleForces::set(const Means& means) noexcept {
  means_ = means;
  tangential_.setZero();
  list();
  turn_to_world();
}

void SampleForces::take(const SampleForces& earlier,
                        std::span<const contact::Correspondence::Run> rows) noexcept {
  const Means& was = earlier.means_;
  for (auto [from, to, size] : rows)
    for (Eigen::Index i = from; i < from + size; ++i)
      of_row(to + i - from) = i < was.normal.size() ? was.normal(i) : was.along(i - was.normal.size());
  list();
  turn_to_world();
}

void SampleForces::silence(const contact::Model::PairBlock& pair) noexcept {
  means_.normal.segment(pair.first_point, pair.points).setZero();
  tangential_.middleRows(pair.first_point, pair.points).setZero();
  if (pair.first_tangential >= 0)
    means_.along.segment(pair.first_tangential - normal().size(), 2 * pair.points).setZero();
}

double SampleForces::total() const noexcept {
  if (floating_ == nullptr) return normal().sum();
  double sum = 0;
  for_each_point([&](Eigen::Index i) { sum += normal()(i); });
  return sum;
}

void SampleForces::clear() noexcept {
  if (floating_ == nullptr) {
    means_.normal.setZero();
    means_.along.setZero();
    return;
  }
  for (const int row : listed_) {
    is_listed_[static_cast<std::size_t>(row)] = false;
    of_row(row) = 0;
    if (row < normal().size()) tangential_.row(row).setZero();
  }
  listed_.clear();
}

void SampleForces::list() noexcept {
  listed_.clear();
  for (std::size_t row = 0; row < is_listed_.size(); ++row) {
    is_listed_[row] = of_row(static_cast<Eigen::Index>(row)) != 0;
    if (is_listed_[row]) listed_.push_back(static_cast<int>(row));
  }
}

void SampleForces::turn_to_world() noexcept {
  const Eigen::Index m = normal().size();
  const contact::Matrix& tangent = contact::frames_of(model_, stepper_).tangent;
  const auto turn = [&](const contact::Model::FrictionPoint& point) {
    const Eigen::Index first = point.tangential - m;
    tangential_.row(point.point).noalias() =
        means_.along.segment<2>(first).transpose() * tangent.middleRows<2>(first);
  };
  if (floating_ == nullptr)
    std::ranges::for_each(model_.friction, turn);
  else
    for (const int row : listed_)
      if (row >= m) turn(model_.friction[static_cast<std::size_t>((row - m) / 2)]);
}

}  // namespace ricochet
