// SPDX-License-Identifier: BSD-2-Clause
// From two candidate surfaces in the world to contact pairs: which candidate faces which place, along which
// normal, with which gap.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// A kernel placed in the world: x_world = rotation · x_body + translation.
struct PlacedBody {
  std::string name;
  const kernels::Kernel* kernel = nullptr;  ///< outlives the model
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();     ///< initial, rigid [m/s]
};

/// Rigid half-space {x : (x − point)·normal ≤ 0}.
struct HalfSpace {
  std::string name;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
};

class Pairings;

/// Which surfaces meet, by name; `b` names a body or a half-space.
struct PairRequest {
  std::string a, b;
  std::optional<Eigen::Vector3d> direction;  ///< unit, out of a; world frame
  std::optional<double> gap;    ///< [m] moves body a along the direction until the closest pair has this gap
  std::optional<double> reach;  ///< [m] drops pairs whose initial gap is not below it
  bool operator==(const PairRequest&) const = default;
};

/// Candidates of a that face a place on b (world frame, after `gap` has moved a).
struct Pairing {
  struct Point {
    int candidate = 0;             ///< of those that a's kernel holds
    Eigen::Vector3d a, b, normal;  ///< x_i, y_i [m], n_i out of a
    double gap = 0;                ///< g_i between the means of the patches, about n_i·(y_i − x_i) [m]
    double area = 0;               ///< [m²], of a's patch
    std::vector<std::pair<int, double>>
        weights;  ///< W: candidates of b around y_i; weights ≥ 0, sum 1; empty for a half-space
  };
  std::vector<Point> points;
  int unpaired = 0;      ///< candidates of a dropped because they face nothing or lie beyond reach
  int beyond_reach = 0;  ///< of these: beyond reach
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< how far `gap` moved a
};

/// Pairs a's candidates with b's surface. With `direction`, along it; otherwise each point is projected along
/// n_i = (n_a − n_b)/|n_a − n_b|, found by iteration from the closest point. A place on b is a point of its
/// candidate mesh (triangles, segments, points), met within 1e-6 of the element's size beyond its edges.
/// Pairs are found on whole surfaces, whatever part of their candidates the kernels hold. Throws InputError
/// when nothing faces anything, when bodies overlap (with the depth), when a kernel holds one component only
/// and the direction asked for is another one, or does not hold a candidate that is paired.
/// @param known  takes from it, and adds to it, what does not depend on the kernels' modes; null: nothing is
///               known
Pairing pair(const PlacedBody& a, const PlacedBody& b, const PairRequest& request, Pairings* known = nullptr);
Pairing pair(const PlacedBody& a, const HalfSpace& b, const PairRequest& request);

}  // namespace ricochet::contact
