// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/mean_force.hpp"

#include <algorithm>

namespace ricochet::contact {

MeanForce::MeanForce(Eigen::Index rows, bool conserving)
    : pair_of_row_(static_cast<std::size_t>(rows), 0), pairs_(1), conserving_(conserving) {
  for (Vector* x : {&end_, &before_}) x->setZero(rows);
}

MeanForce::MeanForce(const Model& model, bool conserving) : MeanForce(model.rows(), conserving) {
  pairs_.resize(std::max<std::size_t>(model.pairs.size(), 1));
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    std::fill_n(pair_of_row_.begin() + model.pairs[p].first_point, model.pairs[p].points,
                static_cast<int>(p));
  for (const Model::FrictionPoint& point : model.friction)
    std::fill_n(pair_of_row_.begin() + point.tangential, 2,
                pair_of_row_[static_cast<std::size_t>(point.point)]);
}

void MeanForce::advance(const Vector& force, const std::vector<Pair>& pairs) noexcept {
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  before_.swap(end_);
  end_ = force;
  for (Pair& pair : pairs_) pair.carries = false;
  for (Eigen::Index i = 0; i < end_.size(); ++i) {
    Pair& pair = pairs_[pair_of_row_[i]];
    if (pair.restarts) before_(i) = end_(i);
    pair.carries = pair.carries || end_(i) > 0 || before_(i) > 0;
  }
  carries_ = std::any_of(pairs_.begin(), pairs_.end(), [](const Pair& pair) { return pair.carries; });
}

void MeanForce::clear() noexcept {
  end_.setZero();
  before_.setZero();
  for (Pair& pair : pairs_) pair = {.bank = pair.bank};
  carries_ = false;
}

}  // namespace ricochet::contact
