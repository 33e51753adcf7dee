// SPDX-License-Identifier: BSD-2-Clause
#pragma once

namespace ricochet {

/// Limits of the weakest material of a body, by which runs are judged.
struct MaterialLimits {
  double young = 0;  ///< smallest E [Pa]; 0: unknown
  double yield = 0;  ///< smallest stress at which one yields [Pa]; 0: unknown
};

}  // namespace ricochet
