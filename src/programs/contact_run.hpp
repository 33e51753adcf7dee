// SPDX-License-Identifier: BSD-2-Clause
// ricochet-contact as a function: from a scene and its bodies' kernels to a result file and a summary.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::programs {

/// Runs the scene and writes `<out>/<slug>.result.h5`, `<out>/<slug>.summary.json` and a `.wav` for each
/// receiver. Prints the main figures to `out` unless quiet; with `dry_run`, prints only the resolved scene.
/// Returns 0. Throws InputError for an invalid scene or a folder that cannot be written, and as run_impact
/// does.
int run_contact(const console::Options& options, std::ostream& out);

}  // namespace ricochet::programs
