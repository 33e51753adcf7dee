// SPDX-License-Identifier: BSD-2-Clause
// From two candidate surfaces in the world to contact pairs: for each candidate, its projection on the other
// surface, the normal and the gap.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ricochet/friction.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::contact {

/// A kernel placed in the world: x_world = rotation · x_body + translation.
struct PlacedBody {
  std::string name;
  const kernels::Kernel* kernel = nullptr;  ///< must outlive the model
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();       ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< initial, of the centre of mass [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< initial, about that centre, world [rad/s]
  /// Initial rigid displacement from this place, at which pairs are found [m].
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

struct WorldSurface;

/// A rigid half-space {x : (x − point)·normal ≤ 0}, or a rigid surface, whose outer side is the free one.
struct Obstacle {
  std::string name;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< of a surface: the origin of its axes [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< of a half-space
  /// In axes of its own; null: a half-space
  std::shared_ptr<const WorldSurface> surface{};
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< of its axes
};

/// Two surfaces that may touch, by name; `b` names a body or an obstacle.
struct PairRequest {
  std::string a, b;
  std::optional<Eigen::Vector3d> direction;  ///< unit, out of a; world frame
  std::optional<double> gap;    ///< [m] moves body a along the direction until the closest pair has this gap
  std::optional<double> reach;  ///< [m] drops pairs whose initial gap is not below it
  /// [m] drops pairs whose initial gap exceeds that of the closest pair by this distance or more
  std::optional<double> zone{};
  std::optional<Friction> friction{};  ///< no value: frictionless
  /// Because bodies turn: keeps candidates that face away from a half-space, with the whole of their bulges,
  /// and takes all candidates of two bodies.
  bool everywhere = false;
  bool operator==(const PairRequest&) const = default;
};

/// Points of the surface of a that face points of the surface of b (world frame, after `gap` has moved a):
/// candidates of a, then points that have no candidate of a, where creases cross or where a crease of b faces
/// a. Candidates are numbered as on whole surfaces, regardless of which ones the kernels contain.
struct Pairing {
  using Weights = std::vector<std::pair<int, double>>;  ///< candidates and weights ≥ 0 with the sum 1
  struct Point {
    Eigen::Vector3d a, b, normal;  ///< x̂_i, y_i [m], n_i out of a
    double gap = 0;                ///< g_i = n_i·(y_i − x̂_i) [m]
    double area = 0;               ///< [m²], of the patch of a
    double bulge = 0;              ///< b_i ≥ 0, by which both patches bulge beyond their means [m]
    Weights of_a;                  ///< candidates of a around x̂_i; a candidate itself has the weight 1
    /// W: candidates of b around y_i; empty for an obstacle, except, if bodies turn, for nodes on its creases
    Weights of_b;
  };
  std::vector<Point> points;
  int candidates_of_a = 0, candidates_of_b = 0, summits = 0;  ///< of bodies that turn: see Rows::PairBlock
  int unpaired = 0;               ///< number of candidates of a that face nothing or lie beyond reach
  int beyond_reach = 0;           ///< number of points that lie beyond reach
  std::optional<double> reach{};  ///< [m] the initial gap at which pairs were dropped, by reach or zone
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< translation of a due to `gap`
};

/// How far a pair of surfaces is apart, whatever their candidates.
struct TrueDistance {
  /// Between the curved elements without their cubic terms, to within 1e-3 of `element` [m]; 0 if they
  /// intersect.
  double distance = 0;
  double element = 0;  ///< size of the smallest element of both [m]
};

/// Computes it; no value along a direction, where only the distance along it matters, and for surfaces of
/// points or strips.
std::optional<TrueDistance> true_distance(const PlacedBody& a, const PlacedBody& b,
                                          const PairRequest& request);
std::optional<TrueDistance> true_distance(const PlacedBody& a, const Obstacle& b,
                                          const PairRequest& request = {});

/// Pairs the candidates of a with the surface of b. With `direction`, points are projected along it.
/// Otherwise each point is projected along n_i = (n_a − n_b)/|n_a − n_b|, found by iteration from the closest
/// point; from a crease, along −n_b. A projection is a point of the candidate mesh of b (curved triangles,
/// curved segments, points); it may lie up to 1e-6 of the element's size beyond an edge. Where creases of
/// both bodies cross, n_i is perpendicular to both. Pairs are found on whole surfaces, regardless of which
/// candidates the kernels contain. Throws InputError if no point faces the other surface, if bodies overlap
/// (with the depth), or if a kernel contains only one component and the contact acts along another direction.
/// Against a half-space, points are projected along its normal; another obstacle is paired like a body whose
/// candidates are not needed, along its own normals: y_i is then the closest point of the obstacle.
Pairing pair(const PlacedBody& a, const PlacedBody& b, const PairRequest& request);
Pairing pair(const PlacedBody& a, const Obstacle& b, const PairRequest& request);

}  // namespace ricochet::contact
