# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(modes modes
  FILES approximate certificate contact_basis eps factorisation modes products search slicing sphere static_flexibility)
# Two ranks and three reach all that one does, and more.
set_tests_properties(modes.np1 PROPERTIES LABELS "mpi;long")
