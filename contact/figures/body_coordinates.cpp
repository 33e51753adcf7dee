// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/body_coordinates.hpp"

#include "contact/figures/candidate_forces.hpp"
#include "contact/model/folding.hpp"

namespace ricochet::contact {

AllCoordinates::AllCoordinates(const Model& model) : model_(model), whole_(Vector::Zero(model.omega.size())) {
  for (const Bodies::Block& body : model.bodies) {
    const kernels::Kernel& kernel = *body.kernel;
    const std::size_t rows =
        kernel.surface.has_flexibility()
            ? kernel.surface.size() * static_cast<std::size_t>(kernel.surface.residual_components())
            : 0;
    bodies_.push_back({.modal = Vector::Zero(body.modes),
                       .force = Vector::Zero(rows),
                       .load = Vector::Zero(3 * kernel.applied.size()),
                       .motion = Vector::Zero(3 * kernel.motions.size()),
                       .gravity = body.rotation.transpose() * model.gravity});
  }
}

void AllCoordinates::set(double time, const Vector& q, const Vector& p, const Turning* turning) noexcept {
  whole_ = q;
  if (!turning) set_folded(model_, time, p, whole_);
  for (int k = 0; turning && k < static_cast<int>(bodies_.size()); ++k)
    set_folded(model_, k, *turning, time, whole_);
  for (const Model::Forcing& one : model_.forcing)
    whole_.segment(one.first_mode, one.lift.size()) += one.history.at(time) * one.lift;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Block& body = model_.bodies[k];
    BodyCoordinates& out = bodies_[k];
    out.modal = whole_.segment(body.first_mode, body.modes);
    if (out.force.size() > 0) {
      if (turning)
        out.force = turning->candidate_force[k];
      else
        candidate_forces(model_, static_cast<int>(k), p, out.force);
    }
    out.load.setZero();
    out.motion.setZero();
    for (const Model::Forcing& one : model_.forcing)
      if (one.body == static_cast<int>(k))
        (one.support ? out.motion : out.load).segment<3>(3 * one.entry) +=
            one.history.at(time) * (turning ? one.along(turning->poses[k].attitude) : one.own);
  }
}

}  // namespace ricochet::contact
