// SPDX-License-Identifier: BSD-2-Clause
// Configuration of OpenBLAS.
#pragma once

namespace ricochet::parallel {

/// Must be the first call of `main`. Limits OpenBLAS to one thread per rank, and lets it choose again with
/// OPENBLAS_CORETYPE set if its routines leave AVX-512 or AVX2 of the processor unused. Settings of the
/// environment take precedence.
///
/// OpenBLAS 0.3.21 of Debian 12 identifies processors by their model numbers, and may fall back to routines
/// for older ones on those released later: with "Prescott" (2004), matrix products take three times as long,
/// and factorisations twice as long.
void prepare_blas();

}  // namespace ricochet::parallel
