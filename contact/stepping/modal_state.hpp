// SPDX-License-Identifier: BSD-2-Clause
// Modal coordinates of all bodies with their energy ledger, and their exact motion over one step.
//
// The current step ends in next_q, next_v; the state before it changes only when `commit` succeeds.
#pragma once

#include <memory>

#include "contact/model/model.hpp"
#include "contact/stepping/energy_ledger.hpp"
#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/point_forces.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

struct ModalState {
  /// Throws InputError if a folded model cannot be stepped with these options.
  ModalState(std::shared_ptr<const Model> model, const StepOptions& options);

  const Energy& energy() const { return ledger.energy(); }
  int modes_in_residual() const {
    return static_cast<int>(system->model->folded.modes.size());
  }  ///< modes moved into R because ωΔ > π

  /// Starts step k: next_q is q after the motion from (q, v) without contact.
  void begin(std::int64_t k) noexcept;
  /// Motion without contact from (q, v) over `over`: sets g = f − ω²q and returns q⁺ − q.
  Vector& free_motion(const Vector& q, const Vector& v, const ForcedResponse::Interval& over) noexcept;
  /// After `begin`: completes the step without contact.
  Work free_step() noexcept;
  /// After `begin`: completes the step under constant forces p̄ (n) and commits it.
  /// @param residual  energy in the residual and in springs at its end [J]
  /// @param at_points  with friction: work by the motion of the points, instead of that of the modes
  bool step_under(const Vector& mean, double residual, const Work* at_points) noexcept;
  /// Applies impulses at the end of the step: q̇⁺ = q̇⁻ − Bᵀ P. Adds their work to `work` and returns the
  /// number of points with P > 0.
  int strike(const Vector& impulse, Work& work) noexcept;
  /// Makes next_q, next_v the state. Returns false and changes nothing if they are not finite.
  bool commit(const Work& work, double residual) noexcept;
  /// Computes u = B q + s − R p − s(λ) (n).
  void displacement(const Vector& force, Vector& u) const noexcept;
  /// Sets a force at a point of a body that does not turn [N], world axes, from the next step on. What it
  /// moves at once jumps within that step.
  PushStatus push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept;

  void archive(auto& a) { a(forcing, q, v, s, ledger, now, next_q, next_v, pushes_); }

  std::shared_ptr<const StepSystem> system;
  ForcedResponse forcing;
  Vector q, v;  ///< (N) q relative to the lift of moving supports, and q̇
  Vector s;     ///< (n) s at t_k
  EnergyLedger ledger;
  ForcedResponse::Interval now;  ///< the current step, or its last interval
  Vector next_q, next_v;         ///< (N)

 private:
  int push(const Vector& force) noexcept;
  Work work() noexcept;
  const Model& model() const { return *system->model; }

  Vector g_, dq_, push_;    ///< (N) f − ω²q, q⁺ − q, Bᵀp
  Vector work_q_, work_v_;  ///< (N) scratch of the work of forcing
  PointForces pushes_;
  Vector on_candidates_, moved_;  ///< (rM), (n) scratch of pushes
};

}  // namespace ricochet::contact
