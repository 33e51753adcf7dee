// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/free_flight.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {
namespace {

/// Relative round-off of a bound with up to thousands of terms.
constexpr double round_off_of_bounds = 1e-12;

}  // namespace

FreeFlight::FreeFlight(const StepSystem& system, const StepOptions& options)
    : step_(options.step), per_sample_(options.steps_per_sample), over_(system) {
  if (per_sample_ == 1) return;
  const Model& model = *system.model;
  for (int n = 0; n < model.omega.size(); ++n)
    if (system.stiffness(n) > 0)
      elastic_.push_back(n);
    else if (system.h(n) != 0)
      rigid_.push_back(n);
  std::ranges::sort(elastic_, {}, [&](int n) { return model.omega(n); });
  reach_.setZero(system.gap.size(), bands);
  bow_ = reach_;
  const Eigen::Index m = system.gap.size();
  for (int of = 0, k = 0; of < bands; ++of) {
    last_.push_back(static_cast<int>((of + 1) * elastic_.size() / bands));
    for (; k < last_.back(); ++k) {
      const int n = elastic_[k];
      const Vector square = model.B.col(n).head(m).cwiseAbs2();
      const double rate = model.omega(n) + 2 * model.decay(n);
      reach_.col(of) += square / system.stiffness(n);
      bow_.col(of) += square * (rate * rate);
    }
  }
  const double longest = per_sample_ * step_;
  reach_ = reach_.cwiseSqrt();
  bow_ = (longest * longest / 8 * bow_.cwiseSqrt()).cwiseMin(2 * reach_);
  for (Vector* x : {&y_, &rate_}) x->setZero(model.omega.size());
  size_.setZero(bands);
  bound_.setZero(system.gap.size());
}

void FreeFlight::set_constants(const StepSystem& system, int steps) noexcept {
  if (steps == constants_of_) return;
  constants_of_ = steps;
  for (const std::vector<int>* modes : {&elastic_, &rigid_})
    for (const int n : *modes)
      over_.set_step(n, system.model->omega(n), system.model->decay(n), steps * step_);
}

/// Computes the state at the end of a jump under constant loads.
Work FreeFlight::advance(ModalState& state) const noexcept {
  const StepSystem& system = *state.system;
  const ForcedResponse::Piece& piece = state.forcing.piece();
  state.next_q = state.q;
  state.next_v = state.v;
  Work work;
  for (const std::vector<int>* modes : {&elastic_, &rigid_})
    for (const int n : *modes) {
      const double g = piece.load(n) - system.stiffness(n) * state.q(n), v = state.v(n);
      work.damping += over_.damp_ss(n) * g * g + over_.damp_sr(n) * g * v + over_.damp_rr(n) * v * v;
      state.next_q(n) += over_.b(n) * v + over_.c(n) * g;
      state.next_v(n) = over_.e(n) * v + over_.h(n) * g;
    }
  if (piece.loaded) work.forcing = piece.applied.dot(state.next_q - state.q);
  return work;
}

bool FreeFlight::stays_open(const ModalState& state, double time) noexcept {
  const StepSystem& system = *state.system;
  const ForcedResponse::Piece& piece = state.forcing.piece();
  y_ = state.q;
  rate_ = state.v;
  if (state.forcing.any()) {
    y_ -= piece.rest_q;
    rate_ -= piece.rest_v;
  }
  for (int of = 0, k = 0; of < bands; ++of) {
    double energy = 0;
    for (; k < last_[of]; ++k) {
      const int n = elastic_[k];
      const double y = y_(n) - system.load(n) / system.stiffness(n);
      energy += system.stiffness(n) * y * y + rate_(n) * rate_(n);
    }
    size_(of) = std::sqrt(energy);
  }
  const Eigen::Index m = bound_.size();
  bound_ = piece.rest.head(m) + (time * piece.drift.head(m)).cwiseMax(0);
  bound_.noalias() += reach_ * size_;
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto B = system.model->B.row(i);
    double from = 0, to = 0, bow = 0, terms = std::abs(bound_(i)) + std::abs(system.gap(i));
    for (const int n : rigid_) {
      const double load = std::abs(piece.load(n)) + std::abs(piece.slope(n)) * time,
                   decay = 2 * system.model->decay(n);
      from += B(n) * state.q(n);
      to += B(n) * state.next_q(n);
      terms += std::abs(B(n)) * (std::abs(state.q(n)) + std::abs(state.next_q(n)));
      bow += std::abs(B(n)) * (load * (1 + decay * time) + decay * std::abs(state.v(n)));
    }
    bow *= time * time / 8;
    const double room = system.gap(i) - round_off_of_bounds * terms - bow;
    if (bound_(i) + std::max(from, to) < room) continue;
    from = state.s(i) + B.dot(state.q);
    to = state.now.s(i) + B.dot(state.next_q);
    // NaN included
    if (!(std::max(from, to) + bow_.row(i).dot(size_) < room)) return false;
  }
  return true;
}

int FreeFlight::cross(ModalState& state, std::int64_t k) noexcept {
  if (per_sample_ == 1) return 0;
  const int steps = per_sample_ - static_cast<int>(k % per_sample_);
  const double from = static_cast<double>(k) * step_, to = static_cast<double>(k + steps) * step_;
  const ForcedResponse::Piece& piece = state.forcing.piece(from);
  if (piece.to <= to) return 0;
  Work work;
  if (state.forcing.any()) state.forcing.interval(from, to, state.now);
  if (piece.steady) {
    set_constants(*state.system, steps);
    work = advance(state);
  } else {
    state.next_q = state.q;
    state.next_v = state.v;
    work = state.forcing.advance(state.now, state.system->load, state.next_q, state.next_v);
  }
  if (!stays_open(state, steps * step_)) return 0;
  return state.commit(work, 0) ? steps : 0;
}

}  // namespace ricochet::contact
