// SPDX-License-Identifier: BSD-2-Clause
// Candidate surfaces in the world, and the projection of a point onto them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <unsupported/Eigen/BVH>

#include "contact/pairing/pairing.hpp"
#include "contact/pairing/round_surface.hpp"

namespace ricochet::contact {

/// Candidate surface of a body, in the world.
///
/// An element with known normals is a triangle (segment) that continues smoothly in its neighbours,
///
///   x(w) = Σ_j w_j x_j + 4 Σ_j w_j w_{j+1} c_j + 27 w_0 w_1 w_2 b
///
/// where c_j leads from the middle of the chord to the arc that has the normals n_j and n_{j+1} at its ends:
/// c_j = m (d·n_{j+1} − d·n_j)/(4 + 2|n_j + n_{j+1}|), d = x_{j+1} − x_j, m = (n_j + n_{j+1})/|n_j +
/// n_{j+1}|. This is exact for circles. On a crease, c_j satisfies this on both sides. b, along the mean
/// normal, takes the slope away that the triangle has across the middles of its edges, towards (n_j +
/// n_{j+1}); it lifts the middle of the triangle, by about 1e-4 of the radius of a ball with 162 nodes.
struct WorldSurface {
  int corners = 3;
  std::vector<Eigen::Vector3d> node, normal;
  std::vector<double> area;            ///< of each patch [m²]
  std::vector<Eigen::Vector3d> crest;  ///< of each patch: x̂_i, from which its gap is measured [m]
  std::vector<double> bulge;           ///< of each patch [m]
  std::vector<std::int8_t> on_crease;  ///< of each node: 1 if sheets with different normals meet there
  struct Element {
    std::array<int, 3> corner{};
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double size = 0;  ///< longest edge [m]
    bool curved = false;
    bool round = false;                       ///< whether it approximates the closed form of its surface
    std::array<Eigen::Vector3d, 3> normal{};  ///< at the corners
    std::array<Eigen::Vector3d, 3>
        bend{};                       ///< c_j of the edge from corner j to the next [m]; 0 if not curved
    Eigen::Vector3d bubble{0, 0, 0};  ///< b [m]
    bool operator==(const Element&) const = default;
  };
  std::vector<Element> element;
  /// A crease that another body may touch, between two nodes. Faces fall away from it.
  struct Crease {
    std::array<int, 2> node{};
    std::array<Eigen::Vector3d, 2> into;  ///< unit, into each of its faces, perpendicular to the crease
    Eigen::Vector3d normal;               ///< mean of its faces, unit
    bool operator==(const Crease&) const = default;
  };
  std::vector<Crease> crease{};  ///< of triangles
  /// Adds a flat element with these corners, whose nodes must exist.
  void add(Element of_corners);
  /// Position in an element at these weights of its corners.
  Eigen::Vector3d at(const Element& element, const std::array<double, 3>& weight) const;
  /// W (3,3) with dn = W dx on an element, at a point of it [1/m].
  Eigen::Matrix3d curvature(const Element& element, const Eigen::Vector3d& point) const noexcept;
  /// Of a round element, the point of the closed form that is closest to x; no value beyond its ends.
  std::optional<RoundSurface::At> on_form(const Element& element, const Eigen::Vector3d& x) const noexcept;

