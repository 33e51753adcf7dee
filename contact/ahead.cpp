// Steps of the compliant scheme by blocks.
#include <cmath>

#include "contact/integrator.hpp"

namespace ricochet::contact {

/// Near history grows with the block and with the square of the points, far history only with the modes:
/// where there are few points longer blocks pay.
constexpr Eigen::Index few_points = 64;
constexpr int long_block = 16, short_block = 8;

void Integrator::make_block() {
  const int steps = options_.block > 0          ? options_.block
                    : gap_.size() <= few_points ? long_block
                                                : short_block;
  StepSystem system;
  system.omega = omega_;
  system.decay = decay_;
  system.stiffness = stiffness_;
  system.load = load_;
  system.b = b_;
  system.c = c_;
  system.e = e_;
  system.h = h_;
  system.B = B_;
  system.s = s_;
  system.gap = gap_;
  system.R = R_;
  system.S = S_;
  auto shared = std::make_shared<const StepSystem>(std::move(system));
  if (options_.precision == Precision::float64)
    block_.emplace<Block<double>>(std::move(shared), steps, options_.step);
  else
    block_.emplace<Block<float>>(std::move(shared), steps, options_.step);
}

/// As step_compliant, from the displacements of those points that could close.
template <class T>
StepStatus Integrator::step_ahead(Block<T>& block) noexcept {
  if (block.over()) block.start(q_, v_, force_);
  const SolveStatus solved = block.step(solver_, next_force_);
  if (!has_forces(solved)) return failure(solved);
  double power = 0;
  for (int i : block.pushing()) power -= next_force_(i) * (block.displacement(i) - block.before(i));
  power /= options_.step;
  StepStatus status = StepStatus::ok;
  if (options_.every_state) {
    free_motion(q_, v_, now_);
    status = move_under_force(0, power);
  } else {
    status = skip_state(block, static_cast<int>(block.pushing().size()), power);
  }
  if (status != StepStatus::ok) {
    block.take_back();
    return status;
  }
  residual_ = solved == SolveStatus::limited ? solver_.residual() : SolveResidual{};
  u_is_current_ = false;
  return status;
}

template StepStatus Integrator::step_ahead(Block<double>&) noexcept;
template StepStatus Integrator::step_ahead(Block<float>&) noexcept;

/// The force alone, and the state when the block is over.
template <class T>
StepStatus Integrator::skip_state(Block<T>& block, int active, double power) noexcept {
  if (block.over()) {
    block.advance(next_q_, next_v_);
    if (!std::isfinite(next_q_.squaredNorm() + next_v_.squaredNorm())) return StepStatus::not_finite;
    q_.swap(next_q_);
    v_.swap(next_v_);
    energy_is_current_ = false;
  }
  force_.swap(next_force_);
  active_ = active;
  persistency_ = power;
  ++steps_;
  return StepStatus::ok;
}

/// ½ λᵀ R λ
double Integrator::energy_in_residual(const Vector& force) const noexcept {
  double energy = 0;
  for (Eigen::Index j = 0; j < force.size(); ++j) {
    if (force(j) == 0) continue;
    for (Eigen::Index i = 0; i < force.size(); ++i)
      if (force(i) != 0) energy += 0.5 * force(j) * R_(i, j) * force(i);
  }
  return energy;
}

const Energy& Integrator::energy() const noexcept {
  if (energy_is_current_) return energy_;
  energy_.kinetic = 0.5 * v_.squaredNorm();
  energy_.strain = 0.5 * (stiffness_.array() * q_.array().square()).sum();
  energy_.loads = (load_.array() * (q_.array() - q0_.array())).sum();
  const auto residual = [&](const auto& block) {
    energy_.residual = energy_in_residual(block.over() ? force_ : block.held_force());
  };
  if (const auto* block = std::get_if<Block<double>>(&block_)) residual(*block);
  if (const auto* block = std::get_if<Block<float>>(&block_)) residual(*block);
  energy_is_current_ = true;
  return energy_;
}

const Vector& Integrator::displacement() const noexcept {
  if (!u_is_current_) {
    u_ = s_;
    u_.noalias() += B_ * q_;
    for (Eigen::Index i = 0; i < force_.size(); ++i)
      if (force_(i) != 0) u_ -= force_(i) * R_.col(i);
    u_is_current_ = true;
  }
  return u_;
}

}  // namespace ricochet::contact
