// SPDX-License-Identifier: BSD-2-Clause
// Table kernels of a scene: read from a file, or sampled from its modes.
#pragma once

#include <memory>

#include "src/programs/impact_runner.hpp"

namespace ricochet::programs {

/// Adds the table: that of the scene's file, or the model's for all steps of the impact. Throws InputError
/// when the file can't be read, or the samples would not fit into memory.
void add_table(Impact& impact, console::Console& console);

/// Throws InputError when the table is shorter than the impact, or as contact::TableStepper does.
std::unique_ptr<contact::Stepper> table_stepper(const Impact& impact);

}  // namespace ricochet::programs
