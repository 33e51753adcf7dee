// SPDX-License-Identifier: BSD-2-Clause
#include "contact/simd/simd.hpp"

#include "base/processor.hpp"

namespace ricochet::contact::simd {

extern const InstructionSet baseline;
#ifdef RICOCHET_SIMD_X86
extern const InstructionSet avx2, avx512;
#endif

std::span<const InstructionSet* const> available() noexcept {
#ifdef RICOCHET_SIMD_X86
  static constexpr const InstructionSet* all[] = {&baseline, &avx2, &avx512};
  if (!base::supports_avx2()) return std::span(all).first(1);
  if (!base::supports_avx512()) return std::span(all).first(2);
#else
  static constexpr const InstructionSet* all[] = {&baseline};
#endif
  return all;
}

}  // namespace ricochet::contact::simd
