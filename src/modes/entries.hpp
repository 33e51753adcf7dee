// SPDX-License-Identifier: BSD-2-Clause
// Entries of K and M in the form that MUMPS takes, and the order of elimination.
#pragma once

#include <petscmat.h>

#include <cstdint>
#include <vector>

namespace ricochet::modes {

/// The upper triangles of K and M on this rank, as triplets with one pattern. Rows and columns are global and
/// begin at 1, as in Fortran.
struct Entries {
  /// Copies the matrices. Collective on their ranks. Throws SolverError if their patterns differ.
  /// @param stiffness, mass  SBAIJ with the same pattern
  Entries(Mat stiffness, Mat mass);

  std::vector<int> row, column;
  std::vector<double> stiffness, mass;
  std::int64_t rows = 0, local_rows = 0, first = 0;  ///< of the matrices; first row of this rank, from 0
  int block = 1;                                     ///< displacements of a node
};

/// Orders the elimination by nested dissection of the nodes (METIS). The MUMPS of Debian offers only PORD,
/// whose factors have up to twice as many entries.
/// @return on the first rank, the place of each row in the order, from 1; empty elsewhere. Collective on
/// `comm`, the ranks of the matrices.
std::vector<int> order_of_elimination(MPI_Comm comm, const Entries& entries);

}  // namespace ricochet::modes
