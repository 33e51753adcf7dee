// ricochet-contact as a function: from a scene and its bodies' kernels to a result file and a summary.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::programs {

/// Runs the scene and writes `<out>/<slug>.result.h5`, `<out>/<slug>.summary.json` and a `.wav` for each
/// receiver; prints the main figures to `out` unless quiet, the resolved scene alone with `dry_run`. Returns
/// 0. Throws InputError, one line that starts with the scene's or another file's name: bad scenes; kernels
/// that are missing or of another scene; bodies that overlap or don't meet; contact problems without
/// solution; bodies that nothing holds at rest. Throws SolverError when the motion stops being finite, or
/// Uzawa's iteration takes too long.
int run_contact(const console::Options& options, std::ostream& out);

}  // namespace ricochet::programs
