// SPDX-License-Identifier: BSD-2-Clause
// Snapshots of all bodies in a result file: their coordinates (body_coordinates.hpp), from which a kernel
// gives the motion of any of its points (docs/formats/result.md). With finite rotations, the pose of the body
// is written beside them, and so are those of obstacles that move.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/figures/body_coordinates.hpp"
#include "contact/files/obstacle_rows.hpp"
#include "contact/files/pose_rows.hpp"

namespace ricochet::contact {

class SnapshotRows {
 public:
  /// Creates the datasets. `file` and `model` must outlive this object.
  /// @param turns  whether bodies have poses
  /// @param obstacles  those that `write_obstacles` got
  SnapshotRows(base::hdf5::Writer& file, const Model& model, bool turns,
               std::span<const ObstacleSurface> obstacles);

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
  AllCoordinates coordinates_;
  Rows& time_;
  std::int64_t count_ = 0;  ///< snapshots so far
  std::vector<Body> bodies_;
  ObstacleRows obstacles_;
};

}  // namespace ricochet::contact
