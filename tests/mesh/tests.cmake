# SPDX-License-Identifier: BSD-2-Clause
add_mpi_tests(mesh mesh
  FILES child distribute extent foreign parts pieces read reference refine split_refused straighten
  ALONE Child Foreign Families/Reference Faces Lattice Unsupported Read Refine Inverted)
set_tests_properties(mesh.np2 PROPERTIES LABELS "mpi;long")  # as those of tests/surface
# By itself, because gmsh does not read the file after one with a syntax error.
add_mpi_tests(mesh_refusals mesh FILES refusals)
set_tests_properties(mesh_refusals.np1 mesh_refusals.np2 PROPERTIES LABELS "mpi;long")
