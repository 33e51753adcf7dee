// SPDX-License-Identifier: BSD-2-Clause
// The schemes of time stepping and their settings.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

/// How the motion of free bodies as a whole is described.
enum class Rotation {
  linear,  ///< by their rigid modes, about the initial attitude: exact for small rotations
  finite,  ///< by floating frames: any rotation. Contact points are found anew at each step.
};

/// The axes in which a vector is constant while a body turns.
enum class Axes {
  world,
  body,  ///< those of the body, which turn with it
};

struct RigidBodies {
  Rotation rotation = Rotation::linear;
  bool operator==(const RigidBodies&) const = default;
};

/// How a step finds the contact.
struct ContactScheme {
  Scheme scheme = Scheme::compliant;
  Admittance admittance = Admittance::jump;           ///< of the impulse scheme
  Instant instant = Instant::step;                    ///< of the impulse scheme
  double restitution = 0;                             ///< e of the impulse scheme, in [0, 1]
  ContactStep integration = ContactStep::conserving;  ///< of the compliant scheme
  /// Bound on the work of a step, at least 1: the number of changes of the active set in its solve. Where
  /// points have springs (contact/complementarity/patch_spring.hpp), it bounds each of at most 8 linear
  /// problems.
  int max_pivots = std::numeric_limits<int>::max();
  bool operator==(const ContactScheme&) const = default;
};

/// Largest number of contact steps per output sample.
inline constexpr double most_steps_per_sample = 1e6;

/// When steps are made, and how exactly.
struct Stepping {
  double rate_hz = 44100;  ///< output samples per second
  /// Contact steps per second of the compliant scheme, made while a point could close; rounded up to a
  /// multiple of rate_hz. No value: rate_hz.
  std::optional<double> contact_rate_hz{};
  /// Of the matrix products of the compliant scheme. Single precision is faster and less exact.
  Precision precision = Precision::float64;
  /// Number of contact steps per output sample, a whole number. Round-off of the rates does not count.
  double steps_per_sample() const {
    return std::max(1.0, std::ceil(contact_rate_hz.value_or(rate_hz) / rate_hz * (1 - 1e-12)));
  }
  double step() const { return 1 / (rate_hz * steps_per_sample()); }  ///< of contact, Δ [s]
  bool operator==(const Stepping&) const = default;
};

}  // namespace ricochet
