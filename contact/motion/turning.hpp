// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <optional>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/motion/pose.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Bodies that turn by any angle: their frames, where their rows act now, and what acts on them.
struct Turning {
  std::vector<Pose> poses;  ///< by body
  /// Of points that may touch: places now, and the directions along which the forces of the last step acted.
  /// Of others, as they were last known.
  RowFrames frames;
  /// What acts on a body from outside besides loads, about its centre, world axes.
  struct Wrench {
    Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};  ///< [N], [N m]
    void archive(auto& a) { a(force, torque); }
  };
  std::vector<Wrench> pushed;           ///< by body
  std::vector<Vector> candidate_force;  ///< by body (3M), in its axes, at the end of the last step [N]
  Vector rates{};  ///< (N) q̇ of the elastic modes, in body axes: v, and the turn of nearly equal modes

  void archive(auto& a) {
    a(poses, frames.point_a, frames.point_b, frames.normal, frames.tangent, pushed, candidate_force, rates);
  }
};

/// At t = 0, with finite rotations; otherwise no value. Throws InputError as FloatingBody's constructor does.
std::optional<Turning> initial_turning(const Model& model, const StepOptions& options);

}  // namespace ricochet::contact
