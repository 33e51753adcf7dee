// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme for free bodies that turn by any angle: floating frames, with contact points found
// anew.
//
// A step drifts by half of it, kicks, and drifts by the other half. The drifts move the frames without forces
// and conserve energy, momentum and angular momentum. Contact acts at the geometry of the middle, with the
// true gaps of the start: the step of contact/law gives the forces, and the kick changes velocities, angular
// momenta and modes. Nearly equal modes of bodies that turn mix in the drifts (coriolis.hpp). The work of the
// kick is that of the mean forces over the displacements d of moving_points.hpp, so that the theorem of
// mean_force.hpp holds for any rotation. Two things are new:
//
//   - The forces of the last step keep their directions, in the world or in the body that a point meets, and
//     R turns with the bodies and points move along them, which changes the energy stored in R. The reserve
//     and the bank of the island pay for a rise. If they cannot, the forces are reduced until the energy is
//     that of before.
//   - A gap may be below 0 at the start, since the drift is a rotation and the step took it for a straight
//     line, by (ΩΔ)³ r/24. Where they cannot pay for pushing the point out, it may only not sink further.
//     A point that is inside before it has a force, or because it is a summit that has jumped along an edge,
//     is not pushed out at all: elastic displacements have bent the edge, or a candidate no longer stands
//     back. It touches as deep as it is.
//
// Bodies of an island that have come to rest on obstacles that do not move fall asleep: they stay where they
// are, with their last forces and at no cost, until a search finds that a body in motion may reach one of
// them, one is pushed, or a load or support changes.
//
// Flight is crossed from sample to sample, or in parts that resolve the mixing of modes, while no point can
// touch, nothing but gravity acts on free bodies, and no load or support changes; from step to step while
// bodies asleep bear forces.
#pragma once

#include <array>
#include <span>

#include "contact/motion/coriolis.hpp"
#include "contact/stepping/moving_points.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/stepping/turning_loads.hpp"

