// SPDX-License-Identifier: BSD-2-Clause
// The impulses at one instant on the points that touch, that is, have u ≥ g to round-off:
//
//   0 ≤ P ⟂ A P − (1 + e) v̂ ≥ 0
//
// R plays no part, because an impulse has no static response. If there are more points than modes, P is not
// unique, and the P of least norm is computed.
#pragma once

#include <memory>
#include <vector>

#include "contact/complementarity/contact_solver.hpp"
#include "contact/stepping/modal_state.hpp"

namespace ricochet::contact {

/// Points closer than this to their gap count as touching. This is the round-off of u_i, a sum over modes.
/// @param size  |q|   @param s  static displacement of point i
double touching_margin(const StepSystem& system, Eigen::Index i, double size, double s) noexcept;

class ImpulseProblem {
 public:
  ImpulseProblem(const ModalState& state, const StepOptions& options);

  /// Solves for P (m) [N s] at the end of the interval state.now, where the displacement is u (m).
  SolveStatus solve(ModalState& state, const Vector& u, ContactSolver& solver, Vector& impulse) noexcept;

  /// Points that touched in the last problem, ascending.
  const std::vector<int>& touching() const { return touching_; }

  void archive(auto& a) { a(next_, touching_); }

 private:
  StepOptions options_;
  ForcedResponse::Interval next_;             ///< the next step, for "difference"
  Vector rhs_, solution_;                     ///< (m) of the touching points
  std::shared_ptr<const Eigen::MatrixXd> A_;  ///< (m,m)
  ReservedMatrix sub_;                        ///< A of the touching points
  std::vector<int> touching_;
};

}  // namespace ricochet::contact
