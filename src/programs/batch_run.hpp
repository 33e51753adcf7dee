// SPDX-License-Identifier: BSD-2-Clause
// Many impacts of one scene in one process, for ricochet sweep.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::programs {

/// Reads requests from `in`, a line of JSON each, and answers each by a line on `out`, until `in` ends:
///
///     {"set": ["bodies.upper.velocity=[0,-6,0]"]}   run the impact, with these overrides after those of the
///                                   options
///     {"set": [], "kernels": true}                  list the kernels that the impact needs
///     {"set": [], "kernels": true, "derive": ["…"]}
///                                   the same, after writing the missing kernels that follow from these files
///
///     {"status": 0, "summary": {…}}                 keys of summary.json
///     {"status": 0, "kernels": [{"file": "…", "there": true}, …], "reads": {…}}
///                                   reads: tables and histories. A damaged kernel counts as missing; one of
///                                   a newer format is refused
///     {"status": 2, "error": "…"}                   the request was refused; 1: the computation failed
///
/// Kernels and placements are kept between impacts. Results are not written. The answer to a request that is
/// not a JSON object has status 2. Returns 0.
int run_batch(const console::Options& options, std::istream& in, std::ostream& out);

}  // namespace ricochet::programs
