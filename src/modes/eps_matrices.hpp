// SPDX-License-Identifier: BSD-2-Clause
// K and M of any type of PETSc, copied into the form of the engine.
#pragma once

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// K − aM and M as SBAIJ with one pattern. Blocks have the size of those of the given matrices if it is 3,
/// and 1 otherwise.
struct Pair {
  parallel::Matrix stiffness, mass;
};

/// Copies the upper triangles. Collective. Throws SolverError if a matrix cannot be converted to AIJ.
/// @param stiffness, mass  symmetric; no mass stands for the identity
/// @param origin  a
Pair paired(Mat stiffness, Mat mass, double origin);

}  // namespace ricochet::modes
