// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [modes].
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

class Table;

/// Reads [modes] of `root`. If `accuracy` is given, keys that the table does not set may remain open. Throws
/// InputError.
Modes read_modes(Table& root, const std::optional<double>& accuracy = {});

}  // namespace ricochet::scene
