// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/modal_state.hpp"

#include <algorithm>
#include <utility>

namespace ricochet::contact {

ModalState::ModalState(std::shared_ptr<const Model> shared, const StepOptions& options)
    : system(make_step_system(std::move(shared), options)),
      forcing(model(), options.step),
      q(model().q0),
      v(model().v0),
      ledger({.kinetic = 0.5 * v.squaredNorm(), .strain = 0.5 * system->stiffness.dot(q.cwiseAbs2())}),
      now(forcing.start()) {
  s = now.s;
  v -= now.lift;
  for (Vector* x : {&next_q, &next_v, &g_, &dq_, &push_, &work_q_, &work_v_}) x->setZero(q.size());
  moved_.setZero(s.size());
  Eigen::Index most = 0;
  for (const Selection& selection : model().static_selection) most = std::max(most, selection.cols());
  on_candidates_.setZero(model().turns ? 0 : most);
}

void ModalState::begin(std::int64_t k) noexcept {
  if (forcing.any()) forcing.step(k, now);
  next_q = q + free_motion(q, v, now);
}

/// q⁺ − q is b q̇ + c g plus the response to the forcing. Computing this increment instead of q⁺ avoids
/// cancellation in the work of a force on a slow motion.
Vector& ModalState::free_motion(const Vector& from_q, const Vector& from_v,
                                const ForcedResponse::Interval& over) noexcept {
  const Vector& load = over.forced ? system->load : forcing.piece().load;
  g_.array() = load.array() - system->stiffness.array() * from_q.array();
  dq_.array() = system->b.array() * from_v.array() + system->c.array() * g_.array();
  if (over.forced) dq_ += over.q;
  return dq_;
}

/// Sets push_ = Bᵀ p and returns the number of rows with a force.
int ModalState::push(const Vector& force) noexcept {
  int active = 0;
  push_.setZero();
  for (Eigen::Index i = 0; i < force.size(); ++i)
    if (force(i) != 0) {
      push_ += force(i) * model().B.row(i).transpose();
      ++active;
    }
  return active;
}

/// Work of the step that starts at (q, v) under the acceleration g_ and the forcing.
Work ModalState::work() noexcept {
  if (now.forced) {
    work_q_ = q;
    work_v_ = v;
    push_.array() = g_.array() + system->stiffness.array() * q.array();
    return forcing.advance(now, push_, work_q_, work_v_);
  }
  Work out;
  if (system->damped)
    out.damping =
        (system->damp_ss.array() * g_.array().square() + system->damp_sr.array() * g_.array() * v.array() +
         system->damp_rr.array() * v.array().square())
            .sum();
  if (forcing.piece().loaded) out.forcing = forcing.piece().applied.dot(next_q - q);
  return out;
}

Work ModalState::free_step() noexcept {
  next_v.array() = system->e.array() * v.array() + system->h.array() * g_.array();
  if (now.forced) next_v += now.v;
  return work();
}

bool ModalState::step_under(const Vector& mean, double residual, const Work* at_points) noexcept {
  const double against_s = mean.dot(now.s - s);
  double contact = against_s;
  if (push(mean) > 0) {
    dq_.array() -= system->c.array() * push_.array();
    g_ -= push_;
    contact += push_.dot(dq_);
    next_q = q + dq_;
  }
  Work spent = free_step();
  spent.forcing += against_s;
  spent.contact = contact;
  if (at_points != nullptr) {
    spent.contact = at_points->contact;
    spent.friction = at_points->friction;
    spent.belts = at_points->belts;
  }
  return commit(spent, residual);
}

int ModalState::strike(const Vector& impulse, Work& work) noexcept {
  const int active = push(impulse);
  if (active == 0) return 0;
  const double on_rate = impulse.dot(now.rate);
  work.contact += push_.dot(next_v) + on_rate - 0.5 * push_.squaredNorm();  // Pᵀ (u̇⁻ + u̇⁺)/2
  work.forcing += on_rate - push_.dot(now.lift);
  next_v -= push_;
  return active;
}

bool ModalState::commit(const Work& work, double residual) noexcept {
  const Energy end{.kinetic = 0.5 * (now.forced ? (next_v + now.lift).squaredNorm() : next_v.squaredNorm()),
                   .strain = 0.5 * (system->stiffness.array() * next_q.array().square()).sum(),
                   .residual = residual,
                   .loads = (system->load.array() * (next_q.array() - system->q0.array())).sum()};
  if (!ledger.close(end, work)) return false;
  q.swap(next_q);
  v.swap(next_v);
  s = now.s;
  return true;
}

void ModalState::displacement(const Vector& force, Vector& u) const noexcept {
  u = s;
  u.noalias() += model().B * q;
  for (Eigen::Index i = 0; i < force.size(); ++i)
    if (force(i) != 0) u -= force(i) * model().R.row(i).transpose();
  yield(system->springs, force, u);
}

/// Folded modes follow at once, by f/ω².
PushStatus ModalState::push_at(int number, const BodyPlace& place, const Eigen::Vector3d& force) noexcept {
  const PushStatus status = pushes_.set(model(), number, place, force);
  if (status != PushStatus::changed) return status;
  push_.setZero();
  moved_.setZero();
  for (const PointForces::Force& one : pushes_.all()) {
    const Bodies::Block& body = model().bodies[static_cast<std::size_t>(one.body)];
    const Eigen::Vector3d own = body.rotation.transpose() * one.world;
    push_modes(body, one.place, own, push_.segment(body.first_mode, body.modes));
    push_rows(model(), one.body, one.place, own, on_candidates_, moved_);
  }
  const Model::Folded& folded = model().folded;
  for (std::size_t j = 0; j < folded.modes.size(); ++j) {
    const int n = folded.modes[j];
    const double soft = push_(n) / (model().omega(n) * model().omega(n));
    moved_ += soft * folded.B.col(static_cast<Eigen::Index>(j));
    push_(n) = 0;
  }
  forcing.push(model(), push_, moved_);
  return status;
}

}  // namespace ricochet::contact
