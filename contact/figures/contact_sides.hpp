// SPDX-License-Identifier: BSD-2-Clause
// Motion of the two sides of each contact point along its normal:
//
//   u = n·u_a − n·u_b,   n·u_a = B_a q + s_a − R_a p,   n·u_b = B_b q + s_b − R_b p
//
// A spring s(λ) is divided between the sides in the ratio of their flexibilities R_ii.
// Modes above half the step rate are in R and s, as in the steps.
//
// The residual flexibility moves with the forces p, which the compliant scheme defines only at the ends of
// its steps. A velocity that contains it is therefore the mean over a step, as the force λ̄ is:
//
//   v = (u⁺ − u)/Δ = B (q⁺ − q)/Δ + (s⁺ − s)/Δ − R (p⁺ − p)/Δ
//
// A point that stays closed on a rigid half-space then has v = 0, the sum of v Δ over the steps is the
// displacement, and λ̄ᵀ(v_a − v_b) is the power that the steps exchange with the contact. Under impulses p = 0
// and the velocity of the modes jumps: there, v = B q̇ + ds/dt just after the impulses.
#pragma once

#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// (m) each, along the normals.
struct SidesMotion {
  Vector displacement_a, displacement_b;  ///< [m]
  Vector velocity_a, velocity_b;          ///< [m/s]
};

class ContactSides {
 public:
  /// Starts at t = 0. `model` must outlive this object.
  ContactSides(const Model& model, const StepOptions& options);

  /// Motion after the last step, which must be the only one since `pass`.
  const SidesMotion& after(const Stepper& stepper) noexcept;
  /// Call it after each step, and after `after`: the next velocities refer to this state. It does not
  /// allocate.
  void pass(const Stepper& stepper) noexcept;

  const SidesMotion& at_rest(const Equilibrium& equilibrium) noexcept;

 private:
  struct State {
    double time = 0;
    Vector q, p;  ///< (N), (n)
  };
  void displacement(double time, const Vector& q, const Vector& p, Vector& a, Vector& b) noexcept;
  void along(const Vector& q, Vector& a, Vector& b) const noexcept;

  const Model& model_;
  StepOptions options_;
  std::vector<int> pressed_;  ///< rows with a force
  std::vector<PatchSpring> springs_;
  Vector share_a_;                   ///< (m) share of a in each spring
  Vector s_a_, s_b_;                 ///< (m) constant part
  Matrix driven_a_, driven_b_;       ///< (m,forcings) displacement for a history of value 1
  State before_;                     ///< at the last `pass`
  Vector before_a_, before_b_;       ///< (m) displacement there
  bool knows_displacement_ = false;  ///< whether before_a_ and before_b_ are those of before_
  double time_ = 0;                  ///< of motion_
  SidesMotion motion_;
};

}  // namespace ricochet::contact
