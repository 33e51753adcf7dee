// SPDX-License-Identifier: BSD-2-Clause
// Configuration of OpenBLAS.
#pragma once

namespace ricochet::parallel {

/// Must be the first call of `main`. Limits OpenBLAS to one thread per rank, and lets it choose again with
/// OPENBLAS_CORETYPE set if it chose its oldest routines on a processor with newer instructions. Settings of
/// the environment take precedence.
///
/// OpenBLAS 0.3.21 of Debian 12 identifies processors by their model numbers and falls back to "Prescott"
/// (2004) for processors released later. Matrix products then take three times as long, and factorisations
/// twice as long.
void prepare_blas();

}  // namespace ricochet::parallel
