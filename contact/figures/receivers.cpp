// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/receivers.hpp"

#include <algorithm>

#include "contact/figures/candidate_forces.hpp"
#include "contact/motion/floating_body.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

Receivers::Receivers(const Model& model, const StepOptions& options)
    : model_(model),
      compliant_(options.scheme == Scheme::compliant),
      motion_(model.receivers.size()),
      acceleration_(Vector::Zero(model.omega.size())) {
  const std::optional<Turning> turning = initial_turning(model, options);
  if (!turning) {
    update(0, model.q0, model.initial_rates(), Vector::Zero(model.rows()));
    return;
  }
  for (const Model::Receiver& receiver : model.receivers)
    own_.push_back(
        &*std::ranges::find(model.bodies[static_cast<std::size_t>(receiver.body)].kernel->receivers,
                            receiver.name, &kernels::Receiver::name));
  update(*turning, model.q0, model.initial_rates());
}

void Receivers::observe(const Stepper& stepper) noexcept {
  const ModalState& state = *stepper.modal();
  if (stepper.turning())
    update(*stepper.turning(), state.q, state.v);
  else
    update(stepper.time(), state.q, state.v, stepper.end_force());
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

/// The same for bodies that turn. A point is at x = c + A (X + w) with its elastic displacement w in body
/// axes, so that ẍ = c̈ + α × r + Ω × (Ω × r) + 2 Ω × Aẇ + Aẅ, with r = A (X + w).
void Receivers::update(const Turning& turning, const Vector& q, const Vector& v) noexcept {
  q_ = q;
  for (int number = 0; number < static_cast<int>(turning.poses.size()); ++number) {
    const auto is_own = [&](const Model::Receiver& receiver) { return receiver.body == number; };
    if (std::ranges::none_of(model_.receivers, is_own)) continue;
    const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
    const Pose& pose = turning.poses[static_cast<std::size_t>(number)];
    const Vector& force = turning.candidate_force[static_cast<std::size_t>(number)];
    const Eigen::Index first = body.first_mode + body.frame_modes(),
                       elastic = body.modes - body.frame_modes();
    set_folded(model_, number, force, q_);
    // All in the axes of the body from here on
    const auto [total, torque] = accelerate(body, q, v, force);
    const Vector3d spin = pose.attitude.conjugate() * pose.spin;
    const Eigen::Matrix3d inertia = body.own_inertia();
    Vector3d turn = Vector3d::Zero();
    if (!body.supported) turn = inertia.inverse() * (torque - spin.cross(inertia * spin));
    for (std::size_t k = 0; k < model_.receivers.size(); ++k) {
      if (!is_own(model_.receivers[k])) continue;
      const kernels::Receiver& own = *own_[k];
      const Eigen::Map<const Matrix> all(own.shape.data(), 3, body.modes);
      const auto shape = all.rightCols(elastic);
      Vector3d w = shape * q_.segment(first, elastic);
      if (!own.residual_flexibility.empty())
        w += Eigen::Map<const Matrix>(own.residual_flexibility.data(), 3, force.size()) * force;
      if (body.supported) w += body.rotation.transpose() * model_.receivers[k].constant;
      const Vector3d rate = shape * v.segment(first, elastic),
                     arm = Eigen::Map<const Vector3d>(own.point.data()) - body.own_centre() + w,
                     relative = turn.cross(arm) + spin.cross(spin.cross(arm)) + 2 * spin.cross(rate) +
                                shape * acceleration_.segment(first, elastic);
      motion_[k] = {.displacement = pose.at(arm) - model_.receivers[k].point,
                    .velocity = pose.velocity_at(arm, rate),
                    .acceleration = pose.attitude * relative};
      if (!body.supported) motion_[k].acceleration += model_.gravity + pose.attitude * total / body.mass;
    }
  }
}

/// Computes q̈ of the elastic modes of a body that turns under the forces on its candidates. Returns their
/// sum and their moment about the centre, body axes.
std::pair<Vector3d, Vector3d> Receivers::accelerate(const Bodies::Block& body, const Vector& q,
                                                    const Vector& v, const Vector& force) noexcept {
  const kernels::Surface& surface = body.kernel->surface;
  const Eigen::Index first = body.first_mode + body.frame_modes(), elastic = body.modes - body.frame_modes();
  auto modal = acceleration_.segment(first, elastic);
  modal = model_.load.segment(first, elastic).array() -
          2 * model_.decay.segment(first, elastic).array() * v.segment(first, elastic).array() -
          model_.omega.segment(first, elastic).array().square() * q.segment(first, elastic).array();
  Vector3d total = Vector3d::Zero(), torque = total;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Vector3d f = force.segment<3>(static_cast<Eigen::Index>(3 * i));
    if (f.isZero(0)) continue;
    total += f;
    torque += (Eigen::Map<const Vector3d>(&surface.places()[3 * i]) - body.own_centre()).cross(f);
    const Eigen::Map<const Matrix> at(&surface.shape[3 * i * static_cast<std::size_t>(body.modes)], 3,
                                      body.modes);
    modal.noalias() += at.rightCols(elastic).transpose() * f;
  }
  for (const int n : model_.folded.modes)
    if (n >= first && n < first + elastic) acceleration_(n) = 0;
  return {total, torque};
}

}  // namespace ricochet::contact