  bool is_rigid = false;                ///< an obstacle, without candidates
  std::optional<RoundSurface> round{};  ///< closed form of the round elements of an obstacle
  double extent = 0;                    ///< diagonal of the nodes' bounding box [m]
  double farthest = 0;  ///< largest |coordinate| of a node, in the world and in the body's own frame [m]
  bool operator==(const WorldSurface&) const = default;
};

/// A point on a candidate surface, given by weights of the corners of an element.
struct Projection {
  Eigen::Vector3d point, normal;
  std::array<int, 3> corner{};
  std::array<double, 3> weight{};
  int element = -1;
};

/// Derives the curvature of elements and the creases from the normals at their corners.
void bend_elements(WorldSurface& surface);

/// The surface of an obstacle that has one, in the world.
WorldSurface placed(const Obstacle& obstacle);

/// A line that is farther than this from the centre of an element does not intersect it [m].
double radius_of(const WorldSurface::Element& element);

/// Size of the smallest element of a surface [m]; infinite without elements.
double smallest_element(const WorldSurface& surface);

/// Weights of the corners of an element at the point of its chords that is closest to x.
std::array<double, 3> closest_weights(const WorldSurface& surface, const WorldSurface::Element& element,
                                      const Eigen::Vector3d& x);

/// How high a place is over what a surface meets: over a plane, or over a surface that falls away from it.
struct Height {
  Eigen::Vector3d up;                                   ///< unit
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< W of that surface [1/m]
  Eigen::Vector3d at = Eigen::Vector3d::Zero();         ///< over its foot [m]
  double of(const Eigen::Vector3d& x) const noexcept { return up.dot(x) - drop(x); }
  double drop(const Eigen::Vector3d& x) const noexcept { return 0.5 * (x - at).dot(curvature * (x - at)); }
};

/// Weights of the corners of a triangle, curved or not, at its highest point.
std::array<double, 3> highest_weights(const WorldSurface& surface, const WorldSurface::Element& element,
                                      const Height& height) noexcept;

/// Square of the distance of a point from a flat triangle [m²].
double square_distance(const Eigen::Vector3d& x, const std::array<Eigen::Vector3d, 3>& triangle);

/// By how much an obstacle bulges towards a patch of this area beyond its mean over the patch [m]: the mean
/// of x·Wx/2, with the mean of |x|² over the hat of a node of equilateral triangles, which is A/(2√3).
double bulge_under(double area, const Eigen::Matrix3d& curvature) noexcept;

/// All candidates of the body, including those that its kernel omits.
WorldSurface surface_of(const PlacedBody& body);

/// Reference length for round-off [m]. Rods have no extent; for them it is a metre plus their distance from
/// the origin.
double size_of(const WorldSurface& a, const WorldSurface& b);

/// Projects points onto a surface by a search through a tree of boxes around its elements. Among equally good
/// projections, the one on the first element is chosen. Points of round elements are on their closed form.
class SurfaceProjection {
 public:
  explicit SurfaceProjection(WorldSurface surface);
  const WorldSurface& surface() const { return surface_; }
  const Eigen::KdBVH<double, 3, int>& elements() const { return elements_; }  ///< of indices of elements

  /// Returns the intersection of the line x + t d with the surface that satisfies `faces` and has the
  /// smallest |t|.
  ///
  /// Triangles are intersected along d, curved ones by Newton's method. Segments represent strips that extend
  /// sideways: seen along d, the line is projected perpendicularly onto the segment and may pass it at up to
  /// half its length. The line hits a point if it passes within 1e-6 of `size`.
  std::optional<Projection> first_along(const Eigen::Vector3d& x, const Eigen::Vector3d& d, double size,
                                        const std::function<bool(const Projection&)>& faces) const;

  /// Returns the point closest to x on the chords of the elements, or no value if there are none within a
  /// distance or the normals at the corners cancel.
  std::optional<Projection> closest(const Eigen::Vector3d& x,
                                    double within = std::numeric_limits<double>::infinity()) const;

  /// Projects x along the mutual normal n = (n_a − n_b)/|n_a − n_b|. This normal depends on the result, so it
  /// is found by fixed-point iteration from the closest point. Each round reduces the error by about the
  /// ratio of the gap to the diameter of the surface. If the line of an intermediate round misses the
  /// surface, the closest point of the surface is used; the last line must intersect it. A point on a crease
  /// has no normal of its own: there, n = −n_b.
  std::optional<std::pair<Projection, Eigen::Vector3d>> along_mutual_normal(const Eigen::Vector3d& x,
                                                                            const Eigen::Vector3d& n_a,
                                                                            bool on_crease,
                                                                            double size) const;

 private:
  WorldSurface surface_;
  Eigen::KdBVH<double, 3, int> elements_;
};

}  // namespace ricochet::contact