namespace ricochet::contact {

class FloatingStepper final : public Stepper {
 public:
  /// Throws as make_stepper does, and if a body, a pair or a load does not allow bodies that turn.
  FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options);
  /// Goes on where a stepper of another model is: bodies and pairs that both models have keep their state.
  /// Other bodies are at the places of the model.
  FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options,
                  const FloatingStepper& earlier, const Correspondence& from);

  /// Takes a free body without loads out. What it touched is free of it, and its place waits for put_in.
  void take_out(int body) noexcept;
  /// Puts a body with the same kernel at the place of one that was taken out, with its elastic modes at rest.
  /// Throws InputError if it turns too fast. @param name  for the message
  void put_in(int body, const std::string& name, const Pose& pose);
  bool is_present(int body) const { return bodies_[static_cast<std::size_t>(body)].present; }
  /// The rows that may have a force in the last step: of the step, and of pairs asleep.
  std::array<std::span<const int>, 2> forced() const { return {forced_.now, forced_.asleep}; }

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<FloatingStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const FloatingStepper&>(clone); }
  /// Elastic modes in body axes; FloatingBody::write_rates gives the rates of the rigid ones, whose
  /// displacements are 0.
  const ModalState* modal() const noexcept override { return &state_; }
  const Turning* turning() const noexcept override { return &turning_; }
  const Vector& displacement() const noexcept override;
  bool push(int body, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) noexcept override;
  bool push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept override;
  void archive(base::Archive& a) override;

 private:
  FloatingStepper(std::shared_ptr<const Model> model, const StepOptions& options,
                  const MovingPoints* earlier);
  void check_spin(const std::string& name, const Eigen::Vector3d& spin) const;
  Energy energy_of(const Vector& q, const Vector& v, double residual) const noexcept;
  void exchange() noexcept;
  void search_anew() noexcept;
  bool is_steady(double time) noexcept;
  bool any_moves() const noexcept;
  StepStatus rest() noexcept;
  void let_sleep(int body) noexcept;
  void let_pairs_sleep() noexcept;
  void wake(int body) noexcept;
  void wake_all() noexcept;
  double asleep_residual() const noexcept;
  void place(double time) noexcept;
  void drive() noexcept;
  void set_free_motion() noexcept;
  simd::Oscillators oscillators(const FloatingBody& body, const ModeConstants& over) noexcept;
  void drift(Coriolis::Half half, Vector& q, Vector& v) noexcept;
  void keep_start() noexcept;
  void let_in() noexcept;
  void restore() noexcept;
  int steps_to_cross() const noexcept;
  int cross() noexcept;
  std::int64_t find_clear_until(double enough) noexcept;
  void fly(int crossed) noexcept;
  void set_flight(int steps) noexcept;
  void search() noexcept;
  void set_travels(double time) noexcept;
  PatchSpring spring_of(int row) noexcept;
  void carry_forces(const StepMatrices& matrices) noexcept;
  Work kick(const StepTrial& trial) noexcept;
  Work move_modes(const ModeConstants& over) noexcept;
  bool commit(const Work& work, double residual, double time) noexcept;
  void look_for_rest() noexcept;
  StepStatus end(const StepTrial& trial) noexcept;
  double elastic_energy(const FloatingBody& body) const noexcept;
  double swing_energy(const FloatingBody& body, double energy) const noexcept;

  /// What a step begins with, and returns to if it is repeated.
  struct Start {
    std::vector<FloatingBody> bodies;
    Vector q, v;  ///< (N) if nearly equal modes mix
    Vector end;   ///< p, by position
    std::vector<MeanForce::Pair> pairs;
  };
  /// When points are searched.
  struct Search {
    int every;                     ///< steps between two searches
    std::int64_t next = 0;         ///< step of the next one
    std::int64_t clear_until = 0;  ///< step before which nothing can touch
    std::int64_t look_at = 0;      ///< step from which on it is computed anew
  };
  /// Rows that may have a force.
  struct ForcedRows {
    std::vector<int> now;     ///< of the last step, which may not be 0 in force_ and have their u in next_u_
    std::vector<int> before;  ///< of the step before it, in next_force_
    std::vector<int> asleep;  ///< of pairs asleep, with their forces in force_ and in next_force_
    int active_asleep = 0;    ///< points with a force among these
  };
  /// Constants of a flight.
  struct Flight {
    ModeConstants over;                   ///< (N)
    int steps = 0;                        ///< over which it goes
    std::vector<Eigen::Vector3d> turned;  ///< by body, ∫Ω dt, body axes [rad]
  };

  ModalState state_;
  std::vector<FloatingBody> bodies_;
  Start start_;
  std::vector<Coriolis> coriolis_;  ///< by body
  bool mixes_;                      ///< whether any body has nearly equal modes
  Turning turning_;
  MovingPoints points_;
  TurningLoads loads_;
  std::vector<MovingPoints::Travel> travels_;
  Islands islands_;  ///< scratch: of forces at the start of a step; of what may meet
  Search search_;
  std::vector<double> slow_since_;  ///< by body [s]
  std::vector<char> rests_;         ///< by island, scratch: whether all its bodies rest
  std::vector<char> carries_;       ///< by island, scratch: whether it has a force at the start of a step
  std::vector<double> energy_of_;   ///< by body, scratch [J]
  std::vector<double> thrown_;      ///< by body, scratch: what obstacles may add to its speed [m/s]
  std::vector<double> stored_;      ///< by pair, in R after the last step [J]
  ForcedRows forced_;
  Flight flight_;
  Vector dq_, modal_force_;  ///< (N) of the free motion; of contact under p̄
  Vector displaced_;         ///< (N) q with static displacements
  Vector rest_;              ///< (n) R p + s(λ) at the start, by position
};

}  // namespace ricochet::contact
