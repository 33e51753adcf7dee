// SPDX-License-Identifier: BSD-2-Clause
#include "contact/model/model.hpp"

#include "base/format.hpp"
#include "contact/model/forcing.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// q0_n = f_n/ω_n²
Vector static_coordinates(const Model& model) {
  Vector force = model.load;
  for (const Model::Forcing& one : model.forcing)
    if (!one.support && one.history.dead())
      force.segment(one.first_mode, one.force.size()) += one.history.at(0) * one.force;
  return (model.omega.array() > 0).select(force.array() / model.omega.array().square(), 0.0);
}

}  // namespace

std::vector<PatchSpring> Model::springs() const {
  std::vector<PatchSpring> out;
  const Vector flexibility = patch_flexibility();
  for (Eigen::Index i = 0; i < bulge.size(); ++i) {
    if (!(bulge(i) > 0) || !(flexibility(i) > 0)) continue;
    out.resize(static_cast<std::size_t>(points()));
    out[static_cast<std::size_t>(i)] = PatchSpring::of(bulge(i), flexibility(i));
  }
  return out;
}

Model build_model(const Placement& placement, const Vector3d& gravity,
                  const std::vector<ForcingRequest>& forcing) {
  for (const ForcingRequest& request : forcing)
    if (index_of(request.body, placement.bodies) < 0)
      throw InputError(base::format("loads: \"{}\" is not a body. Name one of bodies.*.", request.body));
  Model model;
  static_cast<Bodies&>(model) = build_bodies(placement.bodies, gravity);
  static_cast<Rows&>(model) = build_rows(placement, model);
  for (std::size_t k = 0; k < model.bodies.size(); ++k) add_forcing(model, static_cast<int>(k), forcing);
  refuse_overlap(model);
  model.q0 += static_coordinates(model);
  for (std::size_t k = 0; k < model.bodies.size(); ++k) add_receivers(model, static_cast<int>(k));
  return model;
}

}  // namespace ricochet::contact
