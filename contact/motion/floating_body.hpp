// SPDX-License-Identifier: BSD-2-Clause
// A body in its floating frame: the motion of its frame, beside its elastic modes in body axes.
//
// Elastic modes of a free body carry neither momentum nor angular momentum about its centre of mass, so the
// frame carries all of both. The frame of a supported body does not move, as if its mass were infinite.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/motion/free_rotation.hpp"
#include "contact/motion/pose.hpp"

namespace ricochet::contact {

struct FloatingBody {
  // Constants. Body axes are those of the kernel.
  int first_mode = 0, modes = 0;
  int frame_modes = 0;               ///< the first modes, which are rigid; 0 if the body is supported
  double mass = 0;                   ///< [kg]
  double inverse_mass = 0;           ///< of the frame [1/kg]
  Eigen::Vector3d centre{0, 0, 0};   ///< of mass, body axes [m]
  Eigen::Vector3d gravity{0, 0, 0};  ///< by which the frame falls [m/s²]
  Inertia inertia;
  Eigen::Vector3d start{0, 0, 0};  ///< the centre at t = 0 [m]
  /// (frame_modes,3) rigid rates for a unit velocity, for a unit spin
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> linear, spin;

  // State, world axes
  bool present = true;                ///< otherwise its place waits for another body, and it does not move
  bool asleep = false;                ///< at rest until something reaches it
  Eigen::Vector3d position{0, 0, 0};  ///< of the centre [m]
  Eigen::Vector3d velocity{0, 0, 0};
  Eigen::Vector3d momentum{0, 0, 0};  ///< angular, about the centre [kg m²/s]
  Eigen::Quaterniond attitude;        ///< from body axes
  Eigen::Matrix3d axes;               ///< the same as a matrix: body axes in world axes

  // From outside, about the centre, world axes: constant over a step
  Eigen::Vector3d push{0, 0, 0};    ///< force [N]
  Eigen::Vector3d torque{0, 0, 0};  ///< [N m]
  // Of loads, likewise: means over a step
  Eigen::Vector3d load{0, 0, 0}, load_torque{0, 0, 0};
  Eigen::Vector3d lag{0, 0, 0};  ///< by which the centre moves farther than under the mean load [m]

  /// What nothing moves, at a place.
  explicit FloatingBody(const Pose& pose);
  /// Throws InputError unless the body moves freely in all six ways, undamped as a whole, or not at all.
  FloatingBody(const Model& model, const Bodies::Block& block);

  int elastic() const { return modes - frame_modes; }
  Eigen::Index first_elastic() const { return first_mode + frame_modes; }

  bool moves() const { return present && !asleep; }
  /// Angular velocity in body axes [rad/s].
  Eigen::Vector3d own_spin() const { return own_spin(momentum); }
  Eigen::Vector3d own_spin(const Eigen::Vector3d& angular_momentum) const {
    return inertia.inverse * (axes.transpose() * angular_momentum);
  }
  /// Without contact [m/s²].
  Eigen::Vector3d acceleration() const { return gravity + inverse_mass * (push + load); }
  /// Of the frame in a step without contact, body axes [m], [rad].
  struct FreeMotion {
    Eigen::Vector3d shift{0, 0, 0}, turn{0, 0, 0};
    Eigen::Vector3d at(const Eigen::Vector3d& arm) const { return shift + turn.cross(arm); }
  };
  FreeMotion free_motion(double step) const;
  /// The largest one of points within a radius of the centre [m].
  double farthest(double radius, double step) const;
  /// By how much gravity and what acts from outside, but not loads, raise (2E)^½ in a time, at most
  /// [J^½/s].
  double pull() const;
  Pose pose() const { return {position, attitude, velocity, axes * own_spin()}; }
  double kinetic() const;  ///< [J]
  /// Work of gravity since t = 0 [J].
  double work_of_gravity() const { return mass * gravity.dot(position - start); }

  /// Round-off of the sums of position and velocity, since gravity adds the same small number millions of
  /// times.
  Eigen::Vector3d position_carry{0, 0, 0}, velocity_carry{0, 0, 0};

  /// Sets a place and a motion. The body starts there.
  void move_to(const Pose& pose) noexcept;
  /// Takes the body out.
  void leave() noexcept;
  // Return ∫Ω dt in body axes [rad].
  Eigen::Vector3d drift(double time) noexcept;  ///< without forces, for a part of a contact step [s]
  Eigen::Vector3d fly(double time) noexcept;    ///< without contact and torque [s]
  /// Changes velocity and momentum by forces and torques on it, constant over a step [s], beside gravity,
  /// loads and those from outside. Returns the work of the latter two [J]. @param contact, moment  body axes
  double kick(const Eigen::Vector3d& contact, const Eigen::Vector3d& moment, double step) noexcept;
  /// Sets the rates of the rigid modes to those of the present velocity and spin in world axes, as if the
  /// body had its initial attitude, which is how momenta and velocities are computed from them.
  void write_rates(Vector& rates) const noexcept;

  /// The state, and what of the constants a removal changes.
  void archive(auto& a) {
    a(present, asleep, inverse_mass, gravity, start, position, velocity, momentum, attitude, axes, push,
      torque);
    a(load, load_torque, lag, position_carry, velocity_carry);
  }
};

/// The bodies of a model at t = 0. Throws InputError as the constructor does.
std::vector<FloatingBody> floating_bodies(const Model& model);

}  // namespace ricochet::contact
