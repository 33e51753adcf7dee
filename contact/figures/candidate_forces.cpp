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

void set_folded(const Model& model, int body, const Vector& force, Vector& q) noexcept {
  const Bodies::Block& block = model.bodies[static_cast<std::size_t>(body)];
  const Eigen::Map<const Matrix> shape(block.kernel->surface.shape.data(), force.size(), block.modes);
  for (const int n : model.folded.modes)
    if (n >= block.first_mode && n < block.first_mode + block.modes)
      q(n) = shape.col(n - block.first_mode).dot(force) / (model.omega(n) * model.omega(n));
}

}  // namespace ricochet::contact
