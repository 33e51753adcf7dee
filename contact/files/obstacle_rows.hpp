// SPDX-License-Identifier: BSD-2-Clause
// Obstacles in a result file: the triangles of those that have a surface, and the poses of those that move
// (docs/formats/result.md).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "contact/files/obstacle_surface.hpp"
#include "contact/files/pose_rows.hpp"

namespace ricochet::contact {

/// Writes the obstacles that have a surface or move, as groups /obstacles/<number>, because their names may
/// be any text. Half-spaces have no triangles. Throws InputError if the file cannot be written.
void write_obstacles(base::hdf5::Writer& file, std::span<const ObstacleSurface> obstacles);

/// Rows of the poses of the obstacles that move.
class ObstacleRows {
 public:
  /// Creates the datasets. `file` must outlive this object. @param obstacles  those that `write_obstacles`
  /// got
  /// @param below  part of the path between the group of the obstacle and the datasets, such as "/pose"
  ObstacleRows(base::hdf5::Writer& file, std::span<const ObstacleSurface> obstacles,
               const std::string& below = "");
  /// @param time  [s]
  void append(double time) const;

 private:
  struct Moving {
    Pose start;
    std::shared_ptr<const DrivenMotion> driven;
    PoseRows rows;
  };
  std::vector<Moving> moving_;
};

}  // namespace ricochet::contact
