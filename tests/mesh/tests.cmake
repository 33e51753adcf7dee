add_mpi_test(mesh distribute)
add_mpi_test(mesh read)
add_mpi_test(mesh reference)
add_mpi_test(mesh refusals)
