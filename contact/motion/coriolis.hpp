// SPDX-License-Identifier: BSD-2-Clause
// The Coriolis force on nearly equal elastic modes of a body that turns.
//
// In axes that turn with Ω, let v_n = φ_nᵀ M (u̇ + Ω × u) be the rates of the modes as a point at rest sees
// them:
//
//   q̇_m = v_m + Σ_n a_mn q_n,   v̇_m = f_m − ω_m² q_m + Σ_n a_mn v_n,   a_mn = Ω·g_mn = −a_nm,
//   g_mn = ∫ρ φ_m × φ_n
//
// The terms of a pair with one ω turn (q_m, q_n) and (v_m, v_n) by the angle ∫a dt, independently of the
// vibration. The pattern of a ring with n waves, for which g = 2n/(n² + 1), turns in the ring by −2/(n² + 1)
// of its spin. Where ω_m and ω_n differ a little, (ω_m q_m, ω_n q_n) is turned instead, so that ½Σ(v² + ω²q²)
// does not change in any case. Pairs that share a mode are turned one after the other, before the vibration
// of a step, and after it in the opposite order: the error is of second order. The basis of a multiple mode
// does not matter to its pair, since g_mn does not depend on it.
//
// A pair exchanges at most the share 2|Ω·g|/(ω_n − ω_m) of its amplitude. Pairs below 1 % are left alone.
#pragma once

#include <span>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

class Coriolis {
 public:
  /// The pairs of a body, without folded modes.
  Coriolis(const Model& model, const Bodies::Block& block);

  bool empty() const { return pairs_.empty(); }

  enum class Half { before, after };  ///< the vibration
  /// Turns q and v (N of all bodies), on either side of the vibration over a time [s].
  /// @param angle  ∫Ω dt over half of this time, body axes [rad]
  void turn(const Eigen::Vector3d& angle, double time, Half half, Vector& q, Vector& v) const noexcept;

  /// Adds Σ_n a_mn x_n to `out`, at a spin Ω or at its rate (N of all bodies). @param speed  |Ω|, which
  /// selects the pairs [rad/s]  @param of_q  whether x is q, with ω_n/ω_m in each term; otherwise rates
  void add_turn(const Eigen::Vector3d& spin, double speed, bool of_q, const Vector& x,
                Vector& out) const noexcept;

  /// Longest time between two halves [s] that leaves an error of about 1e-3 of the turn, at most; ∞ if
  /// nothing is turned. @param spin  |Ω|, at most [rad/s]
  double longest(double spin) const noexcept;

 private:
  struct Pair {
    Eigen::Index m, n;
    Eigen::Vector3d coupling;  ///< g_mn
    double ratio;              ///< ω_n/ω_m
    double slowest;            ///< spin below which it is left alone [rad/s]
  };
  std::span<const Pair> turned_at(double speed) const noexcept;

  std::vector<Pair> pairs_;  ///< by `slowest`, ascending
  double widest_ = 0;        ///< largest ω_n − ω_m [rad/s]
};

/// By body. Supported bodies have no pairs.
std::vector<Coriolis> coriolis_of(const Model& model);

}  // namespace ricochet::contact
