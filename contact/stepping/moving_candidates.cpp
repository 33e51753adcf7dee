// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/moving_candidates.hpp"

#include <cmath>

namespace ricochet::contact {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

MovingCandidates::MovingCandidates(const Bodies::Block& block, const Model& model, const StepSystem& system)
    : surface_(&block.kernel->surface),
      modes_(block.modes),
      elastic_(block.modes - block.frame_modes()),
      first_elastic_(block.first_mode + block.frame_modes()),
      c_(system.c.segment(first_elastic_, elastic_)),
      folded_(Vector::Zero(elastic_)),
      in_modes_(static_cast<Index>(surface_->size())),
      residual_(static_cast<Index>(surface_->size())) {
  const std::size_t M = surface_->size();
  const auto omega = model.omega.segment(first_elastic_, elastic_).transpose().array();
  for (const int n : model.folded.modes)
    if (const Index own = n - first_elastic_; own >= 0 && own < elastic_) {
      folded_(own) = 1 / (model.omega(n) * model.omega(n));
      folds_ = true;
    }
  for (int i = 0; i < static_cast<int>(M); ++i) {
    double give = (shape(i).colwise().squaredNorm().array() / omega.square()).sum();
    if (yields()) give += flexibility(i, i).trace();
    give_.push_back(std::sqrt(give));
    largest_give_ = std::max(largest_give_, give_.back());
  }
  if (const std::vector<double>& settling = block.kernel->loads.body_force_residual;
      block.supported && !settling.empty())
    for (std::size_t i = 0; i < M; ++i)
      settled_.push_back(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&settling[9 * i]) *
                         (block.rotation.transpose() * model.gravity));
  for (Lazy* known : {&displacement_, &change_}) {
    known->value.assign(M, Vector3d::Zero());
    known->call.assign(M, -1);
  }
  number_of_.assign(M, -1);
  joined_.reserve(M);
}

const Vector3d& MovingCandidates::of(Lazy& known, int candidate, const Vector& modal, bool settles) noexcept {
  const auto i = static_cast<std::size_t>(candidate);
  if (known.call[i] == calls_) return known.value[i];
  known.call[i] = calls_;
  known.value[i].noalias() = shape(candidate) * modal.segment(first_elastic_, elastic_);
  if (settles && !settled_.empty()) known.value[i] += settled_[i];
  return known.value[i];
}

const Vector3d& MovingCandidates::displacement(int candidate, const Vector& q) noexcept {
  return of(displacement_, candidate, q, true);
}

const Vector3d& MovingCandidates::change(int candidate, const Vector& dq) noexcept {
  return of(change_, candidate, dq, false);
}

void MovingCandidates::join(int candidate) noexcept {
  if (number_of_[static_cast<std::size_t>(candidate)] >= 0) return;
  const auto s = static_cast<Index>(joined_.size());
  number_of_[static_cast<std::size_t>(candidate)] = static_cast<int>(s);
  joined_.push_back(candidate);
  for (CandidateBlocks* blocks : {&in_modes_, &residual_}) blocks->resize(s + 1);
  const auto own = shape(candidate);
  // Φ d Φᵀ, entry by entry: a product of matrices would allocate.
  const auto block = [&](const auto& diagonal, const auto& other) {
    Matrix3d out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(i, j) = own.row(i).cwiseProduct(diagonal.transpose()).dot(other.row(j));
    return out;
  };
  for (Index t = 0; t <= s; ++t) {
    const int other = joined_[static_cast<std::size_t>(t)];
    in_modes_(s, t) = block(c_, shape(other));
    if (yields())
      residual_(s, t) = flexibility(candidate, other);
    else
      residual_(s, t).setZero();
    if (folds_) residual_(s, t) += block(folded_, shape(other));
  }
}

/// Blocks move towards the front, in their order, so that none is overwritten before it has moved.
void MovingCandidates::keep(const std::vector<char>& marks) noexcept {
  const auto stays = [&](int candidate) { return marks[static_cast<std::size_t>(candidate)] != 0; };
  if (std::all_of(joined_.begin(), joined_.end(), stays)) return;
  Index kept = 0;
  for (std::size_t s = 0; s < joined_.size(); ++s) {
    if (!stays(joined_[s])) continue;
    Index column = 0;
    for (std::size_t t = 0; t <= s; ++t) {
      if (!stays(joined_[t])) continue;
      for (CandidateBlocks* blocks : {&in_modes_, &residual_})
        (*blocks)(kept, column) = Matrix3d((*blocks)(static_cast<Index>(s), static_cast<Index>(t)));
      ++column;
    }
    ++kept;
  }
  std::erase_if(joined_, [&](int candidate) {
    if (!stays(candidate)) number_of_[static_cast<std::size_t>(candidate)] = -1;
    return !stays(candidate);
  });
  for (std::size_t s = 0; s < joined_.size(); ++s)
    number_of_[static_cast<std::size_t>(joined_[s])] = static_cast<int>(s);
}

void MovingCandidates::add_blocks(int i, int j, double weight, Matrix3d& in_modes,
                                  Matrix3d& residual) const noexcept {
  const Index x = number_of_[static_cast<std::size_t>(i)], y = number_of_[static_cast<std::size_t>(j)];
  in_modes_.add(x, y, weight, in_modes);
  residual_.add(x, y, weight, residual);
}

void MovingCandidates::push(int candidate, const Vector3d& force, Vector& modal) const noexcept {
  modal.segment(first_elastic_, elastic_).noalias() += shape(candidate).transpose() * force;
}

}  // namespace ricochet::contact
