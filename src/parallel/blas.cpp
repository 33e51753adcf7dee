// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/blas.hpp"

#include <cstdlib>
#include <cstring>

#include "base/processor.hpp"

extern "C" {
char* openblas_get_corename();
void openblas_set_num_threads(int threads);
// Only libraries with routines for several processors have these two.
[[gnu::weak]] void gotoblas_dynamic_quit();
[[gnu::weak]] void gotoblas_dynamic_init();
}

namespace ricochet::parallel {

namespace {

/// Whether the routines in use are one of these.
template <class... Names>
bool uses(Names... names) {
  return ((std::strcmp(openblas_get_corename(), names) == 0) || ...);
}

/// Routines for more of the processor's instructions than those in use; null: there are none.
const char* better_routines() {
  const bool wide = uses("SkylakeX", "Cooperlake", "SapphireRapids");
  if (base::supports_avx512() && !wide) return "SkylakeX";
  if (base::supports_avx2() && !wide && !uses("Haswell", "Zen")) return "Haswell";
  return nullptr;
}

}  // namespace

void prepare_blas() {
  if (std::getenv("OPENBLAS_NUM_THREADS") == nullptr && std::getenv("OMP_NUM_THREADS") == nullptr)
    openblas_set_num_threads(1);
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr || gotoblas_dynamic_quit == nullptr ||
      gotoblas_dynamic_init == nullptr)
    return;
  const char* const better = better_routines();
  if (better == nullptr) return;
  // OpenBLAS chooses its routines when it is loaded. These are the functions by which it does so.
  setenv("OPENBLAS_CORETYPE", better, 1);
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
}

}  // namespace ricochet::parallel
