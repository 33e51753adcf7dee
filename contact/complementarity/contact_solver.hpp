// SPDX-License-Identifier: BSD-2-Clause
// The solver of a contact step: complementarity without friction, Coulomb's law with it.
#pragma once

#include <algorithm>
#include <span>

#include "contact/complementarity/complementarity.hpp"
#include "contact/complementarity/friction_solver.hpp"

namespace ricochet::contact {

class ContactSolver {
 public:
  /// @param rows  capacity   @param friction  whether problems may have points with friction
  ContactSolver(int rows, const SolveOptions& options, bool friction = false,
                FrictionLaw law = FrictionLaw::coulomb)
      : frictionless_(rows, options),
        friction_(friction ? rows : 0,
                  {.law = law,
                   .same_matrix = options.same_matrix,
                   .max_iterations = std::min(options.max_pivots, FrictionOptions{}.max_iterations)}) {}

  /// Without friction, as ComplementaritySolver.
  SolveStatus solve(const Symmetric& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    Eigen::Ref<Eigen::VectorXd> lambda) noexcept {
    with_friction_ = false;
    return frictionless_.solve(S, r, lambda);
  }
  /// As FrictionSolver, which begins from p. Without contacts, p is only set.
  SolveStatus solve(const Symmetric& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    std::span<const FrictionContact> contacts, Eigen::Ref<Eigen::VectorXd> p) noexcept {
    if (contacts.empty()) return solve(S, r, p);
    with_friction_ = true;
    return friction_.solve(S, r, contacts, p);
  }

  void reset() noexcept {
    frictionless_.reset();
    friction_.reset();
  }
  /// Of the last problem.
  const SolveResidual& residual() const {
    return with_friction_ ? friction_.residual() : frictionless_.residual();
  }
  const FrictionSolver& friction() const { return friction_; }
  SolveStatistics statistics() const { return frictionless_.statistics() + friction_.statistics(); }

 private:
  ComplementaritySolver frictionless_;
  FrictionSolver friction_;
  bool with_friction_ = false;
};

}  // namespace ricochet::contact
