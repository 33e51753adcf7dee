// SPDX-License-Identifier: BSD-2-Clause
// What finite rotations neglect: the centrifugal strain, and the coupling of nearly equal modes by the
// rotation (Coriolis), which makes their pattern precess.
#pragma once

#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class RotationCheck {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s]; 0: unknown. `model` must outlive the check.
  RotationCheck(const Model& model, double wave_speed);

  /// Call it after each step or flight. Does nothing with linear rotations.
  void observe(const Stepper& stepper);

  std::vector<std::string> warnings() const;

 private:
  struct Body {
    double radius = 0;   ///< largest distance of a contact point from the centre [m]
    int first = -1;      ///< of two nearly equal elastic modes, from 1; −1: there are none
    double fastest = 0;  ///< spin [rad/s]
    double turned = 0;   ///< ∫ |Ω| dt [rad]
  };
  const Model& model_;
  double wave_speed_, time_ = 0;
  std::vector<Body> bodies_;
};

}  // namespace ricochet::contact
