# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(surface surface
  FILES lift locate patches sources trace)
