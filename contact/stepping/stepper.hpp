// SPDX-License-Identifier: BSD-2-Clause
// A scheme that advances contact in time. `step` neither throws nor allocates.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "contact/law/contact_law.hpp"
#include "contact/motion/turning.hpp"
#include "contact/stepping/modal_state.hpp"
#include "ricochet/step_options.hpp"
#include "ricochet/step_status.hpp"

namespace ricochet::base {
class Archive;
}

namespace ricochet::contact {

class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Advances from t_{k−1} to t_k, or in free flight to the next output sample. A step that fails changes
  /// nothing; if the state of a look-ahead block turns out not to be finite, all pending steps fail together.
  virtual StepStatus step() noexcept = 0;

  virtual std::unique_ptr<Stepper> clone() const = 0;
  /// Takes the state of a clone, without allocating.
  virtual void assign(const Stepper& clone) noexcept = 0;

  const StepOptions& options() const { return options_; }
  std::int64_t steps() const { return steps_; }  ///< contact steps Δ since t = 0
  /// Whether the last step ended at an output sample.
  bool at_sample() const { return steps_ % options_.steps_per_sample == 0; }
  double time() const { return static_cast<double>(steps_) * options_.step; }

  Eigen::Index points() const { return points_; }  ///< m: the first rows, which are the normal ones
  /// (n) λ̄_k and τ̄_k [N], the mean over (t_{k−1}, t_k] that drives the modes; impulses as P/Δ
  const Vector& force() const { return contact_.force; }
  /// (n) λ_k and τ_k [N] at t_k, to which the residual responds; 0 for impulses
  const Vector& end_force() const { return contact_.mean.end(); }
  /// Weights of the mean λ̄_k at a row.
  const MeanWeights& weights(Eigen::Index row) const { return contact_.mean.weights(row); }
  /// (n) u at t_k, including the residual [m]; while steps are pending, u at the last known state.
  virtual const Vector& displacement() const noexcept { return u_; }
  int active() const { return contact_.active; }  ///< points in contact at t_k
  /// Power through the contact, σ_n u̇_n of equation (16) in the source paper, as the mean over the step [W]:
  /// compliant −λ̄ᵀ(u_k − u_{k−1})/Δ; impulse −Pᵀ(u̇⁻ + u̇⁺)/(2Δ), the velocities just before and after the
  /// impulses.
  double persistency() const { return contact_.persistency; }
  const Slip& slip() const { return contact_.slip; }  ///< of the points with friction, in the last step
  /// Steps whose forces are known not to be the only solution (Painlevé).
  std::int64_t ambiguous_steps() const { return contact_.ambiguous; }
  SolveStatistics solver() const noexcept;
  /// Violation of complementarity by the forces of the last step; 0 unless max_pivots cut the step short.
  /// compliant: u beyond its bound [m]; impulse: remaining approach (1 + e) v̂ − A P [m/s].
  const SolveResidual& residual() const { return contact_.residual; }

  /// Motion and energy of the bodies; null if only the motion of the contact points is known (tables).
  virtual const ModalState* modal() const noexcept { return nullptr; }
  /// The bodies after the step, with finite rotations; otherwise null, and rigid modes move the bodies.
  virtual const Turning* turning() const noexcept { return nullptr; }
  std::span<const Pose> poses() const noexcept {
    return turning() ? std::span<const Pose>(turning()->poses) : std::span<const Pose>();
  }
  /// Sets a force [N] and a torque about the centre of mass [N m] on a body, world axes, which then act until
  /// they are set again. Returns false unless rotations are finite.
  virtual bool push(int /*body*/, const Eigen::Vector3d& /*force*/,
                    const Eigen::Vector3d& /*torque*/) noexcept {
    return false;
  }
  /// Sets a force [N] at a point of a body, world axes, which then acts until it is set again. Returns false
  /// and changes nothing if the point cannot be pushed so (point_forces.hpp), or without modes. Must not be
  /// called while steps are pending.
  virtual bool push_at(int /*body*/, const BodyPlace& /*place*/, const Eigen::Vector3d& /*force*/) noexcept {
    return false;
  }
  /// Writes or reads all that steps change, and that later steps depend on to the last bit. Reads only what a
  /// stepper of an equal model with equal options has written. Steppers of tables have no bytes.
  virtual void archive(base::Archive& a);

