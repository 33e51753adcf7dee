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
#include "contact/stepping/block_system.hpp"
#include "contact/stepping/candidate_screening.hpp"
#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/gathered_system.hpp"

namespace ricochet::contact {

template <class T>
class LookAheadBlock {
 public:
  /// @param forcing  whether there are loads with histories or moving supports
  /// Allocates all memory; the other functions allocate nothing.
  LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forcing);

  /// Sets the forcing of the block that `start` begins, from piece.at or later to `end` [s]. Returns whether
  /// the block is forced; set_response must then be called for all steps before `start`.
  bool set_forcing(const ForcedResponse::Piece& piece, double end) noexcept;
  /// Sets the response of q, q̇ (N) to the forcing in step l = 1…L, and s (n) at the end of that step.
  void set_response(int l, const Vector& q, const Vector& v, const Vector& s) noexcept;

  /// Starts a block from q, q̇ (N) under the mean force λ̂ (m) of the previous step, after `set_forcing`.
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
  Eigen::Map<const Vector> q() const { return {q_.data(), constant_.size()}; }
  void copy_state(Vector& q, Vector& v) const noexcept;
  /// (N) q̇ after step l = 1…L.
  const double* rate(int l) const { return &rates_[(l - 1) * system_->modes]; }

  int length() const { return system_->length; }
  int advanced() const { return advanced_; }
  bool over() const { return taken_ == system_->length; }
  int touching() const { return touching_; }  ///< number of points with λ > 0 at the end of the last step
  double work() const { return work_; }       ///< λ̄ᵀ (u_l − u_{l−1}) of the last step [J]
  /// ½ λᵀ R λ and the energy of springs after the last step [J].
  double energy_in_residual() const noexcept { return in_residual_; }
  /// Number of points that screening kept in the last step.
  int kept() const { return static_cast<int>(kept_.size()); }

 private:
  /// u of a kept point after step l = 1…L.
  double& u(std::size_t position, int l) { return u_[(l - 1) * system_->width + position]; }
  double at_start(int point, const MeanForce& mean) const noexcept;
  /// u of a kept point before the current step.
  double before(Eigen::Index position, const MeanForce& mean) noexcept {
    return taken_ > 0 ? u(static_cast<std::size_t>(position), taken_) : at_start(kept_[position], mean);
  }
  void hold(const Vector& force) noexcept;
  void predict_rigid() noexcept;
  void predict(std::span<const int> rows) noexcept;
  void predict_kept(double times) noexcept;
  void keep_contacts(double times, const MeanForce& mean) noexcept;
  void choose_kept(ContactLaw& law, const MeanForce& mean) noexcept;
  void keep(int point, const MeanForce& mean) noexcept;
  void gather(ContactLaw& law) noexcept;
  bool keep_more(ContactLaw& law, const MeanForce& mean) noexcept;
  void advance_rigid(bool keep_rates, simd::Sums& sums) noexcept;
  /// Whether a contact has a force, or could close if forces change by `times` their budgets.
  bool must_keep(int i, double times) const { return has_force_[i] != 0 || screening_.could_close(i, times); }
  simd::Modes modes() const;

  std::shared_ptr<const BlockSystem<T>> system_;
  GatheredSystem<T> near_;
  CandidateScreening<T> screening_;
  bool forced_ = false;    ///< whether forcing_ acts in this block
  bool has_knot_ = false;  ///< whether a history has a knot in this block
  int taken_, advanced_;
  // State of this block
  std::vector<double> q_, v_, load_, held_;  ///< (modes) held_: Bᵀλ̂; load_: constant_ minus held_
  std::vector<double> rigid_q_, rigid_v_, rigid_held_;
  Vector constant_;                                  ///< (N) constant modal force; forced: of gravity alone
  Vector highest_rest_;                              ///< (n) bound on u with elastic modes at rest
  Vector rest_q_, rest_v_;                           ///< (N) forced: of the rest position under loads
  std::vector<double> y_, rate_;                     ///< (modes) forced: q and q̇ about it
  std::vector<double> forcing_;                      ///< (L, 2, modes) response of q and q̇ to the forcing
  Matrix s_;                                         ///< (1, n); with forcing (L + 1, n)
  std::vector<T> x_;                                 ///< (L, modes)
  std::vector<double> rates_;                        ///< (L, modes)
  Matrix rigid_motion_;                              ///< (L, rigid)
  Vector rigid_at_;                                  ///< (L) u of a point by rigid motion
  std::vector<double> predicted_u_;                  ///< (L, width) ū of predicted points
  std::vector<double> u_;                            ///< (L, width) u of kept points, by position
  std::vector<T> changes_;                           ///< (points, L) λ̄ − λ̂
  Vector held_force_;                                ///< (points) λ̂
  Vector held_rest_;                                 ///< (points) R λ̂
  Vector held_push_, held_at_, step_change_, rest_;  ///< by position: S λ̂, R λ̂, change of force, R (λ⁺ − λ̂)
  Vector ended_;                                     ///< (points) u at the end of the previous block
  std::vector<char> was_kept_, is_predicted_, has_changed_;  ///< (points)
  std::vector<char> has_force_;  ///< (contacts) at the start of the block, in λ̂ or at the last two instants
  std::vector<int> position_;    ///< (points) position in kept_, or −1
  std::vector<int> gathered_;    ///< the points of near_
  std::vector<int> pressed_, predicted_, kept_, have_changed_;  ///< λ̂ > 0; …; λ̄ ≠ λ̂ in this block
  std::vector<int> places_;                                     ///< of pressed_ in the matrices
  std::vector<int> changed_;                                    ///< positions with λ̄ ≠ λ̂ in this step
  std::vector<T> change_, factor_, sum_;  ///< λ̄ − λ̂ of changed_; scratch, (points) and (padded)
  int touching_ = 0;
  double work_ = 0, in_residual_ = 0;
};

}  // namespace ricochet::contact
