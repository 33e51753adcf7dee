// SPDX-License-Identifier: BSD-2-Clause
// The part of a scene with finite rotations that its accuracy serves: the bodies that touch first, from
// shortly before until after this touch, with linear rotations.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "contact/accuracy/first_touch.hpp"
#include "contact/figures/quantities.hpp"
#include "src/scene/scene.hpp"
#include "src/store/stored_kernels.hpp"

namespace ricochet::accuracy {

struct AroundFirstTouch {
  scene::Scene scene;      ///< with linear rotations
  double turned = 0;       ///< angle by which a body turns until the touch ends [rad]
  store::Kernels all;      ///< kernels of the bodies
  store::Kernels kernels;  ///< with the candidates that may touch
  store::Prepared prepared;
  contact::Model model;
};

/// @param model  of the whole scene, with finite rotations
/// Throws InputError if no point of a body faces what it touches.
AroundFirstTouch around_first_touch(const contact::FirstTouch& touch, const scene::Scene& whole,
                                    const store::Kernels& kernels, const contact::Model& model);

/// The distance of this touch with finite rotations from that with linear ones, beyond the angle of its turn:
/// with another attitude, results change by about the angle, which is no error of finite rotations.
/// @param linear  quantities with linear rotations, @param rate  of contact steps; no value: the scene's
/// @param poll  called after each step; may throw to end the run
/// @return no value if a step fails
std::optional<contact::Errors> share_of_rotation(const AroundFirstTouch& touch,
                                                 const contact::Quantities& linear, std::optional<Hertz> rate,
                                                 const std::function<void()>& poll);

}  // namespace ricochet::accuracy
