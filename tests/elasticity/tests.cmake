# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(elasticity elasticity
  FILES expected_size patch)
