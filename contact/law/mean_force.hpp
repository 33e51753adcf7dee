// SPDX-License-Identifier: BSD-2-Clause
// The conserving contact step: the force that drives the modes over a step is a mean of the forces at the
// last three instants.
//
//   λ̄ = a λ⁺ + b λ + c λ⁻,   a = 5/8, b = 1/4, c = 1/8
//   u⁺ = B q⁺(λ̄) + s⁺ − R λ⁺,   0 ≤ λ⁺ ⟂ S λ⁺ − (û − M h − g) ≥ 0,   S = a M + R,   h = b λ + c λ⁻
//
// with M the flexibility of the modes over a step and R the residual flexibility. The mean is the trapezoidal
// rule plus c times the second difference of λ. In a step, contact removes
//
//   λ̄ᵀ(u⁺ − u) + c/2 (|d⁺|² − |d|² + |d⁺ − d|²)_R,   d = λ − λ⁻, d⁺ = λ⁺ − λ.
//
// At a point that stays in contact, u⁺ = u. What remains is a difference that cancels over a run, and a
// positive term of the order of Δ⁴, which damps alternating forces. Without the second difference (c = 0),
// forces of a point may alternate for ever once a shock front has passed.
//
// A point that opens may gain energy. The bank is the energy that contact has removed since the touch began.
// If the last points open and their force h would overdraw the bank, it is reduced to x h, which empties the
// bank:
//
//   x² hᵀMh − x hᵀ(û − u − Rλ) = bank + ½ λᵀRλ.
//
// Any other step that would overdraw the bank is repeated by backward Euler (λ̄ = λ⁺), in which contact cannot
// gain energy. Contact therefore puts no energy into the bodies in any touch, for any Δ, N, m and masses. A
// bank that outlived its touch would let a later one bounce by more than it came with. It becomes a reserve,
// which pays only for what bodies that turn need to stay where they touch (floating_stepper.hpp).
//
// With springs s(λ) of the points (patch_spring.hpp), R λ + s(λ) takes the place of R λ, and the energy e(λ)
// that they store is added to ½ λᵀRλ.
//
// With friction, λ stands for all forces p (λ and τ), and u at the tangential rows for the slip. Energy that
// friction turns into heat does not enter the bank: otherwise, a body that has slid for long could gain any
// amount of energy in the normal direction. A step in which the heat of a slip would fall below 0 is made by
// backward Euler (slip.hpp), so that heat is never returned.
//
// When contact begins with a shock that the modes carry, so that R yields little, the mean overshoots. The
// first two steps are then made by backward Euler, and the history restarts.
//
// All this belongs to an island: bodies that touch, directly or through others. M and R couple only points
// that share a body, so that the terms of different islands separate. Each pair of surfaces keeps the part of
// the bank that its own contact has removed. The bank of an island is the sum over its pairs, so that banks
// add when islands merge. When an island parts, each part has the energy that its own contacts removed, less
// their payments for others.
#pragma once

#include <span>
#include <vector>

#include "contact/model/changed_model.hpp"
#include "contact/model/model.hpp"

namespace ricochet::contact {

struct MeanWeights {
  double end, start, before;  ///< a, b, c
  bool operator==(const MeanWeights&) const = default;
  void archive(auto& a) { a(end, start, before); }
};
inline constexpr MeanWeights conserving_mean{0.625, 0.25, 0.125}, backward_euler{1, 0, 0};

/// The forces at the last two instants, and the state of the last one that the next step needs, for each
/// pair.
class MeanForce {
 public:
  struct Pair {
    MeanWeights weights = backward_euler;  ///< of the last step
    bool carries = false;                  ///< whether it had a force at one of the last two instants
    bool shock = false;                    ///< the step was the first one of a shock
    bool restarts = false;                 ///< the history begins anew with the step
    bool asleep = false;  ///< its bodies rest: its forces stay as they are, whatever others do
    /// What its earlier touches removed, less what the turns of R and points that were pushed out have taken
    /// [J].
    double reserve = 0;
    double bank = 0;  ///< its part of the bank of its island, ≥ 0; 0 unless it carries [J]
    void archive(auto& a) { a(weights, carries, shock, restarts, asleep, reserve, bank); }
  };

  /// State of one pair with n rows. @param conserving  whether steps use the mean, and not backward Euler
  /// throughout
  MeanForce(Eigen::Index rows, bool conserving);
  MeanForce(const Model& model, bool conserving);

  const Vector& end() const { return end_; }        ///< (n) λ at the last instant [N]
  const Vector& before() const { return before_; }  ///< (n) λ one instant earlier [N]
  /// Whether the last two instants had no force, but for pairs that are asleep.
  bool begins() const { return !carries_; }
  bool is_conserving() const { return conserving_; }
  const std::vector<int>& pair_of_row() const { return pair_of_row_; }
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Weights of the mean of the last step, at a row.
  const MeanWeights& weights(Eigen::Index row) const { return pairs_[pair_of_row_[row]].weights; }

  /// Completes a step: λ⁺ (n) becomes the force at the last instant. @param pairs  `carries` is computed
  void advance(const Vector& force, const std::vector<Pair>& pairs) noexcept;
  /// The same if only these rows have or had a force.
  void advance(std::span<const int> rows, const Vector& force, const std::vector<Pair>& pairs) noexcept;
  /// Sets forces at the last instant, by position among some rows, and the state of the pairs.
  void restore(std::span<const int> rows, const Vector& end, const std::vector<Pair>& pairs) noexcept;
  /// Draws energy from the reserve of a pair, and then from its part of the bank. Returns what is missing, 0
  /// if they suffice. A negative energy is paid into the reserve.
  double draw(int pair, double energy) noexcept;
  /// Multiplies the forces of a pair at the last instant by a share of 0 to 1.
  void reduce(int pair, double share) noexcept;
  /// Lets a pair fall asleep, or wakes it.
  void let_sleep(int pair, bool asleep) noexcept;
  /// Forgets the forces and the bank of a pair.
  void forget(int pair) noexcept;
  /// Takes the forces and the state of pairs that a model has in common with an earlier one.
  void take(const MeanForce& earlier, const Correspondence& from);
  /// Forgets all forces.
  void clear() noexcept;

  void archive(auto& a) { a(pairs_, carries_, end_, before_); }

 private:
  /// Consecutive rows of one pair.
  struct Segment {
    int pair;
    Eigen::Index first, size;
  };

  void end_touches() noexcept;

  std::vector<int> pair_of_row_;
  std::vector<Segment> segments_;
  std::vector<Pair> pairs_;
  bool conserving_;
  bool carries_ = false;
  Vector end_, before_;
};

}  // namespace ricochet::contact
