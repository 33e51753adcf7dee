// SPDX-License-Identifier: BSD-2-Clause
// Finds the first touch of bodies that turn. Over so short a time, rotations are small, so that linear ones,
// whose errors can be estimated (estimate.hpp), replace them. Finds also when bodies have parted, so that all
// runs of an estimate end at the same time.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "contact/motion/pose.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

struct FirstTouch {
  /// Shortly before it, when no free body has farther to go than a hundredth of its radius; at least 0, and
  /// 0 under loads and on moving supports, because bodies then vibrate when they touch [s].
  double from = 0;
  double end = 0;  ///< of its last force, or when a body turned too far [s]
  /// When nothing had touched for as long as it lasted, or when a free body turned by more than linear
  /// rotations allow, or the end of the run [s].
  double until = 0;
  double turned = 0;               ///< largest angle by which a free body turned from `from` to `end` [rad]
  std::vector<Pose> poses;         ///< of the bodies, at `from`
  std::vector<std::size_t> pairs;  ///< with a force until then, ascending
};

/// Runs the model until its first touch is over, with shorter steps if those of the options do not resolve
/// the touch.
/// @param duration  of the run [s]
/// @param poll  called after each step; may throw to end the run
/// @return no value if nothing touches
/// Throws InputError as make_stepper does, and if loads turn a free body by more than linear rotations allow
/// before it touches.
std::optional<FirstTouch> find_first_touch(const Model& model, StepOptions options, double duration,
                                           const std::function<void()>& poll = {});

/// The time at which bodies have touched and parted (FigureObserver::parted), with shorter steps as above
/// [s].
/// @param longest  time of the run at most [s]
/// @param poll  as above
/// @return no value if they do not part within this time, or if a step fails
/// Throws InputError as make_stepper does.
std::optional<double> find_parting(const Model& model, StepOptions options, double longest,
                                   const std::function<void()>& poll = {});

}  // namespace ricochet::contact
