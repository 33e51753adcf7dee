#include "contact/stepping/integrator.hpp"

#include <cmath>

namespace ricochet::contact {
namespace {

/// u_i is a sum of N products: its round-off is a small multiple of ε |B_i| |q|. Touching is tested with this
/// margin.
constexpr double touch = 1e-13;

}  // namespace

void Integrator::Sum::add(double x) noexcept {
  const double sum = value + x;
  carry += std::abs(value) >= std::abs(x) ? (value - sum) + x : (x - sum) + value;
  value = sum;
}

Integrator::Integrator(const Model& model, const StepOptions& options)
    : options_(options),
      system_(make_step_system(model, options)),
      solver_(static_cast<int>(model.gap.size()),
              {.same_matrix = options.scheme == Scheme::compliant, .max_pivots = options.max_pivots}),
      drives_(model, options.step, options.scheme == Scheme::compliant),
      q_(system_->q0),
      v_(model.v0) {
  const Eigen::Index N = model.omega.size(), m = model.gap.size();
  if (options.scheme == Scheme::compliant)
    for (Eigen::Index n = 0; n < N; ++n)
      if (!sampled(model.omega(n), options.step)) v_(n) = 0;
  for (Vector* x : {&g_, &dq_, &push_, &next_q_, &next_v_, &work_q_, &work_v_}) x->setZero(N);
  for (Vector* x : {&force_, &next_u_, &next_force_, &rhs_, &solution_}) x->setZero(m);
  touching_.reserve(static_cast<std::size_t>(m));
  now_ = ahead_ = drives_.start();
  s_ = now_.s;
  energy_.kinetic = 0.5 * v_.squaredNorm();
  v_ -= now_.lift;
  if (options.scheme == Scheme::impulse && m > 0) {
    sub_.setZero(m, m);
    for (Vector* x : {&at_q_, &at_v_, &force_at_, &slope_at_}) x->setZero(N);
    for (Vector* x : {&rate_, &bound_, &impulse_}) x->setZero(m);
    open_.reserve(static_cast<std::size_t>(m));
  }
  u_ = s_;
  u_.noalias() += system_->B * q_;
  energy_.strain = 0.5 * system_->stiffness.dot(q_.cwiseAbs2());
  known_.force = force_;
  if (options.scheme == Scheme::compliant && options.block != 1 && m > 0) make_block();
}

bool Integrator::has_forces(SolveStatus status) noexcept {
  return status == SolveStatus::solved || status == SolveStatus::limited;
}

StepStatus Integrator::failure(SolveStatus status) noexcept {
  return status == SolveStatus::not_finite ? StepStatus::not_finite : StepStatus::no_solution;
}

StepStatus Integrator::step() noexcept {
  if (options_.scheme == Scheme::compliant) return step_compliant();
  return options_.instant == Instant::exact ? step_exact() : step_impulse();
}

/// From (q, q̇) without contact: g = f − ω²q and q⁺ − q = b q̇ + c g, and what the drives add. With a = 1 − ω²c
/// and d = −ω²h these increments are the propagator, and they keep the work of a force on a slow motion free
/// of cancellation.
void Integrator::free_motion(const Vector& q, const Vector& v, const Drives::Stretch& over) noexcept {
  g_.array() = system_->load.array() - system_->stiffness.array() * q.array();
  dq_.array() = system_->b.array() * v.array() + system_->c.array() * g_.array();
  if (drives_.any()) dq_ += over.q;
}

/// Of u_i, a sum over modes of the length `size`: the margin for touching.
double Integrator::round_off(Eigen::Index i, double size) const noexcept {
  return touch * (size * system_->norm(i) + std::abs(system_->gap(i)) + std::abs(now_.s(i)));
}

/// push_ = Bᵀ λ; returns how many points push.
int Integrator::push_by(const Vector& lambda) noexcept {
  int active = 0;
  push_.setZero();
  for (Eigen::Index i = 0; i < lambda.size(); ++i)
    if (lambda(i) > 0) {
      push_ += lambda(i) * system_->B.row(i).transpose();
      ++active;
    }
  return active;
}

/// ∫ 2δ q̇² over the step that starts at (q_, v_) under the acceleration g_.
double Integrator::damping_work() const noexcept {
  if (!system_->damped) return 0;
  return (system_->damp_ss.array() * g_.array().square() +
          system_->damp_sr.array() * g_.array() * v_.array() + system_->damp_rr.array() * v_.array().square())
      .sum();
}

/// Of the step that starts at (q_, v_) under the acceleration g_, drives apart.
Drives::Work Integrator::drive_work() noexcept {
  if (!drives_.any()) return {damping_work(), 0};
  work_q_ = q_;
  work_v_ = v_;
  push_.array() = g_.array() + system_->stiffness.array() * q_.array();
  return drives_.advance(now_, push_, work_q_, work_v_);
}

/// Takes next_… as the state, unless it is not finite.
StepStatus Integrator::commit(double contact_work, double residual, double power, int active,
                              const Drives::Work& work) noexcept {
  const double kinetic = 0.5 * (drives_.any() ? (next_v_ + now_.lift).squaredNorm() : next_v_.squaredNorm());
  const double strain = 0.5 * (system_->stiffness.array() * next_q_.array().square()).sum();
  if (!std::isfinite(kinetic + strain + contact_work + residual + work.damping + work.drives))
    return StepStatus::not_finite;
  damping_.add(work.damping);
  driven_.add(work.drives);
  contact_.add(contact_work - (residual - energy_.residual));
  energy_.kinetic = kinetic;
  energy_.strain = strain;
  energy_.residual = residual;
  energy_.loads = (system_->load.array() * (next_q_.array() - system_->q0.array())).sum() + driven_.total();
  energy_.damping = damping_.total();
  energy_.contact = contact_.total();
  q_.swap(next_q_);
  v_.swap(next_v_);
  u_.swap(next_u_);
  force_.swap(next_force_);
  s_ = now_.s;
  active_ = active;
  persistency_ = power;
  ++steps_;
  return StepStatus::ok;
}

/// 0 ≤ λ ⟂ S λ − (û − g) ≥ 0,  û = B q̂ + s with q̂ the motion without contact,  S = B c Bᵀ + R;
/// g̃ for g once a step was cut short
StepStatus Integrator::step_compliant() noexcept {
  if (auto* block = std::get_if<Block<double>>(&block_)) return step_ahead(*block);
  if (auto* block = std::get_if<Block<float>>(&block_)) return step_ahead(*block);
  if (drives_.any()) drives_.step(steps_ + 1, now_);
  free_motion(q_, v_, now_);
  next_q_ = q_ + dq_;
  next_u_ = now_.s;
  next_u_.noalias() += system_->B * next_q_;
  rhs_ = next_u_ - system_->gap;
  if (solver_.statistics().limited > 0) rhs_ -= (u_ - system_->gap).cwiseMax(0);
  next_force_.setZero();
  SolveResidual residue;
  if (!(rhs_.array() < 0).all()) {  // NaN included
    const SolveStatus status = solver_.solve(system_->S, rhs_, next_force_);
    if (!has_forces(status)) return failure(status);
    residue = solver_.residual();
  }
  for (Eigen::Index i = 0; i < next_force_.size(); ++i) {
    const double lambda = next_force_(i);
    if (lambda != 0) next_u_ -= lambda * system_->S.col(i);  // B q⁺ + s − R λ
  }
  const double power = -next_force_.dot(next_u_ - u_) / options_.step;
  const double against_s = next_force_.dot(now_.s - s_);
  const StepStatus done = move_under_force(against_s, power);
  if (done == StepStatus::ok) residual_ = residue;
  return done;
}

/// From q⁺ − q and g of the motion without contact to the state under next_force_, and the ledger.
StepStatus Integrator::move_under_force(double against_s, double power) noexcept {
  const int active = push_by(next_force_);
  double work = against_s;
  if (active > 0) {
    dq_.array() -= system_->c.array() * push_.array();
    g_ -= push_;
    work += push_.dot(dq_);
  }
  next_q_ = q_ + dq_;
  next_v_.array() = system_->e.array() * v_.array() + system_->h.array() * g_.array();
  if (drives_.any()) next_v_ += now_.v;
  Drives::Work spent = drive_work();
  spent.drives += against_s;
  return commit(work, energy_in_residual(next_force_), power, active, spent);
}

/// Free motion to t_k, then q̇⁺ = q̇⁻ − Bᵀ P.
StepStatus Integrator::step_impulse() noexcept {
  if (drives_.any()) drives_.step(steps_ + 1, now_);
  free_motion(q_, v_, now_);
  Drives::Work spent = drive_work();
  next_q_ = q_ + dq_;
  next_v_.array() = system_->e.array() * v_.array() + system_->h.array() * g_.array();
  if (drives_.any()) next_v_ += now_.v;
  next_u_ = now_.s;
  next_u_.noalias() += system_->B * next_q_;
  const SolveStatus status = impulses(now_);
  if (!has_forces(status)) return failure(status);

  const int active = push_by(next_force_);
  double work = 0;
  if (active > 0) {
    work = strike(spent);
    next_force_ /= options_.step;
  }
  const StepStatus done = commit(work, 0, -work / options_.step, active, spent);
  if (done == StepStatus::ok) residual_ = touching_.empty() ? SolveResidual{} : solver_.residual();
  return done;
}

/// q̇⁺ = q̇⁻ − push_ under the impulses next_force_; returns what they take from the bodies.
double Integrator::strike(Drives::Work& spent) noexcept {
  const double on_rate = next_force_.dot(now_.rate);
  const double work = push_.dot(next_v_) + on_rate - 0.5 * push_.squaredNorm();  // Pᵀ (u̇⁻ + u̇⁺)/2
  spent.drives += on_rate - push_.dot(now_.lift);
  next_v_ -= push_;
  return work;
}

/// next_force_ = P [N s]:  0 ≤ P ⟂ A P − (1 + e) v̂ ≥ 0  on the points with u ≥ g at the end of `until`.
SolveStatus Integrator::impulses(const Drives::Stretch& until) noexcept {
  next_force_.setZero();
  touching_.clear();
  const double size = next_q_.norm();
  for (Eigen::Index i = 0; i < system_->gap.size(); ++i)
    if (!(next_u_(i) < system_->gap(i) - round_off(i, size))) touching_.push_back(static_cast<int>(i));
  if (touching_.empty()) return SolveStatus::solved;

  // v̂ = B x + ṡ: the velocity at t_k, or what becomes of it over the next step
  const Vector* x = &next_v_;
  const Vector* s = &until.rate;
  if (options_.admittance == Admittance::difference) {
    ahead_.s = until.s;
    if (drives_.any()) drives_.stretch(until.to, until.to + options_.step, ahead_);
    free_motion(next_q_, next_v_, ahead_);
    dq_ /= options_.step;
    ahead_.s = (ahead_.s - until.s) / options_.step;
    x = &dq_;
    s = &ahead_.s;
  }
  const Eigen::Index n = static_cast<Eigen::Index>(touching_.size());
  for (Eigen::Index j = 0; j < n; ++j) {
    const int i = touching_[j];
    rhs_(j) = (1 + options_.restitution) * (system_->B.row(i).dot(*x) + (*s)(i));
    for (Eigen::Index l = 0; l < n; ++l) sub_(l, j) = system_->S(touching_[l], i);
  }
  const SolveStatus status = solver_.solve(sub_.topLeftCorner(n, n), rhs_.head(n), solution_.head(n));
  for (Eigen::Index j = 0; j < n; ++j) next_force_(touching_[j]) = solution_(j);
  return status;
}

}  // namespace ricochet::contact
