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
// all departures of the block together can do to them. The latter is checked after each step, and points for
// which it no longer holds come in.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "contact/complementarity.hpp"
#include "contact/model.hpp"
#include "contact/simd.hpp"

namespace ricochet::contact {

/// Constant data of a modal system under constant loads, after modes were moved into R: all coefficients of
/// these are 0.
struct StepSystem {
  Vector omega, decay;                 ///< (N)
  Vector stiffness, load, b, c, e, h;  ///< (N) of a step, as in propagator.hpp
  Matrix B;                            ///< (m,N)
  Vector s, gap;                       ///< (m)
  Eigen::MatrixXd R, S;                ///< (m,m) residual flexibility; S_0
  std::vector<int> dropped;            ///< modes moved into R: all their coefficients are 0
};

template <class T>
class Block {
 public:
  /// @param steps  L ≥ 1 @param step  Δ [s]. Allocates; nothing below does.
  Block(std::shared_ptr<const StepSystem> system, int steps, double step);

  /// Starts a block from q, q̇ (N) under the force λ (m) of the step before.
  void start(const Vector& q, const Vector& v, const Vector& force) noexcept;

  /// Solves the next step; `force` (m) out. A step that fails changes nothing. Once the solver has cut a step
  /// short, points beyond their gap are let stay where they are, not pushed back.
  SolveStatus step(ComplementaritySolver& solver, Vector& force) noexcept;

  /// Forgets the block: the next one starts from the state that the last step failed to leave.
  void take_back() noexcept;

  /// q, q̇ (N) under the forces of the steps taken so far.
  void advance(Vector& q, Vector& v) noexcept;

  int length() const { return length_; }
  int taken() const { return taken_; }
  bool over() const { return taken_ == length_; }
  const Vector& held_force() const { return held_force_; }  ///< (m) λ̄
  /// Points with λ > 0 in the last step.
  std::span<const int> pushing() const { return pushing_; }
  /// u_i at the end of the last step, and `before` it, of a point that pushes [m].
  double displacement(int i) const { return u_[at(i, taken_)]; }
  double before(int i) const noexcept { return taken_ > 1 ? u_[at(i, taken_ - 1)] : at_start(i); }
  /// Points that the last step watched, of all.
  int watched() const { return static_cast<int>(watched_.size()); }

 private:
  /// Of u_: a point after step l = 1…L.
  std::size_t at(int point, int l) const {
    return static_cast<std::size_t>(point) * stride_ + static_cast<std::size_t>(l - 1);
  }
  double at_start(int point) const noexcept;
  void hold(const Vector& force) noexcept;
  void predict_rigid(const Vector& q, const Vector& v) noexcept;
  void bound_by_energy(const Vector& q, const Vector& v) noexcept;
  void predict(std::span<const int> rows) noexcept;
  void choose_watched() noexcept;
  void watch(int point) noexcept;
  void find_allowed() noexcept;
  void gather() noexcept;
  /// Whether a point pushes, or could when forces of the block change by this sum [N].
  bool matters(int i, double change) const {
    return held_force_(i) > 0 || !(margin_(i) > change * influence_(i));
  }
  simd::Modes modes() const {
    return {modes_, stiffness_.data(), load_.data(), b_.data(), c_.data(), e_.data(), h_.data()};
  }

  std::shared_ptr<const StepSystem> system_;
  const simd::Loops<T>* loops_;
  int length_, points_, taken_;
  std::size_t modes_, lags_, stride_;  ///< padded: of modes, of lags; row length of u_
  // constant
  std::vector<double> stiffness_, load_, b_, c_, e_, h_;  ///< (modes_)
  std::vector<T> B_;                                      ///< (points, modes_), rigid modes 0
  std::vector<T> lag_;                                    ///< (points, points, lags_) S_d
  std::vector<int> rigid_;                                ///< modes with ω = 0
  std::vector<std::vector<int>> band_;                    ///< elastic modes of a band of frequency
  Eigen::MatrixXd reach_;                                 ///< (points, bands) (Σ B²/ω²)^½ of a band
  Vector softness_;                                       ///< (N) 1/ω² of elastic modes
  Vector rest_, influence_;      ///< (points) s + Σ B f/ω² of elastic modes; largest |S_d,ij|
  Eigen::MatrixXd flexibility_;  ///< (points, points) R + Σ B Bᵀ/ω² of elastic modes
  // of this block; load_ has λ̄ in it
  Vector held_force_;              ///< (points) λ̄
  Vector held_rest_, held_push_;   ///< (points) rest_ under λ̄; S_0 λ̄ of watched ones
  std::vector<double> q_, v_;      ///< (modes_)
  std::vector<T> x_, push_;        ///< (L, modes_)
  Vector energy_;                  ///< (N) twice that of a mode about its rest
  Vector rigid_motion_;            ///< (L) of one mode
  std::vector<double> u_;          ///< (points, stride_), see at()
  std::vector<T> changes_;         ///< (points, lags_) λ − λ̄
  std::vector<T> sum_;             ///< (points, lags_) scratch
  Vector amplitude_, margin_;      ///< (bands); (points) g − ū at least
  Vector ended_;                   ///< (points) u at the end of the block before, of those it watched
  std::vector<char> was_watched_;  ///< (points)
  std::vector<char> is_predicted_, is_watched_, has_changed_;  ///< (points)
  std::vector<int> held_, predicted_, watched_, gathered_;     ///< gathered: the points of S_
  std::vector<int> have_changed_, pushing_, changed_;  ///< λ ≠ λ̄ in the block; λ > 0, λ ≠ λ̄ in the last step
  std::vector<T> change_;                              ///< of changed_
  double total_ = 0, last_total_ = 0,
         allowed_ = 0;          ///< Σ |λ − λ̄| of this block, the last; what the others bear
  Eigen::MatrixXd S_;           ///< (watched, watched)
  bool is_new_problem_ = true;  ///< S_ changed: the solver's active set is another's
  Vector rhs_, solution_;
};

extern template class Block<double>;
extern template class Block<float>;

}  // namespace ricochet::contact
