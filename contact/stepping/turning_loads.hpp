// SPDX-License-Identifier: BSD-2-Clause
// Loads with histories, moving supports, and forces at points of bodies that turn.
//
// The vector of a load is constant in the world or in the body. In a step, its vector a in the axes of the
// body is that of the middle of the step. Its history h is integrated exactly. With H = ∫h dt over the step,
// the force F and the torque τ about the centre under a, whose arms are those of the undeformed body, change
// a free body by
//
//   Δv = H F/m,   ΔL = H τ,   lag = [∫ (t⁺ − t) h dt − ½ΔH] F/m
//
// where the lag is what a load that grows moves the centre beside ½Δ (v + v⁺). Elastic modes follow a h by
// forced_response.hpp. What is faster than steps follows at once: folded modes, and what is beyond the modes.
// So does Ψ ū of a moving support, whose body does not turn. The work of a load is
//
//   H F·(v + v⁺)/2 + H τ·J⁻¹(L + L⁺)/2 + ∫ f h·q̇ dt
//
// and that of contact over lag and static displacements, which is done by loads as well, is taken from it.
// With it, the ledger closes exactly.
//
// A force from outside at a point is a load of constant history whose vector is that of the world. What
// follows at once is left out.
#pragma once

#include <span>
#include <vector>

#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/moving_points.hpp"
#include "contact/stepping/point_forces.hpp"

namespace ricochet::contact {

class TurningLoads {
 public:
  /// Of a folded model, which must outlive this object. Adds static responses to the candidates of `points`,
  /// and sets the loads of `response` at t = 0.
  TurningLoads(const Model& model, std::span<const FloatingBody> bodies, ForcedResponse& response,
               MovingPoints& points);

  /// Sets what acts over a step, in the middle of which the bodies are.
  void act(std::span<FloatingBody> bodies, double from, double to, ForcedResponse& response,
           MovingPoints& points) noexcept;
  /// Lets no load act on the frames, for a flight.
  static void release(std::span<FloatingBody> bodies) noexcept;
  /// Sets static displacements to those at t. Returns their modal coordinates (N).
  const Vector& place(std::span<const FloatingBody> bodies, double t, MovingPoints& points) noexcept;
  const Vector& change() const { return change_; }  ///< (N) of these coordinates in the step

  /// Sets a force at a point of a body [N], world axes.
  PushStatus push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept;
  bool pushes(int body) const noexcept { return pushes_.act_on(body); }  ///< whether such a force acts on it
  void forget(int body) noexcept { pushes_.forget(body); }
  void take(const TurningLoads& earlier, const std::vector<int>& body);

  void archive(auto& a) {
    for (Driver& one : drivers_) a(one.force);
    a(displaced_, change_, pushes_, pushed_, has_pushed_);
  }

  /// Whether a load acts on a free body at any time within an interval.
  bool act_on_free(double from, double to) const noexcept;
  /// Whether a support moves at any time within it.
  bool move(double from, double to) const noexcept;
  // Largest values for a body within it
  double pull(int body, double from, double to) const noexcept;   ///< as FloatingBody::pull [J^½/s]
  double reach(int body, double from, double to) const noexcept;  ///< static displacement of a candidate [m]
  double speed(int body, double from, double to) const noexcept;  ///< of a candidate by supports [m/s]

 private:
  /// A load, or a moving support; its matrices are along the axes of the body.
  struct Driver {
    const Model::Forcing* of;
    bool free = false;           ///< whether a load acts on a frame
    Matrix dynamic{};            ///< (3,modes) participation of the elastic modes that are stepped
    Matrix at_once{};            ///< (3,modes) coordinates of those that follow at once
    int response = -1;           ///< among the static responses of the candidates
    double pull = 0, reach = 0;  ///< for a history of value 1
    Vector force{};              ///< (modes)
  };
  Driver driver(const Model& model, const Model::Forcing& one, const FloatingBody& body,
                MovingPoints& points) const;

  /// Adds forces at points to what acts on the frames, and sets those on the modes.
  void push(std::span<FloatingBody> bodies, ForcedResponse& response) noexcept;

  double pull_of(const PointForces::Force& one) const noexcept;

  const Model* model_;
  std::vector<double> largest_inverse_;  ///< by body, of the inertia [1/(kg m²)]
  std::vector<Driver> drivers_;          ///< in the order of the model's forcing
  PointForces pushes_;
  bool has_pushed_ = false;              ///< whether there have been any
  Vector pushed_;                        ///< (N) modal forces
  Vector settled_, displaced_, change_;  ///< (N) by gravity, by all, in the step
};

}  // namespace ricochet::contact