  /// (3,bodies) mass-mean velocities of a table's bodies after the step [m/s]; null with modes.
  virtual const Eigen::Matrix3Xd* body_velocities() const noexcept { return nullptr; }

  // Schemes that step in look-ahead blocks may know the state only after the last step of a block.
  /// Sets options.every_state from the next step on. With `rates`, q̇ after each step is recorded for rate().
  virtual void keep(bool /*every_state*/, bool /*rates*/) noexcept {}
  /// Number of steps whose state is not known yet.
  virtual int pending() const noexcept { return 0; }
  /// Advances the state to the last step. Fails as `step` does.
  virtual StepStatus catch_up() noexcept { return StepStatus::ok; }
  /// (N) q̇, `back` steps before the last one, within the steps through which the state was last advanced.
  virtual const double* rate(int /*back*/) const noexcept { return modal()->v.data(); }

 protected:
  /// Contact in one step.
  struct Contact {
    MeanForce mean;
    Vector force{};
    int active = 0;
    double persistency = 0;
    SolveResidual residual{};
    Slip slip{};
    std::int64_t ambiguous = 0;

    void archive(auto& a) { a(mean, force, active, persistency, residual, slip, ambiguous); }
  };

  /// For points without friction. @param conserving  whether steps are conserving
  Stepper(const StepOptions& options, Eigen::Index points, const SolveOptions& solver, bool conserving);
  /// For compliant steps of a folded model.
  Stepper(const StepOptions& options, const Model& model);
  Stepper(const Stepper&) = default;
  Stepper& operator=(const Stepper&) = default;

  static StepStatus failure(SolveStatus status) noexcept {
    return status == SolveStatus::not_finite ? StepStatus::not_finite : StepStatus::no_solution;
  }

  /// What contact and friction do in a step, for the ledger. @param residual  ½ λᵀRλ and springs before it
  /// [J]
  static Work work_of(const StepTrial& trial, double residual) noexcept {
    return {.contact = trial.removed + trial.belts + trial.in_residual - residual,
            .friction = trial.heat,
            .belts = trial.belts};
  }

  /// Writes or reads the members below.
  void archive_contact(base::Archive& a);
  /// Ends a free flight over `steps` contact steps.
  void land(int steps) noexcept;
  /// Ends the current step with next_force_, next_end_ and next_u_.
  StepStatus complete(int active, double persistency, const SolveResidual& residual) noexcept;
  /// Ends the contact of a step with next_force_ and next_end_.
  void end_contact(int active, double persistency, const SolveResidual& residual) noexcept;

  StepOptions options_;
  Eigen::Index points_;  ///< m
  ContactLaw law_;       ///< of impulses: its solver alone
  std::int64_t steps_ = 0;
  Contact contact_;
  mutable Vector u_;                       ///< (n); a scheme may compute it on demand
  Vector next_force_, next_end_, next_u_;  ///< (n) of the current step: p̄, p⁺ and u⁺
};

/// Where the rows of the model act now.
inline const RowFrames& frames_of(const Model& model, const Stepper& stepper) {
  return stepper.turning() ? stepper.turning()->frames : model;
}

/// Returns the stepper of the scheme in `options`, and folds the model (folding.hpp). Outputs must see the
/// folded model, too. Throws InputError for `impulse` with "difference" and ω_max Δ ≥ π, for a restitution
/// outside [0, 1], and for max_pivots below 1.
std::unique_ptr<Stepper> make_stepper(std::shared_ptr<const Model> model, const StepOptions& options);
/// Of a copy of the model.
std::unique_ptr<Stepper> make_stepper(const Model& model, const StepOptions& options);

}  // namespace ricochet::contact
