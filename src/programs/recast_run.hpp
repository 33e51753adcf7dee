// SPDX-License-Identifier: BSD-2-Clause
// ricochet-recast as a function: from a kernel file to that of a similar body, or of less of it.
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
  std::optional<Hertz> up_to;                       ///< of the new body; with flexibility_error: of the band
  std::optional<std::int64_t> count;                ///< not with the other two
  std::optional<double> flexibility_error;
  bool vtk = false;  ///< write the modes for ParaView, and no kernel

  /// Whether another kernel is asked for.
  bool changes() const {
    return young != 1 || density != 1 || scale != 1 || points || up_to || count || flexibility_error;
  }
};

/// Writes `<out>/<body>-<hash>.kernel.h5` and tells of it on `out`. A band that is not given grows with the
/// frequencies. With `vtk`, `<body>-<hash>.modes.xdmf` and `.modes.h5` instead. Returns 0. Throws InputError,
/// one line that begins with the kernel's file.
int run_recast(const RecastOptions& options, std::ostream& out);

}  // namespace ricochet::programs
