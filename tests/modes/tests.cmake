# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(modes modes
  FILES approximate certificate contact_basis eps factorisation modes products search slicing sphere static_flexibility)
# These take minutes; two ranks, which form teams, reach nearly all that one or three do.
set_tests_properties(modes.np1 modes.np3 PROPERTIES LABELS "mpi;long")
# Two teams of two ranks.
add_test(NAME modes.np4 COMMAND ${MPIEXEC} --allow-run-as-root --oversubscribe -n 4 $<TARGET_FILE:test_modes> --gtest_filter=Restart.*)
set_tests_properties(modes.np4 PROPERTIES TIMEOUT 600 LABELS mpi PROCESSORS 4 ENVIRONMENT "${one_thread};${waiting}")
