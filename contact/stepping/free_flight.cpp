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
  const auto N = static_cast<int>(system.omega.size());
  for (int n = 0; n < N; ++n)
    if (system.stiffness(n) > 0)
      elastic_.push_back(n);
    else if (system.h(n) != 0)
      rigid_.push_back(n);
  std::ranges::sort(elastic_, {}, [&](int n) { return system.omega(n); });
  reach_.setZero(system.gap.size(), bands);
  bow_ = reach_;
  const Eigen::Index m = system.gap.size();
  rest_ = system.s.head(m);
  for (int of = 0, k = 0; of < bands; ++of) {
    last_.push_back(static_cast<int>((of + 1) * elastic_.size() / bands));
    for (; k < last_.back(); ++k) {
      const int n = elastic_[k];
      const Vector square = system.B.col(n).head(m).cwiseAbs2();
      const double rate = system.omega(n) + 2 * system.decay(n);
      reach_.col(of) += square / system.stiffness(n);
      bow_.col(of) += square * (rate * rate);
      rest_ += system.B.col(n).head(m) * (system.load(n) / system.stiffness(n));
    }
  }
  const double longest = per_sample_ * step_;
  reach_ = reach_.cwiseSqrt();
  bow_ = (longest * longest / 8 * bow_.cwiseSqrt()).cwiseMin(2 * reach_);
  size_.setZero(bands);
  bound_.setZero(system.gap.size());
}

void FreeFlight::set_constants(const StepSystem& system, int steps) noexcept {
  if (steps == constants_of_) return;
  constants_of_ = steps;
  for (const std::vector<int>* modes : {&elastic_, &rigid_})
    for (const int n : *modes) over_.set_step(n, system.omega(n), system.decay(n), steps * step_);
}

/// Computes the state at the end of the jump. Returns the work of damping.
double FreeFlight::advance(ModalState& state) const noexcept {
  const StepSystem& system = *state.system;
  state.next_q = state.q;
  state.next_v = state.v;
  double damping = 0;
  for (const std::vector<int>* modes : {&elastic_, &rigid_})
    for (const int n : *modes) {
      const double g = system.load(n) - system.stiffness(n) * state.q(n), v = state.v(n);
      damping += over_.damp_ss(n) * g * g + over_.damp_sr(n) * g * v + over_.damp_rr(n) * v * v;
      state.next_q(n) += over_.b(n) * v + over_.c(n) * g;
      state.next_v(n) = over_.e(n) * v + over_.h(n) * g;
    }
  return damping;
}

bool FreeFlight::stays_open(const ModalState& state, double time) noexcept {
  const StepSystem& system = *state.system;
  for (int of = 0, k = 0; of < bands; ++of) {
    double energy = 0;
    for (; k < last_[of]; ++k) {
      const int n = elastic_[k];
      const double y = state.q(n) - system.load(n) / system.stiffness(n);
      energy += system.stiffness(n) * y * y + state.v(n) * state.v(n);
    }
    size_(of) = std::sqrt(energy);
  }
  bound_ = rest_;
  bound_.noalias() += reach_ * size_;
  for (Eigen::Index i = 0; i < bound_.size(); ++i) {
    const auto B = system.B.row(i);
    double from = 0, to = 0, bow = 0, terms = std::abs(bound_(i)) + std::abs(system.gap(i));
    for (const int n : rigid_) {
      from += B(n) * state.q(n);
      to += B(n) * state.next_q(n);
      terms += std::abs(B(n)) * (std::abs(state.q(n)) + std::abs(state.next_q(n)));
      bow += std::abs(B(n)) * (std::abs(system.load(n)) * (1 + 2 * system.decay(n) * time) +
                               2 * system.decay(n) * std::abs(state.v(n)));
    }
    bow *= time * time / 8;
    const double room = system.gap(i) - round_off_of_bounds * terms - bow;
    if (bound_(i) + std::max(from, to) < room) continue;
    from = B.dot(state.q);
    to = B.dot(state.next_q);
    // NaN included
    if (!(system.s(i) + std::max(from, to) + bow_.row(i).dot(size_) < room)) return false;
  }
  return true;
}

int FreeFlight::cross(ModalState& state, std::int64_t k) noexcept {
  if (per_sample_ == 1 || state.forcing.any()) return 0;
  const int steps = per_sample_ - static_cast<int>(k % per_sample_);
  set_constants(*state.system, steps);
  const double damping = advance(state);
  if (!stays_open(state, steps * step_)) return 0;
  return state.commit({.damping = damping}, 0) ? steps : 0;
}

}  // namespace ricochet::contact
