// SPDX-License-Identifier: BSD-2-Clause
// What finite rotations neglect: the centrifugal strain, the shift of frequencies, and the Coriolis coupling
// of modes that are not nearly equal, or whose kernel lacks it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "contact/figures/summary.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class RotationCheck {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s]; 0: unknown. `model` must outlive the check.
  RotationCheck(const Model& model, double wave_speed);

  /// Call it after each step or flight. Does nothing with linear rotations.
  void observe(const Stepper& stepper);

  std::map<std::string, Neglected> neglected() const;  ///< by free body; empty with linear rotations
  std::vector<std::string> warnings() const;

 private:
  struct Body {
    double radius = 0;   ///< largest distance of a contact point from the centre [m]
    double lowest = 0;   ///< frequency of an elastic mode; 0: there is none [rad/s]
    double apart = 0;    ///< smallest difference of modes that are not coupled; 0: there are none [rad/s]
    int first = -1;      ///< of these two modes, from 1, if they are nearly equal; otherwise −1
    double fastest = 0;  ///< spin [rad/s]
    double turned = 0;   ///< ∫ |Ω| dt [rad]
  };
  Neglected neglected(const Body& body) const;

  const Model& model_;
  double wave_speed_, time_ = 0;
  bool turns_ = false;
  std::vector<Body> bodies_;
};

}  // namespace ricochet::contact
