// SPDX-License-Identifier: BSD-2-Clause
// Candidate screening: finds the points that could close in a look-ahead block. All other points provably
// stay open and are skipped.
//
// The margin of a point is a lower bound on its gap if forces stay at λ̂. It follows from the energy of the
// modes or from the prediction of the point. Changes of the forces reduce it by at most Σ_j (max_d |S_d,ij|)
// Σ_k δ_kj, where δ_kj is the change of the force at point j in step k, and S_0 includes R. Each point gets a
// budget for Σ_k δ_kj, derived from its changes in the previous block. If the point exceeds its budget, the
// budget is raised, and points whose margin no longer suffices must be kept.
//
// Forces act on all rows of the system, tangential ones included. Only contacts, the normal rows, have
// margins.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <span>
#include <vector>

#include "contact/stepping/block_motion.hpp"

namespace ricochet::contact {

template <class T>
class CandidateScreening {
 public:
  explicit CandidateScreening(const BlockSystem<T>& system);

  /// Starts a block: derives the budgets from the changes in the previous block, which were made at the
  /// points `changed`.
  void start(const BlockSystem<T>& system, std::span<const int> changed) noexcept;

  /// Sets the margins of all points from the energy of the modes at the start of a block without knots, which
  /// move under λ̂.
  void bound_by_energy(const BlockSystem<T>& system, const BlockMotion<T>& motion,
                       const BlockForcing& forcing, const BlockForce<T>& held) noexcept;
  void set_margin(int point, double margin) noexcept { margin_(point) = margin; }
  /// For blocks in which a history has a knot, where the energy may grow: no point is skipped before it is
  /// predicted.
  void drop_margins() noexcept { margin_.setConstant(-1); }

  /// Whether the point could close if forces change by `times` their budgets.
  bool could_close(int point, double times) const noexcept {
    return !(margin_(point) > times * could_(point));
  }

  /// Adds the change δ of a point's force in one step.
  void spend(int point, double change) noexcept { spent_(point) += change; }
  /// Raises the budgets that the changes δ of a step (by position in `points`) exceed. Returns whether there
  /// are any.
  bool raise_budgets(const BlockSystem<T>& system, std::span<const int> points,
                     const Vector& change) noexcept;

  void archive(auto& a) { a(margin_, could_, spent_, budget_); }

 private:
  void combine(const BlockSystem<T>& system, const float* rows, std::span<const int> of) noexcept;

  const simd::Loops<float>* loops_;  ///< bounds are in single precision, rounded up
  Vector margin_, could_;  ///< (contacts) bound on g − u under λ̂; bound on u due to budgeted changes
  Vector spent_, budget_;  ///< (points) Σ δ in this block; its bound, on which could_ is based
  Vector rigid_at_;        ///< (L) u of a point by rigid motion
  std::vector<int> places_, every_band_;  ///< of rows in the matrices; 0, 1, …
  std::vector<float> factor_;             ///< scratch
  base::AlignedVector<float> sum_;
};

}  // namespace ricochet::contact
