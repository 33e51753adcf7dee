// SPDX-License-Identifier: BSD-2-Clause
// What determines the deformation of a body, in the terms of its kernel:
//
//   u = Φ q + R_C f + (static response to gravity, loads and supports)
//
// With finite rotations, u is in the axes of the body, without its rigid motion. q are the coordinates Φᵀ M u
// of the kept modes, f the contact forces on the candidates of the body. R_C and the other static responses
// are in the kernel, for example under /view and of receivers and gauges.
#pragma once

#include <vector>

#include "contact/motion/turning.hpp"

namespace ricochet::contact {

/// Rows of a stress.
inline constexpr auto stress_rows = static_cast<Eigen::Index>(kernels::stress_rows);

/// Of one body, in its axes.
struct BodyCoordinates {
  Vector modal;    ///< (modes) q, with folded modes and the lift of supports [kg^1/2 m]
  Vector force;    ///< (rM) f on the components of candidates [N]; empty without R
  Vector load;     ///< (3L) [Pa] or [N]
  Vector motion;   ///< (3S) of supports [m]
  Vector gravity;  ///< (3) [m/s²]
};

class AllCoordinates {
 public:
  /// `model` must outlive this object.
  explicit AllCoordinates(const Model& model);

  /// Sets the coordinates of all bodies. Does not allocate.
  /// @param q, p  (N), (n) modal coordinates and forces at `time` [s]; p = 0 under impulses
  /// @param turning  of the stepper; null unless bodies turn
  void set(double time, const Vector& q, const Vector& p, const Turning* turning) noexcept;

  const BodyCoordinates& operator[](std::size_t body) const { return bodies_[body]; }

 private:
  const Model& model_;
  Vector whole_;  ///< (N)
  std::vector<BodyCoordinates> bodies_;
};

}  // namespace ricochet::contact
