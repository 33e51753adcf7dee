// SPDX-License-Identifier: BSD-2-Clause
// Refuses an impact that does not fit into memory before it starts, because the system would kill it without
// a word.
#pragma once

#include <string>

#include "src/scene/scene.hpp"

namespace ricochet::programs {

/// Throws InputError if `needed` [bytes] exceeds 0.8 of the memory of the machine, or of what `ulimit -v`
/// allows.
/// @param purpose  what needs it
/// @param remedy  settings that need less
void check_memory(const scene::Scene& scene, const std::string& purpose, double needed,
                  const std::string& remedy);

}  // namespace ricochet::programs
