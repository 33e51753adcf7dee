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
  /// Adds an element with these corners, whose nodes must exist.
  void add(Element of_corners);
  double extent = 0;    ///< diagonal of the nodes' bounding box [m]
  double farthest = 0;  ///< largest |coordinate| of a node, in the world and in the body's own frame [m]
  bool operator==(const WorldSurface&) const = default;
};

/// A point on a candidate surface, given by weights of the corners of an element.
struct Projection {
  Eigen::Vector3d point, normal;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{};
};

/// All candidates of the body, including those that its kernel omits.
WorldSurface surface_of(const PlacedBody& body);

/// Reference length for round-off [m]. Rods have no extent; for them it is a metre plus their distance from
/// the origin.
double size_of(const WorldSurface& a, const WorldSurface& b);

/// Projects points onto a surface by a search through a tree of boxes around its elements. Among equally good
/// projections, the one on the first element is chosen.
class SurfaceProjection {
 public:
  explicit SurfaceProjection(WorldSurface surface);
  const WorldSurface& surface() const { return surface_; }

  /// Returns the intersection of the line x + t d with the surface that satisfies `faces` and has the
  /// smallest |t|.
  ///
  /// Triangles are intersected along d. Segments represent strips that extend sideways: seen along d, the
  /// line is projected perpendicularly onto the segment and may pass it at up to half its length. The line
  /// hits a point if it passes within 1e-6 of `size`.
  std::optional<Projection> first_along(const Eigen::Vector3d& x, const Eigen::Vector3d& d, double size,
                                        const std::function<bool(const Projection&)>& faces) const;

  /// Returns the point closest to x, or no value if there are no elements or the normals at the corners
  /// cancel.
  std::optional<Projection> closest(const Eigen::Vector3d& x) const;

  /// Projects x along the mutual normal n = (n_a − n_b)/|n_a − n_b|. This normal depends on the result, so it
  /// is found by fixed-point iteration from the closest point. Each round reduces the error by about the
  /// ratio of the gap to the diameter of the surface. If the line of an intermediate round misses the
  /// surface, the closest point of the surface is used; the last line must intersect it.
  std::optional<std::pair<Projection, Eigen::Vector3d>> along_mutual_normal(const Eigen::Vector3d& x,
                                                                            const Eigen::Vector3d& n_a,
                                                                            double size) const;

 private:
  WorldSurface surface_;
  Eigen::KdBVH<double, 3, int> elements_;
};

}  // namespace ricochet::contact
