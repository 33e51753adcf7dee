// SPDX-License-Identifier: BSD-2-Clause
// The path of the loads of bodies at rest, in stages along which all loads change in proportion.
#pragma once

#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// All loads at one instant.
struct LoadCase {
  double time = 0;  ///< [s]; orders the knots of histories, and nothing moves at any speed
  Vector load;      ///< (N) modal force [kg^1/2 m/s²]
  Vector s;         ///< (n) displacement by loads beyond the modes and by supports [m]
  Vector belt;      ///< (n) tangential displacement of half-spaces [m]

  /// The same loads, if not the same time.
  bool equals(const LoadCase& other) const {
    return load == other.load && s == other.s && belt == other.belt;
  }
};

/// Begins with the bodies unloaded, supports and half-spaces where they are at t = 0. The second case is the
/// preload: gravity, and loads as they were before t = 0. After it come the knots of all histories in
/// ascending order, without those at which no load has changed. Where a load jumps, there are two cases.
std::vector<LoadCase> load_path(const Model& model);

/// The case at a share of the way from `a` to `b`; exactly `b` for a share of 1.
LoadCase between(const LoadCase& a, const LoadCase& b, double share);

}  // namespace ricochet::contact
