// What the writer and the reader of kernel files agree on.
#pragma once

#include <cstdint>

namespace ricochet::kernels {

inline constexpr const char* kFormat = "ricochet-kernel";
inline constexpr std::int64_t kVersion = 1;

}  // namespace ricochet::kernels
