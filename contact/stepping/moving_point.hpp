// SPDX-License-Identifier: BSD-2-Clause
// A contact point of bodies that turn: what meets there now, and along which axes.
#pragma once

#include <array>

#include "contact/motion/body_surface.hpp"
#include "contact/motion/floating_body.hpp"

namespace ricochet::contact {

/// A body or an obstacle at a point.
struct Side {
  const BodySurface& shape;
  Eigen::Vector3d centre;  ///< of mass, or the origin of an obstacle, own axes [m]
  const FloatingBody& state;

  /// The end of an arm from the centre of another body, in the axes of that one, as a place in own axes [m].
  Eigen::Vector3d place_of(const Eigen::Vector3d& arm, const Side& other) const {
    return state.axes.transpose() * (other.state.position + other.state.axes * arm - state.position) + centre;
  }
  /// Whether a foot is on a crease of an obstacle. The points of the crease follow it along the crease and
  /// have the normal of what it touches, while a point that is pressed in there would be nearer to one of its
  /// faces.
  bool is_left_to_creases(const Foot& foot) const noexcept {
    return shape.surface().is_rigid && shape.is_at_crease(foot);
  }
};

struct MovingPoint {
  /// A candidate over a half-space, or over another body or an obstacle with a surface; a summit, where a
  /// surface that is curved is nearest to what it meets, and which moves along it; creases that cross.
  enum class Kind : char { half_space, summit, candidate_of_a, candidate_of_b, creases };
  /// On one of its bodies, or on an obstacle.
  struct End {
    int body = -1;
    int solid = -1;                  ///< number of an obstacle with a surface, in place of a body
    int count = 0;                   ///< 0 on an obstacle
    std::array<int, 3> candidate{};  ///< `count` of them, with weights above 0 whose sum is 1
    std::array<double, 3> weight{};
    // In the middle of a step, in the axes of the body
    Eigen::Vector3d arm{0, 0, 0};
    Eigen::Matrix3d direction{};  ///< its rows: those of the point, with the sign of the end

    /// Takes those of some candidates of the body that have a weight.
    void set(const std::array<int, 3>& candidates, const std::array<double, 3>& weights) noexcept;
    void archive(auto& a) { a(body, count, candidate, weight, arm, direction); }
  };

  Kind kind = Kind::half_space;
  int pair = 0;
  int candidate = 0;                 ///< of its own body
  int tangential = -1;               ///< its first tangential row
  double gap = 0;                    ///< g [m]
  Eigen::Vector3d place{0, 0, 0};    ///< X of the candidate, from the centre, body axes [m]
  Eigen::Vector3d initial{0, 0, 0};  ///< its place at t = 0, world [m]
  /// Rows: normal out of a, tangents. World axes over a half-space, otherwise in the axes of the other body.
  Eigen::Matrix3d row = Eigen::Matrix3d::Zero();
  /// Of a node on creases of an obstacle: its place, and the ways to the middles of the creases there [m].
  /// The point is on one of these ways.
  Eigen::Vector3d node{0, 0, 0};
  std::array<Eigen::Vector3d, 3> half{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                      Eigen::Vector3d::Zero()};
  double spread = 0;                  ///< the longest of them [m]; 0 on bodies
  Foot foot{};                        ///< on the body that a candidate or a summit meets
  Foot top{};                         ///< of a summit, on its own body
  std::array<int, 2> crease{-1, -1};  ///< that cross, of a and of b
  bool open = true;                   ///< whether its sides do not face each other, so that they cannot touch
  double distance = 0;                ///< now, without elastic displacements [m]
  Eigen::Vector3d stood{0, 0, 0};     ///< place of a summit in the step before [m]
  std::array<End, 2> end{};           ///< on a and on b
  Eigen::Vector3d place_now{0, 0, 0};  ///< of the common place, in the axes of own(), from its centre [m]
  Eigen::Matrix3d acting = Eigen::Matrix3d::Zero();  ///< its rows in the middle of the step, world axes

  /// The body on which its common place is fixed in a step, and the other one, which has its rows.
  const End& own() const { return end[kind == Kind::candidate_of_b ? 1 : 0]; }
  const End& other() const { return end[kind == Kind::candidate_of_b ? 0 : 1]; }
  int rows() const { return tangential < 0 ? 1 : 3; }
  bool over_half_space() const { return end[1].body < 0 && end[1].solid < 0; }
  /// Distance from where the half-space was at t = 0, without its elastic displacement [m].
  double height(const FloatingBody& state) const noexcept;

  /// Takes the creases of an obstacle at its candidate.
  void stand_on_creases(const WorldSurface& obstacle);
  /// Takes a foot near its place as what a candidate meets.
  void meet(const Foot& near, const Side& own, const Side& other) noexcept;
  /// Takes two creases. Returns whether they cross so that they may touch.
  bool cross(int of_a, int of_b, const Side& a, const Side& b) noexcept;
  /// Takes the summit of the surface of its body over a half-space.
  void stand_on(const Foot& summit, const Side& own) noexcept;
  /// Moves a summit between two bodies from `top` and `foot` to where the surfaces face each other.
  void face(const Side& own, const Side& other) noexcept;
  /// Follows what it meets.
  void follow(const Side& own, const Side& other) noexcept;
  /// By how much elastic displacements bring its sides nearer to each other [m].
  double nearer(const Eigen::Vector3d& of_own, const Eigen::Vector3d& of_other, const Side& own,
                const Side& other) const noexcept;

  void archive(auto& a) {
    a(kind, pair, candidate, tangential, gap, place, initial, row, foot, top, crease, open, distance, end);
    a(place_now, acting, stood);
  }

 private:
  Foot slide(Foot near, const Side& own, const Side& other) noexcept;
  void set_row(const Eigen::Vector3d& normal) noexcept;
};

}  // namespace ricochet::contact
