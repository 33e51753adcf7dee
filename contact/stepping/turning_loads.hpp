// SPDX-License-Identifier: BSD-2-Clause
// Loads with histories and moving supports of bodies that turn.
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
#pragma once

#include <span>
#include <vector>

#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/moving_points.hpp"

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

  std::vector<Driver> drivers_;          ///< in the order of the model's forcing
  Vector settled_, displaced_, change_;  ///< (N) by gravity, by all, in the step
};

}  // namespace ricochet::contact
