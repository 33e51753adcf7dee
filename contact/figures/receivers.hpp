// SPDX-License-Identifier: BSD-2-Clause
// The motion of the model's receivers at the end of each step, as a sensor glued to the body would measure
// it.
#pragma once

#include <utility>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/motion/coriolis.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Motion of one receiver, in its axes.
struct ReceiverMotion {
  Eigen::Vector3d displacement{0, 0, 0};  ///< of the modes and of all static corrections [m]
  Eigen::Vector3d velocity{0, 0, 0};      ///< of the modes, the supports and the loads that vary [m/s]
  /// The share of the modes [m/s²]. At an impulse and at a knot of a support's history, where it is
  /// undefined, the value just after.
  Eigen::Vector3d acceleration{0, 0, 0};
};

class Receivers {
 public:
  /// Starts with the motion at t = 0. `model` must outlive the receivers.
  Receivers(const Model& model, const StepOptions& options);

  std::size_t size() const { return motion_.size(); }
  const ReceiverMotion& operator[](std::size_t receiver) const { return motion_[receiver]; }

  /// Call it after each step of `stepper`. It does not allocate.
  void observe(const Stepper& stepper) noexcept;

 private:
  void update(double t, const Vector& q, const Vector& v, const Vector& force) noexcept;
  void update(double t, const Turning& turning, const Vector& q, const Vector& v) noexcept;
  std::pair<Eigen::Vector3d, Eigen::Vector3d> accelerate(int body, double t, const Turning& turning,
                                                         const Vector& q, const Vector& v) noexcept;
  ReceiverMotion elastic(std::size_t receiver, double t, const Pose& pose, const Vector& force,
                         const Vector& v) const noexcept;
  void turn(std::size_t receiver, const Eigen::Quaterniond& attitude) noexcept;

  const Model& model_;
  bool compliant_;
  std::vector<ReceiverMotion> motion_;
  Vector acceleration_;  ///< (N) q̈
  // With finite rotations
  std::vector<const kernels::Receiver*> own_;  ///< of each receiver, in body axes
  Vector q_;                                   ///< (N) with folded modes
  std::vector<Coriolis> coriolis_;             ///< by body
};

}  // namespace ricochet::contact
