// SPDX-License-Identifier: BSD-2-Clause
// main of the collective tests: one session, output from every rank, failure of any rank fails the run.
#include <gtest/gtest.h>
#include <time.h>

#include "src/parallel/blas.hpp"
#include "src/parallel/parallel.hpp"

/// Open MPI calls this in place of libc's while a rank waits (mpi_yield_when_idle): ranks that wait sleep for 20 us and
/// leave the core to those that work, of which there are more than cores.
extern "C" int sched_yield() noexcept {
  const timespec pause{0, 20'000};
  nanosleep(&pause, nullptr);
  return 0;
}

int main(int argc, char** argv) {
  ricochet::parallel::prepare_blas(argv);
  testing::InitGoogleTest(&argc, argv);
  const ricochet::parallel::Session session;
  const int mine = RUN_ALL_TESTS();
  return static_cast<int>(ricochet::parallel::sum(PETSC_COMM_WORLD, std::int64_t{mine}) != 0);
}
