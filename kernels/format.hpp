// SPDX-License-Identifier: BSD-2-Clause
// Constants shared by the writer and the reader of kernel files.
#pragma once

#include <cstdint>

namespace ricochet::kernels {

inline constexpr const char* kFormat = "ricochet-kernel";
inline constexpr std::int64_t kVersion = 1;

/// Unit of the participation of a load, from which the reader recognises the kind of load.
inline constexpr const char* kTractionUnit = "kg^-1/2 m^2";
inline constexpr const char* kForceUnit = "kg^-1/2";

}  // namespace ricochet::kernels
