// SPDX-License-Identifier: BSD-2-Clause
// Memory of the steps of an impact, before they are made.
#pragma once

#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Sizes of a model that need not exist yet.
struct ModelSize {
  Eigen::Index rows = 0, points = 0, modes = 0;  ///< n, m, N
  Eigen::Index near = 0;  ///< rows of points that may touch; the matrices of blocks hold them again
  std::size_t pairs = 1;  ///< if there are several, islands hold the matrices of their rows once more
  bool has_residual = false;
  bool two_sided = false;  ///< whether a pair has a second body
  bool turns = false;      ///< whether bodies turn, so that the model has no matrices
};

/// Memory of a model [bytes]: of B, R and, if a pair has two bodies, R_a.
double model_bytes(const ModelSize& size);

/// Memory of the stepper that make_stepper returns, in use [bytes]. All that has fewer than two large
/// dimensions is left out.
double stepper_bytes(const ModelSize& size, const StepOptions& options);

}  // namespace ricochet::contact
