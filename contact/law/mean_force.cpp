// SPDX-License-Identifier: BSD-2-Clause
#include "contact/law/mean_force.hpp"

#include <algorithm>

namespace ricochet::contact {

MeanForce::MeanForce(Eigen::Index rows, bool conserving)
    : pair_of_row_(static_cast<std::size_t>(rows), 0),
      segments_{{0, 0, rows}},
      pairs_(1),
      conserving_(conserving) {
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
  segments_.clear();
  for (std::size_t i = 0; i < pair_of_row_.size(); ++i)
    if (segments_.empty() || segments_.back().pair != pair_of_row_[i])
      segments_.push_back({pair_of_row_[i], static_cast<Eigen::Index>(i), 1});
    else
      ++segments_.back().size;
}

void MeanForce::advance(const Vector& force, const std::vector<Pair>& pairs) noexcept {
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  before_.swap(end_);
  end_ = force;
  for (Pair& pair : pairs_) pair.carries = false;
  for (const auto& [number, first, size] : segments_) {
    Pair& pair = pairs_[number];
    const auto end = end_.segment(first, size);
    auto before = before_.segment(first, size);
    if (pair.restarts) before = end;
    pair.carries = pair.carries || (end.cwiseMax(before).array() > 0).any();
  }
  end_touches();
}

void MeanForce::advance(std::span<const int> rows, const Vector& force,
                        const std::vector<Pair>& pairs) noexcept {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (pairs_[k].asleep) continue;
    pairs_[k] = pairs[k];
    pairs_[k].carries = false;
  }
  for (const int row : rows) {
    Pair& pair = pairs_[pair_of_row_[row]];
    before_(row) = pair.restarts ? force(row) : end_(row);
    end_(row) = force(row);
    pair.carries = pair.carries || std::max(end_(row), before_(row)) > 0;
  }
  end_touches();
}

/// Finds out whether anything carries, and ends the touches of pairs that do not.
void MeanForce::end_touches() noexcept {
  carries_ = false;
  for (Pair& pair : pairs_) {
    carries_ = carries_ || (pair.carries && !pair.asleep);
    if (pair.carries) continue;
    pair.reserve += pair.bank;
    pair.bank = 0;
  }
}

void MeanForce::restore(std::span<const int> rows, const Vector& end,
                        const std::vector<Pair>& pairs) noexcept {
  std::copy(pairs.begin(), pairs.end(), pairs_.begin());
  for (std::size_t j = 0; j < rows.size(); ++j) end_(rows[j]) = end(static_cast<Eigen::Index>(j));
}

double MeanForce::draw(int pair, double energy) noexcept {
  Pair& of = pairs_[static_cast<std::size_t>(pair)];
  for (double* account : {&of.reserve, &of.bank}) {
    const double drawn = std::min(energy, *account);
    *account -= drawn;
    energy -= drawn;
  }
  return energy;
}

void MeanForce::reduce(int pair, double share) noexcept {
  for (const auto& [number, first, size] : segments_)
    if (number == pair) end_.segment(first, size) *= share;
}

void MeanForce::let_sleep(int pair, bool asleep) noexcept {
  pairs_[static_cast<std::size_t>(pair)].asleep = asleep;
  end_touches();
}

void MeanForce::forget(int pair) noexcept {
  for (const auto& [number, first, size] : segments_) {
    if (number != pair) continue;
    end_.segment(first, size).setZero();
    before_.segment(first, size).setZero();
  }
  pairs_[static_cast<std::size_t>(pair)] = {};
  end_touches();
}

void MeanForce::take(const MeanForce& earlier, const Correspondence& from) {
  carry(earlier.end_, end_, from.rows);
  carry(earlier.before_, before_, from.rows);
  for (std::size_t p = 0; p < from.pair.size(); ++p)
    if (from.pair[p] >= 0) pairs_[p] = earlier.pairs_[static_cast<std::size_t>(from.pair[p])];
  end_touches();
}

void MeanForce::clear() noexcept {
  end_.setZero();
  before_.setZero();
  for (Pair& pair : pairs_) pair = {};
  carries_ = false;
}

}  // namespace ricochet::contact
