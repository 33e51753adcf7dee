// SPDX-License-Identifier: BSD-2-Clause
// The slip of points with friction, from step to step.
//
//   d = w⁺ − w − belt   slip of a step: tangential displacement of a relative to b [m]; belt is the motion of
//                       a half-space along its surface
//   τ̄ᵀ d                heat of the step [J]
//   μ(v)                coefficient in the step, with v = |d|/Δ of the step before; for a point that was
//   open,
//                       d is the slip of this step if no force acted
//
// With the force at the end of the step, the heat of each step is ≥ 0. With a mean force, a point whose slip
// turns may give some back. The heat of a slip, summed from its begin, may not fall below 0: a step in which
// it would is repeated by backward Euler.
#pragma once

#include <span>
#include <vector>

#include "contact/complementarity/friction_solver.hpp"
#include "contact/model/changed_model.hpp"
#include "contact/model/model.hpp"

namespace ricochet::contact {

class Slip {
 public:
  Slip() = default;
  /// @param points  f with friction   @param rows  n   @param step  Δ [s]
  Slip(Eigen::Index points, Eigen::Index rows, double step);

  bool any() const { return speed_.size() > 0; }  ///< whether there are points with friction

  /// Starts step k: computes the motion of half-spaces from t_{k−1} to t_k, and takes all points as open
  /// until they are recorded.
  void begin(std::span<const Model::Belt> belts, std::int64_t k) noexcept;
  /// (n) motion of half-spaces in this step along the rows [m]
  const Vector& belt() const { return belt_; }

  /// μ of friction point f. @param free_slip  |d| if no force acted [m]  @param closed  λ > 0 before the step
  double coefficient(const Friction& law, Eigen::Index f, bool closed, double free_slip) const noexcept;

  /// Takes all points as open in the step that is solved next.
  void begin_trial() noexcept;
  /// Records the slip d (2) of point f under the mean force τ̄ (2), in place of an earlier record.
  /// Returns its heat [J].
  double record(Eigen::Index f, ContactState state, const double* mean, const double* slip) noexcept;
  /// Whether the record brings the heat of the slip of point f below 0.
  bool cools(Eigen::Index f) const { return next_heat_(f) < 0; }
  /// Completes the step as recorded last.
  void accept() noexcept;
  /// Keeps the state of a point that is at rest, without a record in each step.
  void let_sleep(Eigen::Index f) noexcept;
  /// Needs a record of the point in each step again.
  void wake(Eigen::Index f) noexcept;
  /// A point open.
  void forget(Eigen::Index f) noexcept;
  /// Takes the slips of points that a model has in common with an earlier one.
  void take(const Slip& earlier, const Correspondence& from);
  /// All points open.
  void clear() noexcept;

  double speed(Eigen::Index f) const { return speed_(f); }         ///< |d|/Δ of a closed point [m/s]
  std::span<const ContactState> states() const { return state_; }  ///< (f) at the end of the last step

  void archive(auto& a) {
    a(belt_, speed_, heat_, next_speed_, next_heat_, state_, next_state_, list_, next_list_, is_next_listed_);
  }

 private:
  double step_ = 0;
  Vector belt_;                    ///< (n)
  Vector speed_, heat_;            ///< (f) of the last step; of the slip so far [J]
  Vector next_speed_, next_heat_;  ///< (f) of the trial
  std::vector<ContactState> state_, next_state_;
  /// Points that may not be open; the records of others are 0.
  struct List {
    std::vector<int> point;  ///< (f), the first `count` of them
    std::size_t count = 0;
    void archive(auto& a) { a(point, count); }
  };
  List list_, next_list_;
  std::vector<char> is_next_listed_;  ///< (f)
};

}  // namespace ricochet::contact
