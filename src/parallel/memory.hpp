// SPDX-License-Identifier: BSD-2-Clause
// Available memory.
#pragma once

#include "src/parallel/parallel.hpp"

namespace ricochet::parallel {

/// Returns the memory that each rank may still allocate [MiB], as the minimum over all ranks. It is the
/// smaller of the available memory of the machine and the unused memory of the control group, divided by the
/// number of ranks on the machine. Collective.
double available_mib(MPI_Comm comm);

}  // namespace ricochet::parallel
