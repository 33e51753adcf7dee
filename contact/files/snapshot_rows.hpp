// SPDX-License-Identifier: BSD-2-Clause
// Snapshots of all bodies in a result file, from which a kernel gives the motion of any of its points
// (docs/formats/result.md):
//
//   u = Φ q + R_C f + (static response to gravity, loads and supports)
//
// With finite rotations, u is in the axes of the body, without its rigid motion, and the pose of the body is
// written beside it.
//
// q are the coordinates Φᵀ M u of the kept modes, f the contact forces on the candidates of the body. R_C and
// the other static responses are in the kernel, for example under /view.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/files/pose_rows.hpp"
#include "contact/motion/turning.hpp"

namespace ricochet::contact {

class SnapshotRows {
 public:
  /// Creates the datasets. `file` and `model` must outlive this object.
  /// @param turns  whether bodies have poses
  SnapshotRows(base::hdf5::Writer& file, const Model& model, bool turns);

  /// @param q, p  (N), (n) modal coordinates and forces at `time` [s]; p = 0 under impulses
  /// @param turning  of the stepper; null unless bodies turn
  void append(double time, const Vector& q, const Vector& p, const Turning* turning);

 private:
  using Rows = base::hdf5::Rows;
  /// Rows of a body; null if there is nothing of the kind.
  struct Body {
    Rows* modal = nullptr;
    Rows *snapshot = nullptr, *candidate = nullptr, *force = nullptr;
    Rows *load = nullptr, *motion = nullptr;
    std::optional<PoseRows> pose{};
  };
  void append_forces(const Body& rows, const Vector& force, Eigen::Index components);

  const Model& model_;
  Rows& time_;
  std::int64_t count_ = 0;  ///< snapshots so far
  std::vector<Body> bodies_;
  Vector force_;  ///< (rM) of a body
};

}  // namespace ricochet::contact
