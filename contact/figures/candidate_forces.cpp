// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/candidate_forces.hpp"

namespace ricochet::contact {

/// The forces p on the relative displacements u = P u_C + … push the candidates of the body by −Pᵀ p.
void candidate_forces(const Model& model, int body, const Vector& p, Vector& out) noexcept {
  const Selection& P = model.static_selection[static_cast<std::size_t>(body)];
  out.setZero(P.cols());
  for (Eigen::Index i = 0; i < p.size(); ++i)
    if (p(i) != 0)
      for (Selection::InnerIterator entry(P, i); entry; ++entry) out(entry.col()) -= p(i) * entry.value();
}

void set_folded(const Model& model, int body, const Turning& turning, double t, Vector& q) noexcept {
  const Bodies::Block& block = model.bodies[static_cast<std::size_t>(body)];
  const Vector& force = turning.candidate_force[static_cast<std::size_t>(body)];
  const Eigen::Quaterniond& attitude = turning.poses[static_cast<std::size_t>(body)].attitude;
  const Eigen::Map<const Matrix> shape(block.kernel->surface.shape.data(), force.size(), block.modes);
  for (std::size_t j = 0; j < model.folded.modes.size(); ++j) {
    const int n = model.folded.modes[j], own = n - block.first_mode;
    if (own < 0 || own >= block.modes) continue;
    double sum = shape.col(own).dot(force) + model.folded.load(static_cast<Eigen::Index>(j));
    for (const Model::Forcing& one : model.forcing)
      if (one.body == body && !one.support)
        sum += one.history.at(t) * one.participation(block).col(own).dot(one.along(attitude));
    q(n) = sum / (model.omega(n) * model.omega(n));
  }
}

}  // namespace ricochet::contact
