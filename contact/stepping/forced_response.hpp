// What loads with histories and moving supports do to the modes over a stretch of time, exactly.
//
// Modal coordinates are relative to the quasi-static lift of the moving supports: with the support's
// displacement ū(t), its lift Ψ and Γ = Φᵀ M Ψ,
//   u = Ψ ū + Φ q,   q̈ + 2δ q̇ + ω² q = f(t) − Γ d²ū/dt²
// Histories are piecewise linear, so −Γ d²ū/dt² is a jump −Γ K of q̇ at each knot where the slope changes by
// K, and f is made of ramps that begin at knots. The rates of the body itself are q̇ + Γ dū/dt.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/propagator.hpp"

namespace ricochet::contact {

/// Steps of less than half a period sample a mode.
inline bool sampled(double omega, double step) { return !(omega * step > std::numbers::pi); }

class Drives {
 public:
  /// A stretch of time, and where the drives stand at its end.
  struct Stretch {
    double from = 0, to = 0;
    bool whole = false;  ///< one step long
    Vector q, v;         ///< (N) what the drives alone make of a mode at rest
    Vector s, rate;      ///< (m) quasi-static displacement of the contact points and its rate, [m], [m/s]
    Vector lift;         ///< (N) Γ dū/dt [kg^1/2 m/s]
  };
  /// [J]
  struct Work {
    double damping = 0;  ///< ∫ 2δ q̇²
    double drives = 0;   ///< ∫ f·q̇ of the loads with histories, ∫ Γ (dū/dt) q̈ of the supports
  };

  /// @param static_modes  modes that steps do not sample answer at once: no q, and their loads in s
  Drives(const Model& model, double step, bool static_modes);

  bool any() const { return !drives_.empty(); }
  /// A stretch with room for its values, at t = 0.
  Stretch start() const;

  /// Step k, from t_{k−1} to t_k.
  void step(std::int64_t k, Stretch& out) const noexcept;
  /// Any other stretch. Costs a response of each driven mode, as does each knot inside.
  void stretch(double from, double to, Stretch& out) const noexcept;

  /// Takes (q, v) from the start of a stretch to its end under the drives and the modal force `constant`,
  /// from knot to knot.
  Work advance(const Stretch& over, const Vector& constant, Vector& q, Vector& v) noexcept;

  /// Modal force of the loads at t and its slope up to the next knot [kg^1/2 m/s², kg^1/2 m/s³].
  void force(double t, Vector& value, Vector& slope) const noexcept;
  /// Quasi-static displacement of the contact points at t and its rate up to the next knot [m, m/s].
  void points(double t, Vector& s, Vector& rate) const noexcept;
  /// A while after (q, v) under a force and its slope, without knots in between.
  void glide(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
             Vector& then_q, Vector& then_v) const noexcept;
  /// (N) No |q̈| is larger within this time.
  void bound(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
             Vector& acceleration) const noexcept;
  /// The first knot after t; infinite when there is none.
  double next_knot(double t) const noexcept;
  /// What q̇ jumps by at a knot, where a support changes its speed.
  void kick(double knot, Vector& v) const noexcept;

 private:
  struct Drive {
    History history;
    Eigen::Index first, modes;  ///< of its body
    Vector force, lift;         ///< (modes) of a load, of a support; 0 for the other
    Vector displacement;        ///< (m)
    bool support;
  };
  void fill(Stretch& out) const noexcept;

  double step_;
  Vector omega_, decay_;         ///< (N); 0 of modes that answer at once
  std::vector<ModeStep> whole_;  ///< (N) one step
  Vector s_;                     ///< (m) of constant loads
  std::vector<Drive> drives_;
  Vector value_, slope_, lift_;  ///< (N) within `advance`
};

}  // namespace ricochet::contact
