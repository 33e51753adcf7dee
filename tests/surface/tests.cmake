add_mpi_test(surface patches)
add_mpi_test(surface trace)
