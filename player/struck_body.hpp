// SPDX-License-Identifier: BSD-2-Clause
// A body and the mallets in front of it, as one modal system that changes whenever a mallet comes or goes.
// The steps are those of CompliantStepper (contact/law/contact_law.hpp) without loads and friction. R_ii of a
// point includes the layer of the mallet. All contact points of all mallets enter one problem, so mallets
// that touch at the same time feel each other through the modes of the body. They do not feel each other's
// residual flexibility, which decays away from a contact. Mallet k has the modes N + kP … and the rows km ….
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "contact/law/contact_law.hpp"
#include "player/instrument.hpp"
#include "player/loops.hpp"

namespace ricochet::player {

/// Energies [J] of the body and of the mallets in front of it; their sum is constant without damping, except
/// when a mallet comes or goes.
struct Energies {
  double body = 0, mallets = 0;  ///< kinetic and strain
  double residual = 0;           ///< ½ λᵀRλ
  double contact = 0;            ///< removed by contact so far
};

/// Only the constructor allocates.
class StruckBody {
 public:
  using Vector = contact::Vector;

  /// @param mallets  most mallets at a time  @param step  of contact [s]  @param flight  of free flight [s]
  StruckBody(const Instrument& instrument, int mallets, double step, double flight);

  /// Multiplies the decay rates of the body; factor ≥ 0.
  void set_damping(double factor) noexcept;

  /// Brings a mallet in front of a place, moving towards it [m/s]. If the body bulges there, the mallet
  /// starts farther out, so that nothing overlaps. If it is the only one, a free body is back at rest.
  void bring(int slot, const Place& place, int mallet, double speed) noexcept;
  /// Takes a mallet away.
  void take(int slot) noexcept;
  bool holds(int slot) const { return count_[slot] > 0; }
  bool touches(int slot) const noexcept;  ///< at one of the last two instants
  /// Whether a mallet does not touch and recedes beyond all vibrations of the body.
  bool recedes(int slot) const noexcept;
  bool alone() const { return slots_ == 0; }  ///< whether no mallet is present

  /// Makes one contact step. Returns false if the motion is not finite; everything is then at rest.
  bool step() noexcept;
  /// Advances the body across one free flight; only if it is alone.
  void advance_in_flight() noexcept;
  /// Sets each mode to rest whose energy is below `least` [J]. Returns whether all modes are at rest.
  bool rest_below(double least) noexcept;
  void rest() noexcept;  ///< takes all mallets away and stops all motion

  double force() const { return force_; }  ///< Σ λ̄ of the last step [N]
  /// Σ row · q̇ over the modes of the body. @param row  (N)
  double velocity(const Vector& row) const noexcept { return dot(row.data(), v_.data(), N_); }
  /// √(q̇² + ω²q²) of a mode of the body.
  double amplitude(Eigen::Index n) const noexcept {
    return std::sqrt(v_(n) * v_(n) + stiffness_(n) * q_(n) * q_(n));
  }
  Energies energies() const noexcept;

 private:
  /// Constants of modes over a time, as in propagator.hpp.
  struct Propagator {
    Vector S, c, rate;
    void set(Eigen::Index n, double omega, double decay, double time) noexcept;
  };

  void couple(int slot) noexcept;
  void renumber() noexcept;

  const Instrument* instrument_;
  double step_, flight_;
  Eigen::Index N_, P_, points_;      ///< N, P, m
  Eigen::Index modes_, rows_ = 0;    ///< in use
  int slots_ = 0;                    ///< slots in use: all present mallets are below
  std::vector<Eigen::Index> count_;  ///< contact points of each slot; 0: no mallet
  Propagator contact_, free_;        ///< over a contact step (N + mallets · P); over a free flight (N)
  Vector stiffness_, q_, v_;         ///< (N + mallets · P)
  contact::Matrix B_;                ///< (rows,modes)
  Eigen::MatrixXd M_, R_, S_, S_mean_;
  Vector u_, end_;        ///< (rows)
  Vector g_, dq_, push_;  ///< (modes)
  bool has_bulges_;
  std::vector<int> rows_in_use_;
  contact::ContactLaw law_;
  contact::MeanForce mean_;
  double force_ = 0, residual_ = 0, removed_ = 0;
};

}  // namespace ricochet::player
