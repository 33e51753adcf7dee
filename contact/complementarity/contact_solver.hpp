// SPDX-License-Identifier: BSD-2-Clause
// The solver of a contact step: complementarity without friction, Coulomb's law with it; and the springs that
// carry the bulges of patches.
#pragma once

#include <algorithm>
#include <span>

#include "contact/complementarity/complementarity.hpp"
#include "contact/complementarity/friction_solver.hpp"
#include "contact/complementarity/spring_newton.hpp"

namespace ricochet::contact {

class ContactSolver {
 public:
  /// @param rows  capacity   @param friction  whether problems may have points with friction
  /// @param springs  whether they may have springs
  ContactSolver(int rows, const SolveOptions& options, bool friction = false, bool springs = false)
      : frictionless_(rows, options),
        friction_(friction ? rows : 0,
                  {.same_matrix = options.same_matrix,
                   .max_iterations = std::min(options.max_pivots, FrictionOptions{}.max_iterations)}),
        newton_(springs ? rows : 0, options) {}

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
  /// With springs, as SpringNewton, which begins from p. Without springs, as above.
  SolveStatus solve(const Symmetric& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    std::span<const PatchSpring> springs, std::span<const FrictionContact> contacts,
                    Eigen::Ref<Eigen::VectorXd> p) noexcept {
    stopped_ = {};
    if (springs.empty()) return solve(S, r, contacts, p);
    const std::int64_t stopped = newton_.stopped();
    const SolveStatus status =
        newton_.solve(S, r, springs, p,
                      [&](const Symmetric& matrix, const Eigen::Ref<const Eigen::VectorXd>& right,
                          bool renewed, Eigen::Ref<Eigen::VectorXd> forces) noexcept {
                        if (renewed) {
                          frictionless_.change_matrix();
                          friction_.change_matrix();
                        }
                        return solve(matrix, right, contacts, forces);
                      });
    if (newton_.stopped() > stopped)
      stopped_ = {.violation = newton_.misfit(), .scale = r.cwiseAbs().maxCoeff(), .work = 0};
    return status;
  }

  void reset() noexcept {
    frictionless_.reset();
    friction_.reset();
    newton_.reset();
  }
  /// The next problem has another matrix with the same contacts.
  void change_matrix() noexcept {
    frictionless_.change_matrix();
    friction_.change_matrix();
    newton_.reset();
  }
  /// Of the last problem.
  const SolveResidual& residual() const {
    if (stopped_.scale > 0) return stopped_;
    return with_friction_ ? friction_.residual() : frictionless_.residual();
  }
  const FrictionSolver& friction() const { return friction_; }
  /// Of the last problem, if it had contacts and no springs; see FrictionSolver.
  bool product(const Eigen::Ref<const Eigen::VectorXd>& p, Eigen::Ref<Eigen::VectorXd> out) noexcept {
    return with_friction_ && friction_.product(p, out);
  }
  /// Whether any problem so far was cut short.
  bool was_limited() const {
    return frictionless_.statistics().limited + friction_.statistics().limited + newton_.stopped() > 0;
  }
  /// Of the linear problems; `limited` includes those in which springs did not converge.
  SolveStatistics statistics() const {
    return frictionless_.statistics() + friction_.statistics() +
           SolveStatistics{.limited = newton_.stopped()};
  }

  void archive(auto& a) { a(frictionless_, friction_, newton_, stopped_, with_friction_); }

 private:
  ComplementaritySolver frictionless_;
  FrictionSolver friction_;
  SpringNewton newton_;
  SolveResidual stopped_;  ///< of springs that did not converge
  bool with_friction_ = false;
};

}  // namespace ricochet::contact
