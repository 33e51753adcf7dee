// SPDX-License-Identifier: BSD-2-Clause
// Whether contact forces can balance the loads of bodies that could move rigidly.
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

/// Imbalance of forces at rest, relative to the sum of the magnitudes of their terms, that counts as
/// round-off of sums over many points. With friction, softer springs (equilibrium.hpp) would cost more
/// digits.
constexpr double most_imbalance(bool friction) { return friction ? 1e-9 : 1e-11; }

/// Throws InputError unless forces p with B_rᵀ p = f exist: λ ≥ 0 and, with friction, |τ| ≤ μ_s λ. It states
/// the force and the moment that stay unbalanced at the least |f − B_rᵀ p|, for the first body concerned.
/// With friction, it resolves 1e-7 of the load: whether less is balanced shows when forces are sought.
/// @param f  (r) f_r
void check_balance(const Model& model, const RigidModes& rigid, const Vector& f);

/// Throws the InputError of check_balance for the body with the largest part of `left`.
/// @param left  (r) f_r − B_rᵀ p
[[noreturn]] void refuse_unbalanced(const Model& model, const RigidModes& rigid, const Vector& left);

}  // namespace ricochet::contact
