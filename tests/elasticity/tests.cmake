# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(elasticity elasticity
  FILES assemble expected_size law matrix_file patch rigid surplus ALONE ExpectedSize FiguresOfALaw)
set_tests_properties(elasticity.np1 elasticity.np2 PROPERTIES LABELS "mpi;long")  # as those of tests/surface
