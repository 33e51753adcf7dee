# SPDX-License-Identifier: BSD-2-Clause
add_mpi_test(modes approximate)
add_mpi_test(modes certificate)
add_mpi_test(modes contact_basis)
add_mpi_test(modes factorisation)
add_mpi_test(modes modes)
add_mpi_test(modes slicing)
add_mpi_test(modes sphere)
add_mpi_test(modes static_flexibility)
