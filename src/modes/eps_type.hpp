// SPDX-License-Identifier: BSD-2-Clause
// The engine as a type of SLEPc's EPS. Its public interface is include/ricochet/eps.h.
#pragma once

#include <exception>

#include "ricochet/eps.h"
#include "src/modes/checkpoint.hpp"
#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// What a caller within this program already has, instead of the matrices of the EPS.
struct Engine {
  const parallel::Teams& teams;
  const Operators& operators;
  Factorisation& factor;
  const Request& request;
  const Checkpoint& checkpoint;
  const Progress& progress;
  ModeSet found{};             ///< result; the EPS itself keeps nothing, because each team has other modes
  std::exception_ptr error{};  ///< what stopped the solve
};

/// Makes the next solve of an EPS of this type use `engine`, which must outlive it.
void use_engine(EPS eps, Engine& engine);

}  // namespace ricochet::modes
