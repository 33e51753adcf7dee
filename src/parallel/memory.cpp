// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/memory.hpp"

#include "base/memory.hpp"

namespace ricochet::parallel {

double available_mib(MPI_Comm comm) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const double mine = base::available_bytes() / base::mib / size_of(machine);
  MPI_Comm_free(&machine);
  return -largest(comm, -mine);
}

}  // namespace ricochet::parallel
