// SPDX-License-Identifier: BSD-2-Clause
// Free flight: if no point can close before the next output sample, the modes are advanced to it in one exact
// jump instead of many contact steps.
//
// Between knots of histories, the energy E_b = Σ ω²y² + ẏ² of the elastic modes of a frequency band, with y
// about the rest position (forced_response.hpp), never grows. It bounds the motion of a point in two ways,
// over the modes of each band:
//
//   |Σ B y| ≤ (Σ B²/ω²)^½ E_b^½,    |Σ B ÿ| ≤ (Σ B²(ω + 2δ)²)^½ E_b^½
//
// The first bound is cheap. Points that it does not clear are evaluated at both ends of the jump; between
// them, u departs from its chord by at most T² max |ü|/8, and by at most twice the first bound.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/stepping/modal_state.hpp"

namespace ricochet::contact {

class FreeFlight {
 public:
  /// Allocates all memory; the other functions allocate nothing.
  FreeFlight(const StepSystem& system, const StepOptions& options);

  /// Advances the state from contact step k, at which no force acts, to the next output sample. Returns the
  /// number of contact steps crossed. Returns 0 and changes nothing if a point might close meanwhile, if a
  /// history has a knot meanwhile, if the state is not finite, or if each contact step is a sample.
  int cross(ModalState& state, std::int64_t k) noexcept;

 private:
  void set_constants(const StepSystem& system, int steps) noexcept;
  Work advance(ModalState& state) const noexcept;
  bool stays_open(const ModalState& state, double time) noexcept;

  double step_;
  int per_sample_, constants_of_ = 0;
  ModeConstants over_;        ///< (N) of the jump: b, c, e, h and the damping integrals
  std::vector<int> elastic_;  ///< modes with ω > 0 that are sampled, by frequency
  std::vector<int> rigid_;
  std::vector<int> last_;        ///< of each band: one past its last mode in elastic_
  Eigen::MatrixXd reach_, bow_;  ///< (m,bands) bounds on u and on its departure from the chord, per E_b^½
  Vector y_, rate_;              ///< (N) q and q̇ about the rest position under loads
  Vector size_, bound_;          ///< (bands) E_b^½; (m) bound on the elastic part of u
};

}  // namespace ricochet::contact
