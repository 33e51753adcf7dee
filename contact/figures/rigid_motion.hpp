// SPDX-License-Identifier: BSD-2-Clause
// The motion of bodies as a whole: that of their rigid modes, which carry all momentum of a free body and no
// vibration.
#pragma once

#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Displacement and rotation of a body, or their rates; 0 along and about the axes that supports hold.
struct RigidMotion {
  Eigen::Vector3d linear{0, 0, 0}, rotation{0, 0, 0}, centre{0, 0, 0};
  Eigen::Vector3d at(const Eigen::Vector3d& x) const { return linear + rotation.cross(x - centre); }
};

class RigidMotions {
 public:
  /// `model` must outlive this object.
  explicit RigidMotions(const Model& model);

  /// The motion of each body. @param state  (N) q, or q̇ for the rates
  std::vector<RigidMotion> of(const Vector& state) const;
  RigidMotion of(int body, const Vector& state) const;

  /// Number of rigid modes of a body, which come first among its modes.
  Eigen::Index modes(int body) const { return bodies_[static_cast<std::size_t>(body)].rigid; }

 private:
  struct Body {
    Eigen::Index rigid = 0;
    Eigen::Matrix3d inverse_inertia;  ///< pseudo-inverse, as rods have no inertia about their axis
  };
  const Model& model_;
  std::vector<Body> bodies_;
};

}  // namespace ricochet::contact
