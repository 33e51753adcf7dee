// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/blas.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>

extern "C" {
char* openblas_get_corename();
void openblas_set_num_threads(int threads);
}

namespace ricochet::parallel {

void prepare_blas(char** argv) {
  if (std::getenv("OPENBLAS_NUM_THREADS") == nullptr && std::getenv("OMP_NUM_THREADS") == nullptr)
    openblas_set_num_threads(1);
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr || std::strcmp(openblas_get_corename(), "Prescott") != 0)
    return;
  const char* better = nullptr;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) better = "Haswell";
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    better = "SkylakeX";
  if (better == nullptr) return;
  // OpenBLAS chooses its routines when it is loaded, so another choice requires a new process. If execv
  // fails, the program continues with the slow ones.
  setenv("OPENBLAS_CORETYPE", better, 1);
  execv("/proc/self/exe", argv);
}

}  // namespace ricochet::parallel
