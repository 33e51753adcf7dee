// SPDX-License-Identifier: BSD-2-Clause
// ricochet-recast as a function: rescales or truncates a kernel file.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::store {

struct RecastOptions {
  std::filesystem::path kernel;
  std::filesystem::path out;                        ///< folder; empty: the folder of `kernel`
  double young = 1, density = 1, scale = 1;         ///< factors
  std::optional<std::vector<std::int64_t>> points;  ///< candidates to keep, by their numbers in `kernel`
  std::optional<Hertz> up_to;         ///< frequency for the new body; with flexibility_error: end of the band
  std::optional<std::int64_t> count;  ///< not together with up_to or flexibility_error
  std::optional<double> flexibility_error;
  bool vtk = false;  ///< write only the modes, for ParaView

  /// Whether the options request a different kernel.
  bool changes() const {
    return young != 1 || density != 1 || scale != 1 || points || up_to || count || flexibility_error;
  }
};

/// Writes `<out>/<body>-<hash>.kernel.h5` and reports it on `out`. With `vtk`, writes
/// `<body>-<hash>.modes.xdmf` and `.modes.h5` instead. If no new band is given, the old one is scaled like
/// the frequencies. Returns 0. Throws a one-line InputError that begins with the name of the kernel
/// file.
int run_recast(const RecastOptions& options, std::ostream& out);

}  // namespace ricochet::store
