// SPDX-License-Identifier: BSD-2-Clause
// The options of time stepping.
#pragma once

#include "ricochet/scheme.hpp"

namespace ricochet {

struct StepOptions {
  ContactScheme contact{};
  RigidBodies rigid{};  ///< finite rotations: of the compliant scheme
  double step = 0;      ///< Δ [s]
  /// Number of contact steps Δ per output sample. In free flight, the compliant scheme jumps from sample to
  /// sample; it makes contact steps only where a point could close.
  int steps_per_sample = 1;
  /// Length of a look-ahead block: the number of steps of the compliant scheme computed by one matrix
  /// product. 1 turns blocks off; 0 chooses the length from the number of points. The result is the same to
  /// round-off.
  int block = 0;
  /// Precision of the products of a block. State, contact and rigid motion stay in double precision.
  Precision precision = Precision::float64;
  /// Whether q, q̇ and the energy ledger are known after each step. Otherwise, blocks are faster, but only
  /// forces are known after each step; the rest is known at the end of a block and after catch_up(). With
  /// loads that vary, this is always on.
  bool every_state = true;
};

}  // namespace ricochet
