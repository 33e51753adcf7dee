# SPDX-License-Identifier: BSD-2-Clause
# Two ranks leave out what takes long and shows for whole spectra what other tests show for parts. Most modes of a rod are found by
# each rank in slices of its own (/1), not by all ranks together (/0).
add_mpi_tests(modes modes NOT_ON_TWO Eps.of_other_types_* Search.finds_no_elastic_* Factorisation.in_low_rank_*
    *of_which_most_modes_are_wanted/0
  FILES slicing products operators checkpoint factorisation eps modes certificate search)
# These take minutes; two ranks, which form teams, reach nearly all that one or three do.
set_tests_properties(modes.np1 modes.np3 PROPERTIES LABELS "mpi;long")
add_ranks(modes 4 --gtest_filter=Restart.*)  # two teams of two ranks
