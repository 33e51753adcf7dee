// SPDX-License-Identifier: BSD-2-Clause
// The candidate surface of a body in its own axes: a tree of its elements, built once, and their neighbours,
// by which a point that moves along the surface is followed from element to element.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// Where a point is above a surface, or a point on it.
struct Foot {
  int element = -1;
  std::array<double, 3> weight{};   ///< of the corners of the element
  Eigen::Vector3d point{0, 0, 0};   ///< on the curved element [m]
  Eigen::Vector3d normal{0, 0, 0};  ///< unit, out of the surface, towards the point
  double distance = 0;              ///< along the normal [m]; negative inside
  void archive(auto& a) { a(element, weight, point, normal, distance); }
};

class BodySurface {
 public:
  explicit BodySurface(const kernels::Kernel& kernel);
  explicit BodySurface(WorldSurface surface);  ///< in its axes

  const WorldSurface& surface() const { return projection_.surface(); }
  const Eigen::AlignedBox3d& box() const { return box_; }
  double largest_element() const { return largest_element_; }  ///< its longest edge [m]
  /// The longest edge of the elements around a node [m].
  double element_size(int node) const { return size_at_[static_cast<std::size_t>(node)]; }
  /// The same between nodes: it changes steadily from element to element.
  double element_size(const Foot& foot) const noexcept {
    const auto& corner = surface().element[static_cast<std::size_t>(foot.element)].corner;
    double out = 0;
    for (std::size_t j = 0; j < 3; ++j) out += foot.weight[j] * element_size(corner[j]);
    return out;
  }

  /// The foot of x, by a search through the tree. @param within  farther elements are not found; without one,
  /// the element is −1 [m] @param guess  an element that may be near, or −1
  Foot closest(const Eigen::Vector3d& x, double within = std::numeric_limits<double>::infinity(),
               int guess = -1) const noexcept;
  /// The foot of x near an earlier one.
  Foot follow(const Foot& earlier, const Eigen::Vector3d& x) const noexcept;

  /// The foot, or if its normal does not suit, the nearest one that suits on the faces beside a crease that
  /// is as near to x, to within a small share of an element. @param suits  whether a body may touch the
  /// surface along a normal
  template <class Suits>
  Foot settle(const Foot& foot, const Eigen::Vector3d& x, Suits suits) const noexcept {
    if (suits(foot.normal)) return foot;
    constexpr std::size_t most = 16;  // elements around a node, and more
    std::array<int, most> seen{foot.element};
    std::size_t count = 1;
    const double reach = (x - foot.point).norm() + near_crease(foot);
    Foot out = foot;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count; ++k)
      for (const int beside : neighbour_[static_cast<std::size_t>(seen[k])]) {
        if (beside < 0 || count == most ||
            std::count(seen.begin(), seen.begin() + static_cast<long>(count), beside) > 0)
          continue;
        const Foot there = foot_on(beside, x);
        const double distance = (x - there.point).norm();
        if (distance > reach) continue;
        seen[count++] = beside;
        if (distance >= least || !suits(there.normal)) continue;
        least = distance;
        out = there;
      }
    return out;
  }

  /// The highest point of the curved surface around an element, by climbing from element to element, also on
  /// creases and at nodes. Its distance is 0.
  Foot summit(int element, const Height& height) const noexcept;
  /// By how much the surface bends down from a summit towards the nodes around it, at least: twice the drop
  /// over the square of the way [1/m].
  double bend_down(const Foot& summit, const Height& height) const noexcept;
  /// The highest points towards n in their surroundings where the surface is curved, if they are higher than
  /// `least` (n·x), highest first. @param out  is filled up to its capacity
  void summits(const Eigen::Vector3d& n, double least, std::vector<Foot>& out) const noexcept;
  /// By how much the curved surface may rise over its nodes [m].
  double camber() const { return camber_; }

  /// Whether a foot is on a crease, at a node of one, or on the end of the surface.
  bool is_at_crease(const Foot& foot) const noexcept;
  /// The point of the surface at the end of a way along it [m]. Its distance is 0.
  Foot beside(const Foot& foot, const Eigen::Vector3d& way) const noexcept;
  /// W (3,3) with dn = W dx along the element of a foot [1/m].
  Eigen::Matrix3d curvature(const Foot& foot) const noexcept;

  /// Largest rise of the surface around a node towards n: its steepest edge, as a sine. A surface that
  /// touches something at the node alone falls away from it.
  double rise(int node, const Eigen::Vector3d& n) const noexcept;
  /// The nodes that share an edge with one.
  std::span<const int> around(int node) const { return part(around_, first_, node); }

 private:
  Foot foot_on(int element, const Eigen::Vector3d& x) const noexcept;
  Eigen::Vector3d on_chords(const Foot& foot) const noexcept;
  Eigen::Vector3d normal_at(int element, const std::array<double, 3>& weight) const noexcept;
  double near_crease(const Foot& foot) const noexcept;
  bool is_peak(int node, const Eigen::Vector3d& n) const noexcept;
  /// Visits the elements that share the edge or the corner at which a foot is.
  template <class Visit>
  void visit_beside(const Foot& foot, Visit visit) const noexcept {
    const auto e = static_cast<std::size_t>(foot.element);
    for (std::size_t j = 0; j < 3; ++j) {
      if (foot.weight[j] == 1)
        for (const int beside : elements_at(surface().element[e].corner[j]))
          if (beside != foot.element) visit(beside);
      if (foot.weight[(j + 2) % 3] == 0 && foot.weight[j] < 1 && foot.weight[(j + 1) % 3] < 1 &&
          neighbour_[e][j] >= 0)
        visit(neighbour_[e][j]);
    }
  }
  std::span<const int> elements_at(int node) const { return part(elements_at_, first_element_, node); }
  template <class T>
  static std::span<const T> part(const std::vector<T>& all, const std::vector<int>& first, int node) {
    const auto at = static_cast<std::size_t>(node);
    return {all.data() + first[at], static_cast<std::size_t>(first[at + 1] - first[at])};
  }

  SurfaceProjection projection_;
  Eigen::AlignedBox3d box_;
  double largest_element_ = 0, camber_ = 0;
  std::vector<double> size_at_;                ///< (nodes) longest edge of the elements around it [m]
  std::vector<std::array<int, 3>> neighbour_;  ///< across the edge from corner j to the next; −1: none
  std::vector<std::array<bool, 3>> crease_;    ///< whether the surface has a crease there, or ends
  std::vector<char> at_crease_;                ///< (nodes) whether one of its edges is one of these
  std::vector<int> first_;                     ///< (nodes + 1) of each node's neighbours
  std::vector<int> around_;                    ///< nodes that share an edge with it
  std::vector<Eigen::Vector3d> edges_;         ///< unit, towards them
  std::vector<int> first_element_;             ///< (nodes + 1) of each node's elements
  std::vector<int> elements_at_;
};

/// The points of two segments that are closest to each other: their places along p0–p1 and q0–q1, of 0 to 1
/// within them; false if the segments are parallel.
bool crossing(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& q0,
              const Eigen::Vector3d& q1, double& s, double& t) noexcept;

}  // namespace ricochet::contact
