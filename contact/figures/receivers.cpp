// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/receivers.hpp"

namespace ricochet::contact {

Receivers::Receivers(const Model& model, const StepOptions& options)
    : model_(model),
      compliant_(options.scheme == Scheme::compliant),
      motion_(model.receivers.size()),
      acceleration_(Vector::Zero(model.omega.size())) {
  update(0, model.q0, model.initial_rates(), Vector::Zero(model.rows()));
}

void Receivers::observe(const Stepper& stepper) noexcept {
  update(stepper.time(), stepper.modal()->q, stepper.modal()->v, stepper.end_force());
}

/// q̈ = f + F h − Bᵀ λ − 2δ q̇ − ω² q; impulses have already acted.
void Receivers::update(double t, const Vector& q, const Vector& v, const Vector& force) noexcept {
  if (model_.receivers.empty()) return;
  acceleration_ = model_.load;
  acceleration_.array() -= 2 * model_.decay.array() * v.array() + model_.omega.array().square() * q.array();
  for (const Model::Forcing& one : model_.forcing)
    acceleration_.segment(one.first_mode, one.force.size()) += one.history.at(t) * one.force;
  if (compliant_)
    for (Eigen::Index i = 0; i < force.size(); ++i)
      if (force(i) != 0) acceleration_ -= force(i) * model_.B.row(i).transpose();

  for (std::size_t k = 0; k < model_.receivers.size(); ++k) {
    const Model::Receiver& receiver = model_.receivers[k];
    const Bodies::Block& body = model_.bodies[receiver.body];
    ReceiverMotion& out = motion_[k];
    out.displacement = receiver.constant;
    out.displacement.noalias() += receiver.shape * q.segment(body.first_mode, body.modes);
    out.velocity.noalias() = receiver.shape * v.segment(body.first_mode, body.modes);
    out.acceleration.noalias() = receiver.shape * acceleration_.segment(body.first_mode, body.modes);
    if (compliant_) out.displacement.noalias() += receiver.flexibility * force;
    for (std::size_t d = 0; d < model_.forcing.size(); ++d) {
      out.displacement += model_.forcing[d].history.at(t) * receiver.forcing.col(d);
      out.velocity += model_.forcing[d].history.slope(t) * receiver.forcing.col(d);
    }
  }
}

}  // namespace ricochet::contact
