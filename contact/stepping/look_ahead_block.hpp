// SPDX-License-Identifier: BSD-2-Clause
// Look-ahead blocks: steps of the compliant scheme by matrix products.
//
// The motion over a block of L steps under the last known force λ̄, held constant, is known beforehand: one
// product of B with L columns. A force that departs from λ̄ in step k adds, from then on, a term of the
// step-integrated kernel,
//
//   u_l = ū_l − Σ_{k ≤ l} S_{l−k} (λ_k − λ̄),   S_d = B (c((d+1)Δ) − c(dΔ)) Bᵀ, c(0) = 0,   and R in S_0,
//
// so the far history comes from the modes, the near history from convolution. Nothing is approximated. Points
// that provably stay open are skipped (candidate_screening.hpp).
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/stepping/block_system.hpp"
#include "contact/stepping/candidate_screening.hpp"
#include "contact/stepping/gathered_system.hpp"

namespace ricochet::contact {

template <class T>
class LookAheadBlock {
 public:
  /// `forced`: loads or supports vary. Allocates; nothing below does.
  LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forced);

  /// The response of q, q̇ (N) to the forcing in step l = 1…L of the block to start, and s (m) at its end; s
  /// with l = 0 is that at the start of the block. To be called for all l before `start`.
  void set_forcing(int l, const Vector& q, const Vector& v, const Vector& s) noexcept;

  /// Starts a block from q, q̇ (N) under the force λ (m) of the step before.
  void start(const Vector& q, const Vector& v, const Vector& force) noexcept;

  /// Solves the next step; `force` (m) out. A step that fails changes nothing. After the solver has cut a
  /// step short, points beyond their gap stay where they are and are not pushed back.
  SolveStatus step(ComplementaritySolver& solver, Vector& force) noexcept;

  /// Discards the block: the next one starts from the state before the step that failed.
  void take_back() noexcept;

  /// Moves the state through the steps taken since it was moved last. Not with forcing.
  /// @param keep_rates  q̇ after each of them is for rate()
  simd::Sums advance(bool keep_rates) noexcept;
  void copy_state(Vector& q, Vector& v) const noexcept;
  /// (N) q̇ after step l = 1…L.
  const double* rate(int l) const { return &rates_[(l - 1) * system_->modes]; }

  int length() const { return system_->length; }
  int advanced() const { return advanced_; }
  bool over() const { return taken_ == system_->length; }
  int pushing() const { return pushing_; }     ///< points with λ > 0 in the last step
  double work() const { return work_; }        ///< λᵀ (u_l − u_{l−1}) of the last step [J]
  double energy_in_residual() const noexcept;  ///< ½ λᵀ R λ of the last step
  /// Number of points that screening kept in the last step.
  int kept() const { return static_cast<int>(kept_.size()); }

 private:
  /// u of a kept point after step l = 1…L.
  double& u(std::size_t position, int l) { return u_[(l - 1) * system_->width + position]; }
  double at_start(int point) const noexcept;
  void hold(const Vector& force) noexcept;
  void predict_rigid() noexcept;
  void predict(std::span<const int> rows) noexcept;
  void predict_kept(double times) noexcept;
  void choose_kept() noexcept;
  void keep(int point) noexcept;
  void gather() noexcept;
  bool keep_more() noexcept;
  void advance_rigid(bool keep_rates, simd::Sums& sums) noexcept;
  /// Whether a point pushes, or could if forces change by this many times their budgets.
  bool must_keep(int i, double times) const { return held_force_(i) > 0 || screening_.could_close(i, times); }
  simd::Modes modes() const;

  std::shared_ptr<const BlockSystem<T>> system_;
  GatheredSystem<T> near_;
  CandidateScreening<T> screening_;
  bool forced_;
  int taken_, advanced_;
  // of this block
  std::vector<double> q_, v_, load_, held_;  ///< (modes) load_: less held_, which is Bᵀλ̄
  std::vector<double> rigid_q_, rigid_v_, rigid_held_;
  std::vector<double> forcing_;        ///< (L, 2, modes) response of q and q̇ to the forcing
  Matrix s_;                           ///< (1, m); with forcing (L + 1, m)
  std::vector<T> x_;                   ///< (L, modes)
  std::vector<double> rates_;          ///< (L, modes)
  Matrix rigid_motion_;                ///< (L, rigid)
  Vector rigid_at_;                    ///< (L) u of a point by rigid motion
  std::vector<double> predicted_u_;    ///< (L, width) ū of points that were predicted
  std::vector<double> u_;              ///< (L, width) u of kept points, by position
  std::vector<T> changes_;             ///< (points, L) λ − λ̄
  Vector held_force_;                  ///< (points) λ̄
  Vector held_rest_;                   ///< (points) R λ̄
  Vector held_push_, rhs_, solution_;  ///< (points) by position: S_0 λ̄; of the step
  Vector ended_;                       ///< (points) u at the end of the block before
  std::vector<char> was_kept_, is_predicted_, has_changed_;     ///< (points)
  std::vector<int> position_;                                   ///< (points) among kept_, or −1
  std::vector<int> gathered_;                                   ///< the points of near_
  std::vector<int> pressed_, predicted_, kept_, have_changed_;  ///< λ̄ > 0; …; λ ≠ λ̄ in this block
  std::vector<int> changed_;                                    ///< positions of λ ≠ λ̄ in this step
  std::vector<T> change_, factor_, sum_;  ///< of changed_; (points) and (padded) scratch
  bool is_new_problem_ = true;            ///< near_.S changed: the solver's active set does not apply
  int pushing_ = 0;
  double work_ = 0;
};

}  // namespace ricochet::contact
