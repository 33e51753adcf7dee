// SPDX-License-Identifier: BSD-2-Clause
// The exception types of every layer.
#pragma once

#include <stdexcept>
#include <string>

namespace ricochet {

/// Bad input: a scene, a mesh, a file. `what()` is one line that states where the problem is, what was found
/// and what to do. Programs print it once and end with status 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A computation that broke down on valid input (a factorisation, an eigensolver). Programs end with status
/// 1.
struct SolverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace ricochet
