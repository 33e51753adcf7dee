// SPDX-License-Identifier: BSD-2-Clause
// How much memory there is.
#pragma once

#include "src/parallel/parallel.hpp"

namespace ricochet::parallel {

/// Memory that each of the ranks may still take [MiB], the least of all ranks: what the kernel calls
/// available, or what the control group leaves, shared among the ranks of a machine. Collective.
double available_mib(MPI_Comm comm);

}  // namespace ricochet::parallel
