# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(modes modes
  FILES approximate certificate contact_basis eps factorisation modes products search slicing sphere static_flexibility)
