/* SPDX-License-Identifier: BSD-2-Clause */
/* Replaces sched_yield of libc in the tests. Open MPI calls it while a rank waits (mpi_yield_when_idle). Tests run on fewer
 * cores than ranks, so a waiting rank sleeps and leaves its core to a working rank. */
#define _POSIX_C_SOURCE 199309L
#include <time.h>

int sched_yield(void);

int sched_yield(void) {
  const struct timespec pause = {0, 20000};
  return nanosleep(&pause, 0);
}
