// SPDX-License-Identifier: BSD-2-Clause
// Available memory.
#pragma once

#include "src/parallel/parallel.hpp"

namespace ricochet::parallel {

/// Memory that each rank may still allocate [MiB], the minimum over all ranks: the available memory of the
/// machine, or the rest of the limit of the control group, divided by the number of ranks on the machine.
/// Collective.
double available_mib(MPI_Comm comm);

}  // namespace ricochet::parallel
