# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(reduction reduction FILES contact_basis static_flexibility coriolis)
set_tests_properties(reduction.np1 reduction.np3 PROPERTIES LABELS "mpi;long")  # as those of tests/modes
