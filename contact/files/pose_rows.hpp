// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <string>

#include "contact/files/rows.hpp"
#include "contact/motion/pose.hpp"

namespace ricochet::contact {

/// Rows of the place of a body or of an obstacle: `position` (3) of its centre of mass or origin [m], and
/// `attitude` (4), the unit quaternion w, x, y, z from its axes to world axes.
class PoseRows {
 public:
  /// Creates the datasets in a group. `file` must outlive this object.
  PoseRows(base::hdf5::Writer& file, const std::string& group)
      : position_(file.rows(group + "/position", {3}, "m")),
        attitude_(file.rows(group + "/attitude", {4}, "1")) {}

  void append(const Pose& pose) const {
    contact::append(&position_, pose.position);
    const Eigen::Quaterniond& q = pose.attitude;
    attitude_.append(std::array{q.w(), q.x(), q.y(), q.z()});
  }

 private:
  base::hdf5::Rows &position_, &attitude_;
};

}  // namespace ricochet::contact
