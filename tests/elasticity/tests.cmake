# SPDX-License-Identifier: BSD-2-Clause
add_mpi_test(elasticity expected_size)
add_mpi_test(elasticity patch)
