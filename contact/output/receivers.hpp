// SPDX-License-Identifier: BSD-2-Clause
// The motion of the model's receivers at the end of each step: what a sensor glued to the body would see.
#pragma once

#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// World axes.
struct ReceiverMotion {
  Eigen::Vector3d displacement{0, 0, 0};  ///< modes and all quasi-static parts [m]
  Eigen::Vector3d velocity{0, 0, 0};      ///< modes, supports, and loads that change [m/s]
  /// Modes [m/s²]. Impulses and kinks of a support's history are instants without one; it is that just after.
  Eigen::Vector3d acceleration{0, 0, 0};
};

class Receivers {
 public:
  /// `model` outlives the receivers. Their motion is that of t = 0.
  Receivers(const Model& model, const StepOptions& options);

  std::size_t size() const { return motion_.size(); }
  const ReceiverMotion& operator[](std::size_t receiver) const { return motion_[receiver]; }

  /// After a step of `stepper`. Takes no memory.
  void observe(const Stepper& stepper) noexcept;

 private:
  void update(double t, const Vector& q, const Vector& v, const Vector& force) noexcept;

  const Model& model_;
  bool compliant_;
  std::vector<Model::Receiver> receivers_;  ///< modes that steps do not sample moved into their statics
  std::vector<ReceiverMotion> motion_;
  Vector acceleration_;  ///< (N) q̈
};

}  // namespace ricochet::contact
