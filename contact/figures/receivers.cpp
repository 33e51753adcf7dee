// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/receivers.hpp"

#include <algorithm>

#include "contact/figures/candidate_forces.hpp"
#include "contact/model/forcing.hpp"
#include "contact/motion/floating_body.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

Receivers::Receivers(const Model& model, const StepOptions& options)
    : model_(model),
      compliant_(options.contact.scheme == Scheme::compliant),
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
  coriolis_ = coriolis_of(model);
  update(0, *turning, model.q0, model.initial_rates());
}

void Receivers::observe(const Stepper& stepper) noexcept {
  const ModalState& state = *stepper.modal();
  if (stepper.turning())
    update(stepper.time(), *stepper.turning(), state.q, state.v);
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
    turn(k, Eigen::Quaterniond(body.rotation));
  }
}

/// Turns the motion of a receiver, which is in world axes, to its axes.
void Receivers::turn(std::size_t receiver, const Eigen::Quaterniond& attitude) noexcept {
  if (model_.receivers[receiver].axes == Axes::world) return;
  ReceiverMotion& out = motion_[receiver];
  for (Vector3d* x : {&out.displacement, &out.velocity, &out.acceleration}) *x = attitude.conjugate() * *x;
}

/// The same for bodies that turn. A point is at x = c + A (X + w) with its elastic displacement w in body
/// axes, so that ẍ = c̈ + α × r + Ω × (Ω × r) + 2 Ω × Aẇ + Aẅ, with r = A (X + w). With the turn a of nearly
/// equal modes (coriolis.hpp), q̇ = v + a q and q̈ = v̇ + a q̇ + ȧ q.
void Receivers::update(double t, const Turning& turning, const Vector& q, const Vector& v) noexcept {
  q_ = q;
  for (int number = 0; number < static_cast<int>(turning.poses.size()); ++number) {
    const auto is_own = [&](const Model::Receiver& receiver) { return receiver.body == number; };
    if (std::ranges::none_of(model_.receivers, is_own)) continue;
    const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
    const Pose& pose = turning.poses[static_cast<std::size_t>(number)];
    set_folded(model_, number, turning, t, q_);
    // All in the axes of the body from here on
    const auto [total, torque] = accelerate(number, t, turning, q, v);
    const Vector3d spin = pose.attitude.conjugate() * pose.spin;
    const Eigen::Matrix3d inertia = body.own_inertia();
    Vector3d spin_up = Vector3d::Zero();
    if (!body.supported) spin_up = inertia.inverse() * (torque - spin.cross(inertia * spin));
    const Coriolis& turns = coriolis_[static_cast<std::size_t>(number)];
    turns.add_turn(spin, spin.norm(), false, v, acceleration_);
    turns.add_turn(spin, spin.norm(), true, turning.rates, acceleration_);
    turns.add_turn(spin_up, spin.norm(), true, q, acceleration_);
    for (std::size_t k = 0; k < model_.receivers.size(); ++k) {
      if (!is_own(model_.receivers[k])) continue;
      const ReceiverMotion within =
          elastic(k, t, pose, turning.candidate_force[static_cast<std::size_t>(number)], turning.rates);
      const Vector3d arm = Eigen::Map<const Vector3d>(own_[k]->point.data()) - body.own_centre() +
                           within.displacement,
                     relative = spin_up.cross(arm) + spin.cross(spin.cross(arm)) +
                                2 * spin.cross(within.velocity) + within.acceleration;
      motion_[k] = {.displacement = pose.at(arm) - model_.receivers[k].point,
                    .velocity = pose.velocity_at(arm, within.velocity),
                    .acceleration = pose.attitude * relative};
      if (!body.supported) motion_[k].acceleration += model_.gravity + pose.attitude * total / body.mass;
      turn(k, pose.attitude);
    }
  }
}

/// The elastic motion of a receiver in the axes of its body that turns, with static displacements. Its q_ and
/// acceleration_ must be known. @param force  (3M) on the candidates
ReceiverMotion Receivers::elastic(std::size_t receiver, double t, const Pose& pose, const Vector& force,
                                  const Vector& v) const noexcept {
  const kernels::Receiver& own = *own_[receiver];
  const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(model_.receivers[receiver].body)];
  const Eigen::Index first = body.first_mode + body.frame_modes(), elastic = body.modes - body.frame_modes();
  const Eigen::Map<const Matrix> all(own.shape.data(), 3, body.modes);
  const auto shape = all.rightCols(elastic);
  ReceiverMotion out{.displacement = shape * q_.segment(first, elastic),
                     .velocity = shape * v.segment(first, elastic),
                     .acceleration = shape * acceleration_.segment(first, elastic)};
  if (!own.residual_flexibility.empty())
    out.displacement += Eigen::Map<const Matrix>(own.residual_flexibility.data(), 3, force.size()) * force;
  if (body.supported) out.displacement += body.rotation.transpose() * model_.receivers[receiver].constant;
  const Vector3d spin = pose.attitude.conjugate() * pose.spin;
  for (const Model::Forcing& one : model_.forcing) {
    if (one.body != model_.receivers[receiver].body) continue;
    const std::vector<double>& residual = one.support ? own.motion_residual : own.load_residual;
    const Vector3d along = one.along(pose.attitude), lift = all * one.lift;
    const double value = one.history.at(t), slope = one.history.slope(t);
    out.displacement += value * (response(residual, one, along) + lift);
    out.velocity += slope * (response(residual, one, along) + lift);
    for (const int n : model_.folded.modes)  // q_ has their displacement
      if (const Eigen::Index of = n - body.first_mode; !one.support && of >= 0 && of < body.modes)
        out.velocity += slope * one.participation(body).col(of).dot(along) /
                        (model_.omega(n) * model_.omega(n)) * all.col(of);
    if (!one.follows) out.velocity -= value * response(residual, one, spin.cross(along));
  }
  return out;
}

/// Computes q̈ of the elastic modes of a body that turns under loads and the forces on its candidates. Returns
/// the sum of all forces but its weight, and their moment about the centre, body axes.
std::pair<Vector3d, Vector3d> Receivers::accelerate(int number, double t, const Turning& turning,
                                                    const Vector& q, const Vector& v) noexcept {
  const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
  const Vector& force = turning.candidate_force[static_cast<std::size_t>(number)];
  const Eigen::Quaterniond& attitude = turning.poses[static_cast<std::size_t>(number)].attitude;
  const Turning::Wrench& pushed = turning.pushed[static_cast<std::size_t>(number)];
  const kernels::Surface& surface = body.kernel->surface;
  const Eigen::Index first = body.first_mode + body.frame_modes(), elastic = body.modes - body.frame_modes();
  auto modal = acceleration_.segment(first, elastic);
  modal = model_.load.segment(first, elastic).array() -
          2 * model_.decay.segment(first, elastic).array() * v.segment(first, elastic).array() -
          model_.omega.segment(first, elastic).array().square() * q.segment(first, elastic).array();
  Vector3d total = attitude.conjugate() * pushed.force, torque = attitude.conjugate() * pushed.torque;
  for (const Model::Forcing& one : model_.forcing) {
    if (one.body != number || one.support) continue;
    const Vector3d acting = one.history.at(t) * one.along(attitude);
    total += one.own_total * acting;
    torque += one.own_moment * acting;
    modal.noalias() += one.participation(body).rightCols(elastic).transpose() * acting;
  }
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
