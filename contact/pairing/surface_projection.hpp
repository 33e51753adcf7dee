// SPDX-License-Identifier: BSD-2-Clause
// Candidate surfaces in the world, and the projection of a point onto them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <unsupported/Eigen/BVH>

#include "contact/pairing/pairing.hpp"

namespace ricochet::contact {

/// Candidate surface of a body, in the world.
struct WorldSurface {
  int corners = 3;
  std::vector<Eigen::Vector3d> node, normal;
  std::vector<double> area;             ///< of each patch [m²]
  std::vector<Eigen::Vector3d> offset;  ///< of each patch's centroid from its node [m]
  struct Element {
    std::array<int, 3> corner{};
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double size = 0;  ///< longest edge [m]
    bool operator==(const Element&) const = default;
  };
  std::vector<Element> element;
  /// An element of these corners, whose nodes are there.
  void add(Element of_corners);
  double extent = 0;    ///< diagonal of the nodes' bounding box [m]
  double farthest = 0;  ///< largest |coordinate| of a node, in the world and in the body's own frame [m]
  bool operator==(const WorldSurface&) const = default;
};

/// A point on a candidate surface, by weights of an element's corners.
struct Projection {
  Eigen::Vector3d point, normal;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{};
};

/// All candidates of the body, also those that its kernel does not hold.
WorldSurface surface_of(const PlacedBody& body);

/// Reference length for round-off [m]. Rods have no extent: a metre and their distance from the origin count.
double size_of(const WorldSurface& a, const WorldSurface& b);

/// Projects points onto a surface, searched through a tree of boxes around its elements. Among equally good
/// projections the one on the first element counts.
class SurfaceProjection {
 public:
  explicit SurfaceProjection(WorldSurface surface);
  const WorldSurface& surface() const { return surface_; }

  /// The intersection of the line x + t d with the surface for which `faces` holds and |t| is smallest.
  ///
  /// Triangles are intersected along d. Segments stand for strips that extend sideways: the projection lies
  /// abreast of the line along the segment as seen along d, and the line may pass beside it by half the
  /// segment's length. The line hits a point if it passes within 1e-6 of `size`.
  std::optional<Projection> first_along(const Eigen::Vector3d& x, const Eigen::Vector3d& d, double size,
                                        const std::function<bool(const Projection&)>& faces) const;

  /// The point closest to x; none without elements, or where their corners' normals cancel.
  std::optional<Projection> closest(const Eigen::Vector3d& x) const;

  /// Projection of x along the mutual normal n = (n_a − n_b)/|n_a − n_b|, which depends on the result:
  /// fixed-point iteration from the closest one. Each round shrinks the error about as the gap compares with
  /// the surface's diameter. A line that misses it on the way is led back to it; the last one must meet it.
  std::optional<std::pair<Projection, Eigen::Vector3d>> along_mutual_normal(const Eigen::Vector3d& x,
                                                                            const Eigen::Vector3d& n_a,
                                                                            double size) const;

 private:
  WorldSurface surface_;
  Eigen::KdBVH<double, 3, int> elements_;
};

}  // namespace ricochet::contact
