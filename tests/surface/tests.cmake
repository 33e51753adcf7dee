# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(surface surface
  FILES gauges lift locate mesh_error patches sources trace)
set_tests_properties(surface.np1 surface.np2 PROPERTIES LABELS "mpi;long")  # three ranks reach what fewer do
