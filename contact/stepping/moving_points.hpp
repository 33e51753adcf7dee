// SPDX-License-Identifier: BSD-2-Clause
// The contact points of floating bodies: where they are, and the matrices of the rows that may touch in a
// step.
//
// A point is a candidate of a body, fixed in its axes, that may touch a half-space. In the step from t_k,
// with the frame (c, A) of the body, its elastic displacement w = Φq and a unit vector e of a row in world
// axes,
//
//   U = e·(x − x_0),   x = c + A (X + w)           at t_k; x_0 at t = 0
//   d = e·(Δv + ½Δ²g) + e'·(θ × r + Φ Δq),         θ = Δ J⁻¹π,   r = X + w,   e' = A½ᵀ e
//   M = e'ᵀ[ ½Δ² (1/m − r̂ J⁻¹ r̂) + Φ c Φᵀ ] e',   R = e'ᵀ R_body e'   between two points of a body
//
// U + d is û of contact/law. Only the turn e' of the rows changes from step to step: the blocks Φ c Φᵀ and
// R_body of pairs of points are gathered once, when a point joins those that may touch.
#pragma once

#include <span>
#include <vector>

#include "contact/complementarity/reserved_matrix.hpp"
#include "contact/law/contact_law.hpp"
#include "contact/motion/floating_body.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

/// The blocks (3k,3k) of a matrix between k points, in body axes. Entries are written once.
class PointBlocks {
 public:
  explicit PointBlocks(Eigen::Index points) : entries_(static_cast<std::size_t>(9 * points * points)) {}
  Eigen::Map<Eigen::Matrix3d> operator()(Eigen::Index i, Eigen::Index j) noexcept {
    return Eigen::Map<Eigen::Matrix3d>(at(i, j));
  }
  Eigen::Map<const Eigen::Matrix3d> operator()(Eigen::Index i, Eigen::Index j) const noexcept {
    return Eigen::Map<const Eigen::Matrix3d>(const_cast<PointBlocks*>(this)->at(i, j));
  }
  /// Makes room for points 0 … count − 1.
  void resize(Eigen::Index count) noexcept {
    entries_.resize(static_cast<std::size_t>(9 * count * (count + 1) / 2));
  }

 private:
  /// Rows of the lower triangle follow each other, so that points are added at the end.
  double* at(Eigen::Index i, Eigen::Index j) noexcept { return entries_.data() + 9 * (i * (i + 1) / 2 + j); }

  base::Reserved<double> entries_;
};

class MovingPoints {
 public:
  /// Allocates all memory. Throws InputError if a pair or a kernel does not allow bodies that turn.
  MovingPoints(const Model& model, const StepSystem& system);

  /// Smallest distance that a point of the body has left, whatever the phase of its modes [m]; ∞ without
  /// points.
  /// @param energy  of the elastic modes and of R, at most [J]
  double clearance(int body, const FloatingBody& state, double energy) const noexcept;
  /// Largest distance of a point from the centre of the body [m].
  double radius(int body) const { return bodies_[static_cast<std::size_t>(body)].radius; }

  /// What a body may do in an epoch.
  struct Travel {
    double energy = 0;    ///< of its elastic modes and of R, at most [J]
    double distance = 0;  ///< of a point with its frame [m]
  };
  /// Begins an epoch: watches the points that may touch in it, and those with a force. @param travels  by
  /// body
  void watch(std::span<const FloatingBody> bodies, std::span<const Travel> travels,
             const MeanForce& forces) noexcept;

  /// Computes the displacements U of all points; those of points that are not watched without the elastic
  /// part. @param q  (N)
  void place(std::span<const FloatingBody> bodies, const Vector& q) noexcept;
  /// In the middle of a step: displacements d of the watched points. Chooses the points that may touch.
  /// @param dq  (N) of the free elastic motion
  void advance(std::span<const FloatingBody> bodies, const Vector& dq, double step,
               const MeanForce& forces) noexcept;

  std::span<const int> rows() const { return rows_; }  ///< those of points that may touch
  /// By position among these rows
  const Vector& at_start() const { return start_; }  ///< U [m]
  const Vector& free() const { return free_; }       ///< U + d [m]
  const Vector& all() const { return u_; }           ///< (n) U of all rows [m]
  int body_of(std::size_t position) const {
    return points_[static_cast<std::size_t>(members_[static_cast<std::size_t>(owner_[position])])].body;
  }
  /// The matrices of a step. @param a  weight of the end in the mean; 0: S_mean is not needed
  StepMatrices matrices(std::span<const FloatingBody> bodies, double step, double a) noexcept;

  /// The forces and torques on a body, in its axes, and the forces on its modes, under p by position.
  struct Load {
    Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};
  };
  /// @param modal  (N) is added to
  Load load(int body, const Vector& p, Vector& modal) const noexcept;

 private:
  struct Point {
    int body, candidate;
    int tangential = -1;      ///< its first tangential row
    Eigen::Vector3d place;    ///< X, from the centre, body axes [m]
    Eigen::Vector3d initial;  ///< x_0, world [m]
    Eigen::Matrix3d row;      ///< unit vectors of its rows, world: normal, tangents
    double gap = 0;           ///< g [m]
    double give = 0;  ///< (Σ|φ|²/ω² + tr R)^½: it moves by at most give · (2E)^½ with the energy E [m/N^½]
  };
  struct Body {
    int number = 0;
    std::vector<int> points{};
    double radius = 0;
    const kernels::Surface* surface = nullptr;
    Eigen::Index modes = 0, elastic = 0;  ///< the elastic ones come last
    Eigen::Index first_elastic = 0;       ///< in q
    bool yields() const { return !surface->residual_flexibility.empty(); }
    /// (3,3) R between two candidates
    auto flexibility(int i, int j) const {
      const auto M = static_cast<Eigen::Index>(3 * surface->size());
      return Eigen::Map<const Matrix>(surface->residual_flexibility.data(), M, M).block<3, 3>(3 * i, 3 * j);
    }
  };
  /// Of a watched point in a step, body axes [m].
  struct Motion {
    Eigen::Vector3d place, free;  ///< r, and the free displacement
  };

  /// (3,elastic)
  auto shape_of(const Point& point) const {
    const Body& body = bodies_[static_cast<std::size_t>(point.body)];
    const double* const first = body.surface->shape.data() + 3 * point.candidate * body.modes;
    return Eigen::Map<const Matrix>(first, 3, body.modes).rightCols(body.elastic);
  }
  int rows_of(const Point& point) const { return point.tangential < 0 ? 1 : 3; }
  double height(const Point& point, const FloatingBody& state) const noexcept;
  void drop_members() noexcept;
  void join(int point) noexcept;
  void list_rows() noexcept;

  Vector c_, folded_;  ///< (N) of a step; 1/ω² of folded modes, else 0
  bool folds_ = false;
  std::vector<Body> bodies_;
  std::vector<Point> points_;
  std::vector<int> watched_;
  std::vector<char> is_watched_;           ///< (m)
  std::vector<Motion> motion_;             ///< (m), of watched points
  std::vector<int> members_;               ///< points that may touch
  std::vector<int> member_of_;             ///< (m) position among members, or −1
  PointBlocks modes_, residual_;           ///< Φ c Φᵀ and R_body, between members
  std::vector<int> rows_, owner_, along_;  ///< row, member and direction by position
  std::vector<int> tangents_at_;           ///< position of the first tangential row of each member
  Vector start_, free_, u_;
  Eigen::Matrix3Xd direction_;  ///< e' by position
  ReservedMatrix M_, R_, S_, S_mean_;
};

}  // namespace ricochet::contact
