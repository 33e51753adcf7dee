// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [modes].
#pragma once

#include "src/scene/data/modes.hpp"

namespace ricochet::scene {

class Table;

/// Reads [modes] of `root`.
/// @param may_stay_open  whether the band or the number of modes may be missing
/// Throws InputError.
Modes read_modes(const Table& root, bool may_stay_open = false);

}  // namespace ricochet::scene
