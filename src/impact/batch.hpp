// SPDX-License-Identifier: BSD-2-Clause
// Many impacts of one scene in one process, for ricochet sweep.
#pragma once

#include <iosfwd>

#include "src/console/options.hpp"

namespace ricochet::impact {

/// Reads requests from `in`, one JSON object a line, until `in` ends. Answers each with a line on `out`. The
/// requests are:
///
///     {"set": ["bodies.upper.velocity=[0,-6,0]"]}   run the impact, with these overrides after those of the
///                                   options
///     {"set": […], "keep": ["force", "receivers", "acceleration", "gauges", "bodies", "energy"]}
///                                   the same, and return these records (contact/files/records.hpp)
///     {"set": [], "kernels": true}                  list the kernels that the impact needs
///     {"set": [], "kernels": true, "derive": ["…"]}
///                                   the same, after deriving missing kernels from these files
///
/// The answers are:
///
///     {"status": 0, "summary": {…}}                 keys of summary.json
///     {"histories": 5120, "status": 0, "summary": {…}}
///                                   an HDF5 file of so many bytes follows this line
///     {"status": 0, "summary": {…}, "meets": true, "chosen": ["accuracy=off", "bodies.upper.order=3", …]}
///                                   of a scene with accuracy. meets: whether the error is below it, or
///                                   nothing touches; chosen: overrides with which the scene needs no
///                                   estimate
///     {"status": 0, "kernels": [{"file": "…", "there": true}, …], "reads": {…}, "settings": "…"}
///                                   reads: sampled responses and histories; settings: the file of the
///                                   settings of a scene with accuracy that names none. Kernels of the
///                                   coarser mesh, for estimates, are listed too
///     {"status": 2, "error": "…"}                   the request was refused; 1: the computation failed
///
/// A damaged kernel counts as missing, but a kernel of a newer format is an error. A request that is not a
/// JSON object has status 2. Kernels and placements are kept between impacts, and results are not written.
/// Returns 0.
int run_batch(const console::Options& options, std::istream& in, std::ostream& out);

}  // namespace ricochet::impact
