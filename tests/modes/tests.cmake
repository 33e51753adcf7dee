add_mpi_test(modes factorisation)
add_mpi_test(modes modes)
add_mpi_test(modes slicing)
add_mpi_test(modes sphere)
