// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the table [modes].
#pragma once

#include "src/scene/scene.hpp"

namespace ricochet::scene {

class Table;

/// Reads [modes] of `root`; `accuracy`, if given, may choose what the table leaves open. Throws InputError.
Modes read_modes(Table& root, const std::optional<double>& accuracy = {});

}  // namespace ricochet::scene
