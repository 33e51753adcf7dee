// SPDX-License-Identifier: BSD-2-Clause
// Whether contact forces can hold bodies that could move rigidly.
#pragma once

#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// The modes with ω = 0.
struct RigidModes {
  std::vector<Eigen::Index> mode;  ///< (r)
  Eigen::MatrixXd B;               ///< (n,r) B_r

  explicit RigidModes(const Model& model);
};

/// Throws InputError unless forces p with B_rᵀ p = f exist: λ ≥ 0 and, with friction, |τ| ≤ μ_s λ. It states
/// the force and the moment that stay unbalanced at the least |f − B_rᵀ p|, for the first body concerned.
/// @param f  (r) f_r
void check_held(const Model& model, const RigidModes& rigid, const Vector& f);

}  // namespace ricochet::contact
