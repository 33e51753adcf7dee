add_mpi_test(elasticity patch)
