// SPDX-License-Identifier: BSD-2-Clause
// The motion of bodies as a whole: that of their rigid modes, which carry all momentum of a free body and no
// vibration, or that of their frames, with finite rotations.
#pragma once

#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Displacement and rotation of a body, or their rates; 0 along and about the axes that supports hold.
struct RigidMotion {
  /// `rotation` is that of rigid modes, or the spin; 0 for the displacement of a frame.
  Eigen::Vector3d linear{0, 0, 0}, rotation{0, 0, 0}, centre{0, 0, 0};
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  /// Of a point with its initial place x; rates of bodies that turn, with its present place.
  Eigen::Vector3d at(const Eigen::Vector3d& x) const { return linear + turn * (x - centre); }
};

/// Of a minus b, of a point i of a pair, by the motion of each body. A half-space does not move.
/// @param frames  where the point is, as RigidMotion::at takes it
Eigen::Vector3d relative_at(const std::vector<RigidMotion>& motion, const Model::PairBlock& pair,
                            Eigen::Index i, const RowFrames& frames);

class RigidMotions {
 public:
  /// `model` must outlive this object.
  explicit RigidMotions(const Model& model);

  /// The motion of each body. @param state  (N) q, or q̇ for the rates
  std::vector<RigidMotion> of(const Vector& state) const;
  RigidMotion of(int body, const Vector& state) const;

  /// The displacement of each body from its initial place to that after the last step.
  std::vector<RigidMotion> displacement(const Stepper& stepper) const;
  /// The rates of each body at its place after the last step. @param state  (N) q̇
  std::vector<RigidMotion> rates(const Vector& state, const Stepper& stepper) const;

  /// The pose of a body after the last step.
  Pose pose(int body, const Stepper& stepper) const;

  /// Number of rigid modes of a body, which come first among its modes.
  Eigen::Index modes(int body) const { return bodies_[static_cast<std::size_t>(body)].rigid; }

 private:
  struct Body {
    Eigen::Index rigid = 0;
    Eigen::Matrix3d inverse_inertia;  ///< pseudo-inverse, as rods have no inertia about their axis
  };
  Eigen::Matrix3d turn(int body, const Pose& pose) const;

  const Model& model_;
  std::vector<Body> bodies_;
};

}  // namespace ricochet::contact
