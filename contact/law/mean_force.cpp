// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/mean_force.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {

MeanForce::MeanForce(Eigen::Index points, bool conserving)
    : conserving_(conserving), end_(Vector::Zero(points)), before_(Vector::Zero(points)) {}

bool MeanForce::is_shock(const Trial& trial) noexcept {
  const double a = conserving_mean.end;  // λ̄ = a λ⁺ where contact begins
  return a * a * trial.in_residual < shock_share * trial.in_modes;
}

MeanWeights MeanForce::reduced(const Trial& opening) const noexcept {
  const double square = opening.in_modes, stored = 0.5 * now_.in_residual;
  const double linear = opening.removed + square - stored;
  const double x = (linear + std::sqrt(linear * linear + 4 * square * (now_.bank + stored))) / (2 * square);
  // Just below the root, so that round-off does not overdraw the bank.
  const double share = std::clamp(x * (1 - 1e-9), 0.0, 1.0);
  return {conserving_mean.end, share * conserving_mean.start, share * conserving_mean.before};
}

void MeanForce::advance(const Vector& force) noexcept {
  now_ = next_;
  before_.swap(end_);
  end_ = force;
  if (now_.restarts) before_ = force;
  carries_ = (end_.array() > 0).any() || (before_.array() > 0).any();
}

}  // namespace ricochet::contact
