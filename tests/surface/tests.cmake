# SPDX-License-Identifier: BSD-2-Clause
add_mpi_test(surface patches)
add_mpi_test(surface lift)
add_mpi_test(surface sources)
add_mpi_test(surface trace)
