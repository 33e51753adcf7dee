// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the tables [bodies.NAME.material] and [bodies.NAME.material.GROUP].
#pragma once

#include <string>

#include "src/scene/data/material.hpp"

namespace ricochet::scene {

class Table;

/// Reads the material of one group, or of the whole body if `group` is empty. Throws InputError, also for
/// constants that contradict each other or store no energy.
Material read_material(const Table& table, const std::string& group);

}  // namespace ricochet::scene
