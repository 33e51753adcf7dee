// SPDX-License-Identifier: BSD-2-Clause
// ricochet-recast as a function: rescales or truncates a kernel file.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::programs {

struct RecastOptions {
  std::filesystem::path kernel;
  std::filesystem::path out;                        ///< folder; empty: that of `kernel`
  double young = 1, density = 1, scale = 1;         ///< factors
  std::optional<std::vector<std::int64_t>> points;  ///< to keep, by their numbers in `kernel`
  std::optional<Hertz> up_to;                       ///< for the new body; with flexibility_error: the band
  std::optional<std::int64_t> count;                ///< not with the other two
  std::optional<double> flexibility_error;
  bool vtk = false;  ///< write the modes for ParaView, and no kernel

  /// Whether a different kernel is requested.
  bool changes() const {
    return young != 1 || density != 1 || scale != 1 || points || up_to || count || flexibility_error;
  }
};

/// Writes `<out>/<body>-<hash>.kernel.h5` and reports it on `out`; with `vtk`, writes
/// `<body>-<hash>.modes.xdmf` and `.modes.h5` instead. Without a new band, the old one is scaled like the
/// frequencies. Returns 0. Throws InputError, one line that begins with the kernel file.
int run_recast(const RecastOptions& options, std::ostream& out);

}  // namespace ricochet::programs
