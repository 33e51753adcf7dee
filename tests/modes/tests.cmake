# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(modes modes
  FILES slicing products operators checkpoint factorisation eps modes certificate search)
# These take minutes; two ranks, which form teams, reach nearly all that one or three do.
set_tests_properties(modes.np1 modes.np3 PROPERTIES LABELS "mpi;long")
add_ranks(modes 4 --gtest_filter=Restart.*)  # two teams of two ranks
