// SPDX-License-Identifier: BSD-2-Clause
// Contact ahead: a block of steps of the compliant scheme by matrix products.
//
// Over a block of L steps the motion under the last known force λ̄, held on, is known beforehand: one product
// of B with L columns. What a force departs from it in step k adds from then on what the step-integrated
// kernel says,
//
//   u_l = ū_l − Σ_{k ≤ l} S_{l−k} (λ_k − λ̄),   S_d = B (c((d+1)Δ) − c(dΔ)) Bᵀ, c(0) = 0,   and R in S_0,
//
// so far history comes by modes and near history by convolution. Nothing is approximated. Points are left out
// where a bound shows that they can't close: before the product by the energy of the modes, after it by what
// departures of the forces can do to them, Σ_j (max_d |S_d,ij|) Σ_k |λ_kj − λ̄_j|. Each point is given as much
// of that sum as it is expected to need; when it takes more, the bound is made anew, and points for which it
// no longer holds come in.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/stepping/block_system.hpp"

namespace ricochet::contact {

/// What blocks gather of their system for the points they watch, which seldom change. A copy has room for as
/// much, and nothing in it.
template <class T>
class Gathered {
 public:
  explicit Gathered(const BlockSystem<T>& system);
  Gathered(const Gathered& other);
  Gathered& operator=(const Gathered& other);
  Gathered(Gathered&&) noexcept = default;
  Gathered& operator=(Gathered&&) noexcept = default;
  ~Gathered() = default;

  bool holds() const { return holds_; }
  void take(const BlockSystem<T>& system, std::span<const int> points) noexcept;
  /// Of a point that pushes: makes sure of its lags.
  void need(const BlockSystem<T>& system, int position) noexcept;

  std::size_t width = 0;     ///< padded number of points
  Eigen::MatrixXd S, R;      ///< (points, points) S_0, R
  std::unique_ptr<T[]> lag;  ///< (points, L, width) S_d

 private:
  std::size_t room_;  ///< of lag
  bool holds_ = false;
  std::vector<int> points_;
  std::vector<char> has_lags_;  ///< by position
};

template <class T>
class LookAheadBlock {
 public:
  /// `driven`: loads or supports vary. Allocates; nothing below does.
  LookAheadBlock(std::shared_ptr<const BlockSystem<T>> system, bool forced);

  /// What drives add to q, q̇ (N) in step l = 1…L of the block to start, and s (m) at its end; s at its start
  /// is that of l = 0. To be told of all before `start`.
  void set_forcing(int l, const Vector& q, const Vector& v, const Vector& s) noexcept;

  /// Starts a block from q, q̇ (N) under the force λ (m) of the step before.
  void start(const Vector& q, const Vector& v, const Vector& force) noexcept;

  /// Solves the next step; `force` (m) out. A step that fails changes nothing. Once the solver has cut a step
  /// short, points beyond their gap are let stay where they are, not pushed back.
  SolveStatus step(ComplementaritySolver& solver, Vector& force) noexcept;

  /// Forgets the block: the next one starts from the state that the last step failed to leave.
  void take_back() noexcept;

  /// Moves the state through the steps taken since it was moved last. Not for drives.
  /// @param keep_rates  q̇ after each of them is for rate()
  simd::Sums advance(bool keep_rates) noexcept;
  void copy_state(Vector& q, Vector& v) const noexcept;
  /// (N) q̇ after step l = 1…L.
  const double* rate(int l) const { return &rates_[static_cast<std::size_t>(l - 1) * system_->modes]; }

  int length() const { return system_->length; }
  int taken() const { return taken_; }
  int advanced() const { return advanced_; }
  bool over() const { return taken_ == system_->length; }
  int pushing() const { return pushing_; }     ///< points with λ > 0 in the last step
  double work() const { return work_; }        ///< λᵀ (u_l − u_{l−1}) of the last step [J]
  double energy_in_residual() const noexcept;  ///< ½ λᵀ R λ of the last step
  /// Points that the last step watched, of all.
  int watched() const { return static_cast<int>(watched_.size()); }

 private:
  /// Of a point that is watched, after step l = 1…L.
  double& u(std::size_t position, int l) {
    return u_[static_cast<std::size_t>(l - 1) * system_->width + position];
  }
  double at_start(int point) const noexcept;
  void hold(const Vector& force) noexcept;
  void expect() noexcept;
  void combine(const std::vector<T>& rows, std::span<const int> of) noexcept;
  void predict_rigid() noexcept;
  void bound_by_energy() noexcept;
  void predict(std::span<const int> rows) noexcept;
  void predict_what_matters(double times) noexcept;
  void choose_watched() noexcept;
  void watch(int point) noexcept;
  void gather() noexcept;
  bool raise_budgets() noexcept;
  bool see_more() noexcept;
  void advance_rigid(bool keep_rates, simd::Sums& sums) noexcept;
  /// Whether a point pushes, or could when forces change by this many times what is expected.
  bool matters(int i, double times) const { return held_force_(i) > 0 || !(margin_(i) > times * could_(i)); }
  simd::Modes modes() const;

  std::shared_ptr<const BlockSystem<T>> system_;
  Gathered<T> near_;
  bool forced_;
  int taken_, advanced_;
  // of this block
  std::vector<double> q_, v_, load_, held_;  ///< (modes) load_: less held_, which is Bᵀλ̄
  std::vector<double> rigid_q_, rigid_v_, rigid_held_;
  std::vector<double> forcing_;         ///< (L, 2, modes) what drives add to q and q̇
  Matrix s_;                            ///< (1, m), driven: (L + 1, m)
  std::vector<T> x_;                    ///< (L, modes)
  std::vector<double> rates_;           ///< (L, modes)
  Matrix rigid_motion_;                 ///< (L, rigid)
  Vector rigid_at_;                     ///< (L) u of a point by rigid motion
  std::vector<double> ahead_;           ///< (L, width) ū of points that were predicted
  std::vector<double> u_;               ///< (L, width) u of watched points, by position
  std::vector<T> changes_;              ///< (points, L) λ − λ̄
  Vector held_force_, margin_, could_;  ///< (points) λ̄; g − ū at least; what changes could add to u
  Vector spent_, budget_;               ///< (points) Σ |λ − λ̄| in this block; what could_ counts with
  Vector held_rest_;                    ///< (points) R λ̄
  Vector held_push_, rhs_, solution_;   ///< (points) by position: S_0 λ̄; of the step
  Vector ended_;                        ///< (points) u at the end of the block before
  std::vector<char> was_watched_, is_predicted_, has_changed_;     ///< (points)
  std::vector<int> position_;                                      ///< (points) among watched_, or −1
  std::vector<int> gathered_;                                      ///< the points of near_
  std::vector<int> pressed_, predicted_, watched_, have_changed_;  ///< λ̄ > 0; …; λ ≠ λ̄ in this block
  std::vector<int> changed_, raised_;     ///< positions of λ ≠ λ̄ in this step; points
  std::vector<T> change_, factor_, sum_;  ///< of changed_; (points) and (padded) scratch
  bool is_new_problem_ = true;            ///< near_.S changed: the solver's active set is another's
  int pushing_ = 0;
  double work_ = 0;
};

extern template class LookAheadBlock<double>;
extern template class LookAheadBlock<float>;

}  // namespace ricochet::contact
