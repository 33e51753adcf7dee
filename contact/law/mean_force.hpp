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
// A point that opens may gain energy. The bank is the energy that contact has removed so far. If the last
// points open and their force h would overdraw the bank, it is reduced to x h, which empties the bank:
//
//   x² hᵀMh − x hᵀ(û − u − Rλ) = bank + ½ λᵀRλ.
//
// Any other step that would overdraw the bank is repeated by backward Euler (λ̄ = λ⁺), in which contact cannot
// gain energy. Contact has therefore never put energy into the bodies, for any Δ, N, m and masses.
//
// With springs s(λ) of the points (patch_spring.hpp), R λ + s(λ) takes the place of R λ, and the energy e(λ)
// that they store is added to ½ λᵀRλ.
//
// With friction, λ stands for all forces p (λ and τ), and u at the tangential rows for the slip. Energy that
// friction turns into heat enters the bank too, and a step in which the heat of a slip would fall below 0 is
// made by backward Euler (slip.hpp).
//
// When contact begins with a shock that the modes carry, so that R yields little, the mean overshoots. The
// first two steps are then made by backward Euler, and the history restarts.
#pragma once

#include "contact/complementarity/complementarity.hpp"
#include "contact/model/model.hpp"

namespace ricochet::contact {

struct MeanWeights {
  double end, start, before;  ///< a, b, c
  bool operator==(const MeanWeights&) const = default;
};
inline constexpr MeanWeights conserving_mean{0.625, 0.25, 0.125}, backward_euler{1, 0, 0};

class MeanForce {
 public:
  /// @param conserving  whether steps use the mean; otherwise all use backward Euler
  MeanForce(Eigen::Index points, bool conserving);

  /// A solved step that is not accepted yet.
  struct Trial {
    SolveStatus status = SolveStatus::solved;
    bool opens = false;      ///< whether λ⁺ is 0
    bool cools = false;      ///< whether the heat of a slip falls below 0
    bool several = false;    ///< whether the forces are known not to be the only solution
    double removed = 0;      ///< energy that contact and friction remove [J]
    double heat = 0;         ///< of friction: part of `removed` [J]
    double belts = 0;        ///< τ̄ᵀ × displacement of moving half-spaces [J]
    double in_residual = 0;  ///< twice the energy in the residual, λ⁺ᵀRλ⁺ + 2 e⁺ [J]
    double in_modes = 0;     ///< λ̄ᵀMλ̄ [J]; needed only if contact begins or opens
  };

  const Vector& end() const { return end_; }                   ///< (m) λ at the last instant [N]
  const Vector& before() const { return before_; }             ///< (m) λ one instant earlier [N]
  bool begins() const { return !carries_; }                    ///< whether the last two instants had no force
  const MeanWeights& weights() const { return now_.weights; }  ///< of the last step
  bool is_conserving() const { return conserving_; }

  /// Solves a step. `attempt(weights)` solves it with a mean and returns a Trial; the last attempt counts.
  template <class Attempt>
  Trial solve(Attempt&& attempt) noexcept {
    const bool mean = conserving_ && !now_.shock;
    next_ = {.weights = mean ? conserving_mean : backward_euler, .restarts = now_.shock, .bank = now_.bank};
    Trial trial = attempt(next_.weights);
    if (mean && usable(trial.status)) {
      next_.shock = next_.restarts = begins() && is_shock(trial);
      if (trial.opens && overdraws(trial)) trial = attempt(next_.weights = reduced(trial));
      if (next_.shock || trial.cools || overdraws(trial)) trial = attempt(next_.weights = backward_euler);
    }
    next_.bank += trial.removed;
    next_.in_residual = trial.in_residual;
    return trial;
  }

  /// Completes the step that was solved: λ⁺ (m) becomes the force at the last instant.
  void advance(const Vector& force) noexcept;

 private:
  /// Largest ratio of the yields of R and of the modes at which R yields little. In an elastic bar whose
  /// modes are resolved up to half the rate, the ratio is 0.26 at any Δ: ∫ 1/x² dx over x > π divided by
  /// ∫ (1 − cos x)/x² dx over x < π. In solids, the near field of the patches makes R dominate.
  static constexpr double shock_share = 0.5;

  static bool usable(SolveStatus status) noexcept {
    return status == SolveStatus::solved || status == SolveStatus::limited;
  }

  bool overdraws(const Trial& trial) const noexcept { return now_.bank + trial.removed < 0; }
  static bool is_shock(const Trial& trial) noexcept;
  MeanWeights reduced(const Trial& opening) const noexcept;

  struct Progress {
    MeanWeights weights = backward_euler;
    bool shock = false;      ///< the step was the first one of a shock
    bool restarts = false;   ///< the history begins anew with the step
    double bank = 0;         ///< [J]
    double in_residual = 0;  ///< λᵀRλ + 2 e [J]
  };
  bool conserving_;
  bool carries_ = false;  ///< whether end_ or before_ differs from 0
  Progress now_, next_;   ///< after the last step; after the step being solved
  Vector end_, before_;
};

}  // namespace ricochet::contact
