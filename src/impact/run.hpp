// SPDX-License-Identifier: BSD-2-Clause
// ricochet-contact as a function: reads a scene and the kernels of its bodies, writes a result file and a
// summary.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::impact {

/// Runs the scene and writes `<out>/<slug>.result.h5`, `<out>/<slug>.summary.json` and a `.wav` for each
/// receiver. Prints the main figures to `out` unless `quiet` is set. With `dry_run`, prints only the resolved
/// scene. Returns 0. Throws InputError for an invalid scene, for a folder that cannot be written, and in the
/// same cases as run_impact.
int run_contact(const console::Options& options, std::ostream& out);

}  // namespace ricochet::impact
