// SPDX-License-Identifier: BSD-2-Clause
// Look-ahead blocks: steps of the compliant scheme by matrix products.
//
// The motion over a block of L steps under the last mean force λ̂, kept constant, is known beforehand from one
// product of B with L columns. A mean force that departs from λ̂ in step k adds a term of the step-integrated
// kernel from then on:
//
//   u_l = ū_l − Σ_{k ≤ l} M_{l−k} (λ̄_k − λ̂) − R (λ_l − λ̂),   M_d = B (c((d+1)Δ) − c(dΔ)) Bᵀ, c(0) = 0
//
// Springs of the points add −s(λ_l) to u_l. The far history thus comes from the modes, and the near history
// from a convolution. Nothing is approximated. Points that provably stay open are skipped
// (candidate_screening.hpp).
//
// Here a point is a row of the system: a contact, that is, a normal row, or a row along a tangent of a
// contact with friction. Tangential rows have no gap to close; they are kept with their contact.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "contact/law/contact_law.hpp"
#include "contact/stepping/block_motion.hpp"
#include "contact/stepping/block_points.hpp"
#include "contact/stepping/block_system.hpp"
#include "contact/stepping/candidate_screening.hpp"

namespace ricochet::contact {

template <class T>
class LookAheadBlock {
 public:
  /// @param forcing  whether there are loads with histories or moving supports
  /// Allocates all memory; the other functions allocate nothing.
  LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forcing);

  /// The forcing of the block that `start` begins; to be set before.
  BlockForcing& forcing() { return forcing_; }
  const BlockForcing& forcing() const { return forcing_; }

  /// Starts a block from q, q̇ (N) under the mean force λ̂ (m) of the previous step.
  /// @param law  holds the kept points from now on
  /// @param mean  the forces at the last instants
  void start(const Vector& q, const Vector& v, const Vector& force, ContactLaw& law,
             const MeanForce& mean) noexcept;

  /// Solves the next step and sets `force` to λ̄ and `end` to λ⁺, (m) each. A step that fails changes nothing.
  StepTrial step(ContactLaw& law, const MeanForce& mean, Slip* slip, Vector& force, Vector& end) noexcept;

  /// Discards the block: the next one starts from the state before the step that failed.
  void take_back() noexcept;

  /// Advances the state through the steps solved since the last call. Must not be used in a forced block.
  /// @param keep_rates  whether to record q̇ after each of these steps for rate()
  simd::Sums advance(bool keep_rates) noexcept;
  /// (N) q after these steps.
  Eigen::Map<const Vector> q() const { return {motion_.q().data(), forcing_.load.size()}; }
  void copy_state(Vector& q, Vector& v) const noexcept;
  /// (N) q̇ after step l = 1…L.
  const double* rate(int l) const { return motion_.rate(l); }

  int length() const { return system_->length; }
  int advanced() const { return advanced_; }
  bool over() const { return taken_ == system_->length; }
  bool begins() const { return taken_ == 1; }  ///< whether one step has been solved
  int touching() const { return touching_; }   ///< number of points with λ > 0 at the end of the last step
  double work() const { return work_; }        ///< λ̄ᵀ (u_l − u_{l−1}) of the last step [J]
  /// ½ λᵀ R λ and the energy of springs after the last step [J].
  double energy_in_residual() const noexcept { return in_residual_; }
  /// Number of points that screening kept in the last step.
  int kept() const { return kept_.size(); }

  void archive(auto& a) {
    a(forcing_, changes_, motion_, prediction_, screening_, taken_, advanced_, has_force_, largest_change_);
    a(touching_, work_, in_residual_, surplus_);
    held_.archive(a, *system_);
    kept_.archive(a, *system_);
    if (!a.reads() || a.failed()) return;
    for (const int row : changes_.rows()) system_->matrices->need(row);
  }

 private:
  double at_start(int point, const MeanForce& mean) const noexcept;
  /// u of a kept point before the current step.
  double before(int position, const MeanForce& mean) noexcept {
    return taken_ > 0 ? kept_.u(position, taken_) : at_start(kept_.rows()[position], mean);
  }
  StepTrial attempt(ContactLaw& law, const MeanForce& mean, Slip* slip) noexcept;
  void predict(std::span<const int> rows) noexcept;
  void predict_kept(double times) noexcept;
  void keep_contacts(double times, const MeanForce& mean) noexcept;
  void choose_kept(ContactLaw& law, const MeanForce& mean) noexcept;
  void keep(int point, const MeanForce& mean) noexcept;
  void gather(ContactLaw& law) noexcept;
  bool keep_more(ContactLaw& law, const MeanForce& mean) noexcept;
  /// Whether a contact has a force, or could close if forces change by `times` their budgets.
  bool must_keep(int i, double times) const { return has_force_[i] != 0 || screening_.could_close(i, times); }

  std::shared_ptr<const BlockSystem<T>> system_;
  BlockForcing forcing_;
  BlockForce<T> held_;
  ForceChanges<T> changes_;
  BlockMotion<T> motion_;
  PointPrediction<T> prediction_;
  KeptPoints<T> kept_;
  CandidateScreening<T> screening_;
  int taken_, advanced_;         ///< steps that are solved; that the state includes
  std::vector<char> has_force_;  ///< (contacts) at the start of the block, in λ̂ or at the last two instants
  std::vector<int> rows_;        ///< scratch
  Vector largest_change_;        ///< by position: of λ̄ and of λ⁺ from λ̂ in this step
  std::vector<int> changed_;     ///< positions with λ̄ ≠ λ̂ in this step
  std::vector<T> change_;        ///< λ̄ − λ̂ of changed_
  int surplus_ = 0;              ///< blocks in a row that keep more points than they want
  int touching_ = 0;
  double work_ = 0, in_residual_ = 0;
};

}  // namespace ricochet::contact
