# SPDX-License-Identifier: BSD-2-Clause
add_mpi_test(mesh distribute)
add_mpi_test(mesh extent)
add_mpi_test(mesh order_reduction)
add_mpi_test(mesh parts)
add_mpi_test(mesh read)
add_mpi_test(mesh reference)
add_mpi_test(mesh refusals)
add_mpi_test(mesh split_refused)
