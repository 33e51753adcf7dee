// SPDX-License-Identifier: BSD-2-Clause
// ricochet-contact as a function: from a scene and its bodies' kernels to a result file and a summary.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::programs {

/// Runs the scene and writes `<out>/<slug>.result.h5`, `<out>/<slug>.summary.json` and a `.wav` for each
/// receiver; prints the main figures to `out` unless quiet, the resolved scene alone with `dry_run`. Returns
/// 0. Throws InputError for a bad scene or a folder that can't be written, and as run_impact does.
int run_contact(const console::Options& options, std::ostream& out);

}  // namespace ricochet::programs
