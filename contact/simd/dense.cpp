// SPDX-License-Identifier: BSD-2-Clause
#include "contact/simd/dense.hpp"

#include "base/processor.hpp"

namespace ricochet::contact::simd {

extern const Dense dense_baseline;
#ifdef RICOCHET_SIMD_X86
extern const Dense dense_avx2, dense_avx512;
#endif

const Dense& dense() noexcept {
#ifdef RICOCHET_SIMD_X86
  if (base::supports_avx512()) return dense_avx512;
  if (base::supports_avx2()) return dense_avx2;
#endif
  return dense_baseline;
}

}  // namespace ricochet::contact::simd
