// Steps of the compliant scheme by blocks.
#include <cmath>

#include "contact/stepping/integrator.hpp"

namespace ricochet::contact {

/// Near history grows with the block and with the square of the points, far history only with the modes:
/// where there are few points longer blocks pay.
constexpr Eigen::Index few_points = 64;
constexpr int long_block = 24, short_block = 8;

void Integrator::make_block() {
  const int steps = options_.block > 0                  ? options_.block
                    : system_->gap.size() <= few_points ? long_block
                                                        : short_block;
  const auto make = [&]<class T>() {
    block_.emplace<Block<T>>(std::make_shared<const BlockSystem<T>>(system_, steps, options_.step),
                             drives_.any());
  };
  if (options_.precision == Precision::float64)
    make.template operator()<double>();
  else
    make.template operator()<float>();
}

/// As step_compliant, from the displacements of those points that could close.
template <class T>
StepStatus Integrator::step_ahead(Block<T>& block) noexcept {
  if (block.over()) {
    if (drives_.any()) tell_drives(block);
    block.start(q_, v_, force_);
  }
  const SolveStatus solved = block.step(solver_, next_force_);
  if (!has_forces(solved)) return failure(solved);
  const double power = -block.work() / options_.step;
  StepStatus status = StepStatus::ok;
  u_is_current_ = false;
  if (drives_.any()) {
    drives_.step(steps_ + 1, now_);
    free_motion(q_, v_, now_);
    status = move_under_force(next_force_.dot(now_.s - s_), power);
    if (status != StepStatus::ok) block.take_back();
  } else {
    ++pending_;
    if (options_.every_state || block.over()) status = move_state(block);
    if (status == StepStatus::ok) {
      force_.swap(next_force_);
      active_ = block.pushing();
      persistency_ = power;
      ++steps_;
    }
  }
  if (status != StepStatus::ok) return status;
  residual_ = solved == SolveStatus::limited ? solver_.residual() : SolveResidual{};
  if (!options_.every_state && pending_ == 0) remember();
  return status;
}

template StepStatus Integrator::step_ahead(Block<double>&) noexcept;
template StepStatus Integrator::step_ahead(Block<float>&) noexcept;

/// What loads and supports do in the steps of a block that is to start.
template <class T>
void Integrator::tell_drives(Block<T>& block) noexcept {
  block.drive(0, now_.q, now_.v, s_);
  for (int l = 1; l <= block.length(); ++l) {
    drives_.step(steps_ + l, now_);
    block.drive(l, now_.q, now_.v, now_.s);
  }
}

/// Moves q, q̇ and the ledger through the pending steps; the last of them is not counted in steps_ yet. Where
/// that fails none of them was made.
template <class T>
StepStatus Integrator::move_state(Block<T>& block) noexcept {
  const simd::Sums sums = block.advance(keeps_rates_);
  const double residual = block.energy_in_residual();
  if (!std::isfinite(sums.kinetic + sums.strain + sums.contact + sums.damping + residual)) {
    block.take_back();
    if (pending_ > 1) {
      steps_ -= pending_ - 1;
      force_ = known_.force;
      active_ = known_.active;
      persistency_ = known_.persistency;
      residual_ = known_.residual;
    }
    pending_ = 0;
    return StepStatus::not_finite;
  }
  damping_.add(sums.damping);
  contact_.add(sums.contact - (residual - energy_.residual));
  energy_ = {.kinetic = sums.kinetic,
             .strain = sums.strain,
             .residual = residual,
             .loads = sums.loads,
             .damping = damping_.total(),
             .contact = contact_.total()};
  block.copy_state(q_, v_);
  pending_ = 0;
  return StepStatus::ok;
}

StepStatus Integrator::catch_up() noexcept {
  if (pending_ == 0) return StepStatus::ok;
  --steps_;
  const auto move = [&](auto& block) { return move_state(block); };
  StepStatus status = StepStatus::ok;
  if (auto* block = std::get_if<Block<double>>(&block_)) status = move(*block);
  if (auto* block = std::get_if<Block<float>>(&block_)) status = move(*block);
  if (status == StepStatus::ok) ++steps_;
  u_is_current_ = false;
  remember();
  return status;
}

void Integrator::keep(bool every_state, bool rates) noexcept {
  if (pending_ == 0) remember();
  options_.every_state = every_state;
  keeps_rates_ = rates;
}

void Integrator::remember() noexcept {
  known_.force = force_;
  known_.active = active_;
  known_.persistency = persistency_;
  known_.residual = residual_;
}

const double* Integrator::rate(int back) const noexcept {
  if (drives_.any()) return v_.data();
  if (const auto* block = std::get_if<Block<double>>(&block_)) return block->rate(block->advanced() - back);
  if (const auto* block = std::get_if<Block<float>>(&block_)) return block->rate(block->advanced() - back);
  return v_.data();
}

/// ½ λᵀ R λ
double Integrator::energy_in_residual(const Vector& force) const noexcept {
  double energy = 0;
  for (Eigen::Index j = 0; j < force.size(); ++j) {
    if (force(j) == 0) continue;
    for (Eigen::Index i = 0; i < force.size(); ++i)
      if (force(i) != 0) energy += 0.5 * force(j) * system_->R(i, j) * force(i);
  }
  return energy;
}

const Vector& Integrator::displacement() const noexcept {
  if (!u_is_current_) {
    const Vector& force = pending_ > 0 ? known_.force : force_;
    u_ = s_;
    u_.noalias() += system_->B * q_;
    for (Eigen::Index i = 0; i < force.size(); ++i)
      if (force(i) != 0) u_ -= force(i) * system_->R.col(i);
    u_is_current_ = true;
  }
  return u_;
}

}  // namespace ricochet::contact
