// SPDX-License-Identifier: BSD-2-Clause
// Checks whether a run stays within linear elasticity with pairs fixed in the reference configuration.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Rotation beyond which linear ones are wrong [rad]: they lengthen a body by 1 − cos, 0.4 % here.
inline constexpr double largest_linear_rotation = 5 * std::numbers::pi / 180;

/// Returns a warning if `body` turned by more than linear rotations allow.
/// @param angle  [rad], while touching
std::optional<std::string> rotation_warning(const std::string& body, double angle);

/// Returns a warning if points that `reach` dropped may touch.
/// @param nearer  distance by which the bodies of the pair approached each other [m]
std::optional<std::string> reach_warning(const Model& model, const Model::PairBlock& pair, double nearer);

/// The body that turned farthest in its rigid modes.
struct FarthestTurn {
  std::size_t body = 0;  ///< its number
  double angle = 0;      ///< largest of the run [rad]
};

class LinearityCheck {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s]; 0 if unknown, without a warning on fast impacts
  /// `model` must outlive the check.
  LinearityCheck(const Model& model, double wave_speed);

  /// Call it after each step with a force.
  /// @param before  (N) q̇ at the start of the step
  /// @param first  whether an episode begins with this step
  void observe(const Stepper& stepper, const Vector& before, bool first);

  /// Call it after each step, with and without a force. It reads the rigid modes alone.
  /// @param q  (N) modal displacement, @param time  [s]
  void observe_rotation(const Vector& q, double time);

  /// Farthest rigid approach of points [m], over all pairs.
  double nearer() const;
  /// Of the steps of `observe_rotation`; 0 without bodies.
  FarthestTurn farthest_turn() const;
  std::vector<std::string> warnings() const;

 private:
  struct Turn {                   ///< rotation of a body in its rigid modes
    double angle = 0;             ///< largest [rad]
    std::optional<double> since;  ///< time after which it exceeded what linear rotations allow [s]
  };
  std::string turned_in_flight() const;

  const Model& model_;
  double wave_speed_;
  RigidMotions rigid_;
  std::vector<double> spacing_;  ///< by pair, smallest distance between neighbouring candidates of a [m]
  double approach_ = 0;  ///< largest normal approach speed of a point in the first step of an episode [m/s]
  std::vector<double> nearer_;        ///< by pair, farthest rigid approach of its points [m]
  double slip_ = 0, slip_share_ = 0;  ///< worst tangential motion [m] and its share of the spacing
  double tilt_ = 0;                   ///< largest rotation of a free body while touching [rad]
  std::string tilted_;                ///< name of that body
  std::vector<Turn> turns_;           ///< by body
  double last_ = 0;                   ///< time of the last rotation observed [s]
};

}  // namespace ricochet::contact
