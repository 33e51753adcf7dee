// SPDX-License-Identifier: BSD-2-Clause
// What the writer and the reader of kernel files agree on.
#pragma once

#include <cstdint>

namespace ricochet::kernels {

inline constexpr const char* kFormat = "ricochet-kernel";
inline constexpr std::int64_t kVersion = 1;

/// Of a load's participation; tells what its history scales.
inline constexpr const char* kTractionUnit = "kg^-1/2 m^2";
inline constexpr const char* kForceUnit = "kg^-1/2";

}  // namespace ricochet::kernels
