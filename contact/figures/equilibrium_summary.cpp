// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/equilibrium_summary.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/figures/obstacle_check.hpp"
#include "contact/figures/stress_peaks.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

Figures EquilibriumSummary::quantities() const {
  Vector force(std::ssize(pairs)), approach(std::ssize(pairs));
  for (Eigen::Index p = 0; p < force.size(); ++p) {
    force[p] = pairs[static_cast<std::size_t>(p)].force_n;
    approach[p] = pairs[static_cast<std::size_t>(p)].approach_m;
  }
  return {{Quantity::force, {force, force.norm()}}, {Quantity::approach, {approach, approach.norm()}}};
}

EquilibriumSummary summarise(const Model& model, const Equilibrium& equilibrium,
                             std::vector<MaterialLimits> limits) {
  EquilibriumSummary out;
  out.imbalance = equilibrium.imbalance;
  out.iterations = equilibrium.iterations;
  out.candidates = static_cast<int>(model.gap.size());
  if (out.candidates > 0)
    out.max_penetration_m =
        std::max(0.0, (equilibrium.displacement.head(model.points()) - model.gap).maxCoeff());
  const std::vector<RigidMotion> rigid = RigidMotions(model).of(equilibrium.q);
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Bodies::Block& body = model.bodies[k];
    out.modes[body.name] = body.modes;
    out.basis[body.name] = body.kernel->modes.basis;
    const double angle = rigid[k].rotation.norm();
    if (auto warning = rotation_warning(body.name, angle); warning && equilibrium.active > 0)
      out.warnings.push_back(*warning);
  }
  if (!model.friction.empty()) out.ambiguous_increments = equilibrium.ambiguous;
  if (equilibrium.ambiguous > 0)
    out.warnings.push_back(base::format(
        "{} of {} increments of the loads had more than one solution (friction too large for this contact): "
        "these bodies have several equilibria, and this is one of them. Lower contact.friction",
        equilibrium.ambiguous, equilibrium.increments));
  if (has_stress(model)) {
    StressPeaks stress(model, {.contact = {.scheme = Scheme::at_rest}}, limits);
    stress.observe(equilibrium.time, equilibrium.q, equilibrium.force);
    out.stress = stress.peaks();
    out.gauges = stress.gauge_peaks();
    out.stress_envelope = stress.envelopes();
    for (std::string& warning : stress.warnings()) out.warnings.push_back(std::move(warning));
  }
  PressureCheck pressure(model, std::move(limits));
  pressure.observe(equilibrium.force, equilibrium.time);
  for (std::string& warning : pressure.warnings()) out.warnings.push_back(std::move(warning));
  ObstacleCheck obstacles(model);
  obstacles.observe(rigid, equilibrium.time);
  for (std::string& warning : obstacles.warnings()) out.warnings.push_back(std::move(warning));
  const auto moved = [&](int k) -> Vector3d {
    const Bodies::Block& body = model.bodies[k];
    Vector3d sum = body.momentum * equilibrium.q.segment(body.first_mode, body.modes);
    for (const Model::Forcing& one : model.forcing)  // supports carry their body along, which q leaves out
      if (one.support && one.body == k) sum += one.history.at(equilibrium.time) * one.lift_momentum;
    return sum / body.mass;
  };
  for (const Model::PairBlock& pair : model.pairs) {
    EquilibriumSummary::Pair figures;
    const auto force = equilibrium.force.segment(pair.first_point, pair.points).array();
    const auto area = model.area.segment(pair.first_point, pair.points).array();
    const Vector3d sum = model.normal.middleRows(pair.first_point, pair.points).transpose() * force.matrix();
    out.unpaired += pair.unpaired;
    figures.force_n = sum.norm();
    figures.contact_points = static_cast<int>((force > 0).count());
    figures.contact_area_m2 = (force > 0).select(area, 0).sum();
    if (figures.contact_points > 0) {
      figures.peak_pressure_pa = (force / area).maxCoeff();
      const Vector3d nearer = moved(pair.a) - (pair.b < 0 ? Vector3d::Zero() : moved(pair.b));
      figures.approach_m = nearer.dot(sum.normalized());
      if (auto warning = reach_warning(model, pair, figures.approach_m)) out.warnings.push_back(*warning);
    }
    if (pair.first_tangential >= 0) {
      figures.friction_n = model.friction_resultant(pair, equilibrium.force, model).norm();
      figures.sticking_points = figures.slipping_points = 0;
      for (std::size_t f = 0; f < model.friction.size(); ++f) {
        const int i = model.friction[f].point - pair.first_point;
        if (i < 0 || i >= pair.points) continue;
        *figures.sticking_points += equilibrium.states[f] == ContactState::stick;
        *figures.slipping_points += equilibrium.states[f] == ContactState::slip;
      }
    }
    out.pairs.push_back(figures);
  }
  return out;
}

}  // namespace ricochet::contact
