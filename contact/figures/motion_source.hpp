// SPDX-License-Identifier: BSD-2-Clause
// The bodies and pairs of a run and their motion as a whole, whether it follows from modes or from sampled
// responses.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact {

/// The state of a run is q̇ (N) with modes, in which the rates of rigid modes are those of the bodies at their
/// initial attitudes, and the velocities (3·bodies) of the free bodies with sampled
/// responses.
class MotionSource {
 public:
  struct Body {
    std::string name;
    double mass = 0;     ///< [kg]
    bool moves = false;  ///< whether it can move rigidly
  };
  struct Pair {
    int a = -1, b = -1;  ///< bodies; −1: an obstacle or, with sampled responses, a supported body
    Eigen::Index first = 0, points = 0;            ///< its points
    Matrix normal;                                 ///< (points,3) out of a; 0 at points of other pairs
    std::string name_a{}, name_b{};                ///< of bodies or obstacles; name_b is empty if unknown
    std::shared_ptr<const DrivenMotion> driven{};  ///< of an obstacle; null if it does not move
    Eigen::Vector3d origin{0, 0, 0};               ///< of an obstacle that turns, at t = 0 [m]
    bool turns() const { return driven && driven->turns(); }
  };

  /// `model` must outlive the source.
  MotionSource(const Model& model);
  /// `table` and `places`, the model from which it was sampled, or null, must outlive the source.
  MotionSource(const Table& table, const Model* places);

  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Pair>& pairs() const { return pairs_; }
  const Vector& gap() const { return *gap_; }    ///< (m) [m]
  const Vector& area() const { return *area_; }  ///< (m) [m²]; empty if unknown

  /// Null with sampled responses: deformation, energies and receivers are unknown.
  const Model* modes() const { return table_ ? nullptr : places_; }
  /// The points, bodies and modes that the responses represent. Null if they are read from a file.
  const Model* places() const { return places_; }

  Vector initial_state() const;
  Eigen::Map<const Vector> state(const Stepper& stepper) const;
  /// Momentum of a body [kg m/s]. @param time  [s]
  Eigen::Vector3d momentum(int body, const Vector& state, double time) const;
  /// Velocity of a body as a whole, without its vibration [m/s].
  Eigen::Vector3d velocity(int body, const Vector& state) const;
  /// That of the first side of a pair at a time, relative to the second one. @param place  at which the
  /// velocity of an obstacle is taken, whose points have different ones if it turns [m]
  Eigen::Vector3d relative_velocity(const Pair& pair, const Vector& state, double time,
                                    const Eigen::Vector3d& place) const;
  /// The same times the radius of gyration, for the angular velocity; no value unless the body has the six
  /// rigid modes of a solid [m/s].
  std::optional<Eigen::Vector3d> spin(int body, const Vector& state) const;
  /// Kinetic energy of the bodies as a whole [J]. Only with modes.
  double rigid_energy(const Stepper& stepper) const;
  /// Angular momentum of a body about the origin of the world [kg m²/s]. Only with modes.
  Eigen::Vector3d angular_momentum(int body, const Vector& state, double time,
                                   std::span<const Pose> poses) const;

 private:
  const Model* places_;
  const Table* table_ = nullptr;
  const Vector *gap_, *area_;
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  std::optional<RigidMotions> rigid_;  ///< with modes
};

}  // namespace ricochet::contact
