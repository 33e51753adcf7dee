// Candidate surfaces in the world, and the places on them that a point faces.
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

/// A place on a candidate surface.
struct Place {
  Eigen::Vector3d point, normal;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{};
};

/// All candidates of the body, also those that its kernel does not hold.
WorldSurface surface_of(const PlacedBody& body);

/// What round-off is measured by [m]. Rods have no extent; then a metre counts, and how far out they are.
double size_of(const WorldSurface& a, const WorldSurface& b);

/// A surface that is looked for, by a tree of boxes around its elements. Of places that are equally good the
/// one on the first element counts.
class Target {
 public:
  explicit Target(WorldSurface surface);
  const WorldSurface& surface() const { return surface_; }

  /// Of the places where the line x + t d meets the surface and `faces` holds, the one with the smallest |t|.
  ///
  /// Triangles are met by projection along d. Segments stand for strips that extend sideways, so the place is
  /// the one abreast of the line along the segment as seen along d, and the line may pass beside it by half
  /// the segment's length. Points are met within 1e-6 of `size`.
  std::optional<Place> first_along(const Eigen::Vector3d& x, const Eigen::Vector3d& d, double size,
                                   const std::function<bool(const Place&)>& faces) const;

  /// The place closest to x; none where there are no elements, or their corners' normals cancel.
  std::optional<Place> closest(const Eigen::Vector3d& x) const;

  /// The place that x faces along the mutual normal n = (n_a − n_b)/|n_a − n_b|, which depends on the place:
  /// fixed-point iteration from the closest one. Each round shrinks the error about as the gap compares with
  /// the surface's diameter. A line that misses it on the way is led back to it; the last one must meet it.
  std::optional<std::pair<Place, Eigen::Vector3d>> along_mutual_normal(const Eigen::Vector3d& x,
                                                                       const Eigen::Vector3d& n_a,
                                                                       double size) const;

 private:
  WorldSurface surface_;
  Eigen::KdBVH<double, 3, int> elements_;
};

}  // namespace ricochet::contact
