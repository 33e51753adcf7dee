// SPDX-License-Identifier: BSD-2-Clause
// Sampled responses of a scene: read from a file, or computed from the modes.
#pragma once

#include <memory>

#include "src/impact/runner.hpp"

namespace ricochet::impact {

/// Adds sampled responses to the impact: reads the file that the scene names, or samples the model at all
/// steps of the impact. Throws InputError if the file cannot be read or the samples do not fit into memory.
void add_table(Impact& impact, console::Console& console);

/// Throws InputError if the responses are shorter than the impact, or in the same cases as
/// contact::TableStepper.
std::unique_ptr<contact::Stepper> table_stepper(const Impact& impact);

}  // namespace ricochet::impact
