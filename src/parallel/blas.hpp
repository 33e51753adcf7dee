// SPDX-License-Identifier: BSD-2-Clause
// OpenBLAS as it should run here.
#pragma once

namespace ricochet::parallel {

/// The first call of `main`. Restarts the program with OPENBLAS_CORETYPE set when OpenBLAS took its oldest
/// kernels on a processor that has newer instructions, and keeps it to one thread a rank; where the
/// environment says otherwise it has its way.
///
/// Debian 12's OpenBLAS 0.3.21 knows processors by their model numbers, and falls back to "Prescott" (2004)
/// on those that came after it: products of matrices then take three times as long, factorisations twice.
void prepare_blas(char** argv);

}  // namespace ricochet::parallel
