// SPDX-License-Identifier: BSD-2-Clause
// The exact response of the modes to loads with histories and to moving supports over an interval of time.
//
// Modal coordinates are relative to the quasi-static lift of the moving supports: with the displacement ū(t)
// of a support, its lift Ψ and Γ = Φᵀ M Ψ,
//   u = Ψ ū + Φ q,   q̈ + 2δ q̇ + ω² q = f(t) − Γ d²ū/dt²
// Histories are piecewise linear, so −Γ d²ū/dt² is a jump −Γ K of q̇ at each knot where the slope changes by
// K, and f is a sum of ramps that begin at knots. The rates of the body itself are q̇ + Γ dū/dt.
//
// Between two knots, f = f₀ + k t, and an elastic mode moves about a rest position that moves steadily,
//   q_r = f/ω² − 2δ k/ω⁴,   d²/dt² (q − q_r) + 2δ d/dt (q − q_r) + ω² (q − q_r) = 0
// If nothing changes (k = 0, no support moves), loads are constants like gravity, and the interval is not
// forced.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/energy_ledger.hpp"
#include "contact/stepping/propagator.hpp"

namespace ricochet::contact {

class ForcedResponse {
 public:
  /// An interval of time, and the forcing at its end.
  struct Interval {
    double from = 0, to = 0;
    bool whole = false;   ///< one step long
    bool forced = false;  ///< otherwise, piece().load acts, q and v are undefined, rate and lift are 0
    Vector q, v;          ///< (N) response of a mode at rest to the forcing alone
    Vector s, rate;       ///< (n) quasi-static displacement of the contact points and its rate, [m], [m/s]
    Vector lift;          ///< (N) Γ dū/dt [kg^1/2 m/s]
    void archive(auto& a) { a(from, to, whole, forced, q, v, s, rate, lift); }
  };
  /// The forcing at an instant, and its change up to the next knot.
  struct Piece {
    double at = std::numeric_limits<double>::quiet_NaN();
    double to = std::numeric_limits<double>::infinity();  ///< the next knot
    bool steady = true;                                   ///< whether nothing changes
    bool loaded = false;                                  ///< whether a load acts
    Vector load, applied;  ///< (N) modal force at `at`, with and without gravity [kg^1/2 m/s²]
    Vector slope;          ///< (N) of both [kg^1/2 m/s³]
    /// (N) The part of q_r that loads cause, at `at`, and its rate; 0 for rigid modes.
    Vector rest_q, rest_v;
    Vector s;            ///< (n) as in Interval, at `at` [m]
    Vector rest, drift;  ///< (n) u with elastic modes at q_r, at `at`, and its rate, [m], [m/s]
    void archive(auto& a) { a(at, to, steady, loaded, load, applied, slope, rest_q, rest_v, s, rest, drift); }
  };

  /// Of a folded model.
  ForcedResponse(const Model& model, double step);

  /// Whether there is any forcing, or something has pushed.
  bool any() const { return !acting().empty(); }
  /// Returns an interval at t = 0 whose vectors are allocated.
  Interval start();

  /// Sets the modal force of a load on a body that has turned, for a history of value 1.
  void turn(std::size_t load, const Vector& force) noexcept;
  /// Sets what pushes from outside until it is set again: modal forces (N) [kg^1/2 m/s²] and the displacement
  /// of the contact points at once (n) [m]; of bodies that turn, modal forces alone.
  void push(const Model& model, const Vector& force, const Vector& displacement) noexcept;

  /// The forcing at t.
  const Piece& piece(double t) noexcept;
  const Piece& piece() const { return piece_; }

  /// Computes the response in step k, from t_{k−1} to t_k.
  void step(std::int64_t k, Interval& out) noexcept;
  /// The same with q and v, also if the interval is not forced.
  void forced_step(std::int64_t k, Interval& out) noexcept;
  /// Computes the response in any other interval. The interval and each knot inside cost one mode_response
  /// per forced mode.
  void interval(double from, double to, Interval& out) noexcept;

  /// Advances (q, v) from the start of an interval to its end, from knot to knot, under the forcing and the
  /// modal force `constant`, which excludes loads.
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

  void archive(auto& a) {
    a(pushes_);
    for (Model::Forcing& one : forcing_) a(one.force);
    a(forcing_.back().displacement, rests_.back().at, piece_);
  }

 private:
  /// What a load or a support of value 1 adds to `rest`, and, of slope 1, subtracts from it because of
  /// damping.
  struct Rest {
    Vector at, lag;  ///< (n)
  };
  void set_times(std::int64_t k, Interval& out) const noexcept;
  void fill(Interval& out) noexcept;
  void fill_unless_steady(Interval& out) noexcept;

  std::span<const Model::Forcing> acting() const {
    return {forcing_.data(), forcing_.size() - (pushes_ ? 0 : 1)};
  }

  double step_;
  Vector omega_, decay_;         ///< (N)
  Vector softness_;              ///< (N) 1/ω² of elastic modes; 0 for others
  Vector gravity_;               ///< (N) constant modal force
  std::vector<ModeStep> whole_;  ///< (N) response over one step
  Vector s_, rest_;              ///< (n) under gravity alone
  /// Those of the model, and what pushes from outside; supports do not lift folded modes.
  std::vector<Model::Forcing> forcing_;
  bool pushes_ = false;      ///< whether something has pushed
  std::vector<Rest> rests_;  ///< (forcings)
  Piece piece_;
  Vector value_, slope_, lift_;  ///< (N) scratch of `advance`
};

}  // namespace ricochet::contact
