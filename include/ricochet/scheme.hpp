// SPDX-License-Identifier: BSD-2-Clause
// The schemes of time stepping, as scenes, the library and both embedding interfaces name them.
#pragma once

namespace ricochet {

enum class Scheme {
  compliant,  ///< λ constant over the step; Signorini's conditions at its end, with the residual flexibility
  impulse,    ///< algorithm (30) of the source paper: impulses at the instants t_k on the points that are
              ///< found beyond their gap
  at_rest,    ///< "static": equilibrium, no steps
};
enum class Admittance {
  jump,        ///< A = Ṅ(0⁺) = B Bᵀ, v̂ the velocity at t_k, as printed in the paper
  difference,  ///< A = N(Δ)/Δ, v̂ = (û(t_{k+1}) − u(t_k))/Δ
};

enum class Instant {
  step,   ///< at t_k
  exact,  ///< event location: impulse at the instant at which a point closes within the step, and again at
          ///< t_k if the point is beyond its gap
};

enum class Precision { float64, float32 };

/// The force that drives the modes over a step of the compliant scheme.
enum class ContactStep {
  conserving,      ///< a mean of the forces at the last three instants: second order, and contact in place
                   ///< conserves energy
  backward_euler,  ///< the force at the end of the step: first order, and every change of force costs energy
};

}  // namespace ricochet
