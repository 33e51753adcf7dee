// SPDX-License-Identifier: BSD-2-Clause
// Finds bodies that pass through each other because the parts that meet have no contact points.
#pragma once

#include <string>
#include <vector>

#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"
#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// A depth that does not count: this share of an element, plus so many times the largest bulge of the patches
/// and the approach of the contact points.
inline constexpr double share_of_element = 1e-3, times_bulge = 2, times_approach = 2;

/// Moves the contact surfaces of each pair of bodies rigidly and looks for intersections, as often as a pair
/// has moved by a quarter of an element, up to `most_looks` times.
class PassageCheck {
 public:
  static constexpr int most_looks = 40;

  /// `model` must outlive the check.
  explicit PassageCheck(const Model& model);

  /// @param motion  of each body
  void observe(const std::vector<RigidMotion>& motion, double time);

  std::vector<std::string> warnings() const;

 private:
  struct Meeting {
    int pair = 0;
    WorldSurface a;  ///< world, initial
    SurfaceProjection b;
    double element = 0, least = 0;  ///< depth that does not count [m]
    Eigen::Matrix3Xd corners{};     ///< of the bounding box of a
    Eigen::Matrix3Xd looked_at{};   ///< their displacement relative to b when last looked at [m]
    int looks = 0;
    double deepest = 0, time = 0;  ///< deepest passage and its time
  };
  const Model& model_;
  std::vector<Meeting> meetings_;
};

}  // namespace ricochet::contact
