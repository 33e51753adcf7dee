add_mpi_test(modes factorisation)
