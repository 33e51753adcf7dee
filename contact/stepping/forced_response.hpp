// SPDX-License-Identifier: BSD-2-Clause
// The exact response of the modes to loads with histories and to moving supports over an interval of time.
//
// Modal coordinates are relative to the quasi-static lift of the moving supports: with the displacement ū(t)
// of a support, its lift Ψ and Γ = Φᵀ M Ψ,
//   u = Ψ ū + Φ q,   q̈ + 2δ q̇ + ω² q = f(t) − Γ d²ū/dt²
// Histories are piecewise linear, so −Γ d²ū/dt² is a jump −Γ K of q̇ at each knot where the slope changes by
// K, and f is a sum of ramps that begin at knots. The rates of the body itself are q̇ + Γ dū/dt.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/energy_ledger.hpp"
#include "contact/stepping/propagator.hpp"

namespace ricochet::contact {

/// Whether steps sample a mode, that is, whether they are no longer than half its period.
inline bool sampled(double omega, double step) { return !(omega * step > std::numbers::pi); }

class ForcedResponse {
 public:
  /// An interval of time, and the forcing at its end.
  struct Interval {
    double from = 0, to = 0;
    bool whole = false;  ///< one step long
    Vector q, v;         ///< (N) response of a mode at rest to the forcing alone
    Vector s, rate;      ///< (m) quasi-static displacement of the contact points and its rate, [m], [m/s]
    Vector lift;         ///< (N) Γ dū/dt [kg^1/2 m/s]
  };
  /// @param static_modes  whether modes that steps do not sample respond statically: their q stays 0, and s
  ///                      includes their loads
  ForcedResponse(const Model& model, double step, bool static_modes);

  bool any() const { return !forcing_.empty(); }
  /// Returns an interval at t = 0 whose vectors are allocated.
  Interval start() const;

  /// Computes the response in step k, from t_{k−1} to t_k.
  void step(std::int64_t k, Interval& out) const noexcept;
  /// Computes the response in any other interval. The interval and each knot inside cost one mode_response
  /// per forced mode.
  void interval(double from, double to, Interval& out) const noexcept;

  /// Advances (q, v) from the start of an interval to its end, from knot to knot, under the forcing and the
  /// modal force `constant`.
  Work advance(const Interval& over, const Vector& constant, Vector& q, Vector& v) noexcept;

  /// Computes the modal force of the loads at t and its slope up to the next knot [kg^1/2 m/s², kg^1/2 m/s³].
  void force(double t, Vector& value, Vector& slope) const noexcept;
  /// Computes the quasi-static displacement [m] of the contact points at t and its rate [m/s] up to the next
  /// knot.
  void points(double t, Vector& s, Vector& rate) const noexcept;
  /// Computes the state after `time` from (q, v) under a force and its slope, without knots in between.
  void free_flight(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
                   Vector& then_q, Vector& then_v) const noexcept;
  /// Computes an upper bound (N) on |q̈| within `time`.
  void bound(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
             Vector& acceleration) const noexcept;
  /// Returns the first knot after t, or infinity if there is none.
  double next_knot(double t) const noexcept;
  /// Adds the jump of q̇ at a knot where a support changes its speed.
  void velocity_jump(double knot, Vector& v) const noexcept;

 private:
  void fill(Interval& out) const noexcept;

  double step_;
  Vector omega_, decay_;                 ///< (N); 0 for modes that respond statically
  std::vector<ModeStep> whole_;          ///< (N) response over one step
  Vector s_;                             ///< (m) of constant loads
  std::vector<Model::Forcing> forcing_;  ///< those of the model, without the modes that respond statically
  Vector value_, slope_, lift_;          ///< (N) scratch of `advance`
};

}  // namespace ricochet::contact
