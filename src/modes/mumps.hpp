// SPDX-License-Identifier: BSD-2-Clause
// Owner of one instance of MUMPS, with checked calls.
#pragma once

#include <dmumps_c.h>
#include <mpi.h>

namespace ricochet::modes {

/// One instance of the sparse direct solver MUMPS. Parameters are numbered as in its manual.
class Mumps {
 public:
  enum class Symmetry { definite = 1, indefinite = 2 };
  enum class Job { analyse = 1, factor = 2, solve = 3 };

  /// Starts an instance without output, in which the first rank works too, and which holds the whole inertia
  /// of the matrix (no ScaLAPACK at the root). Collective. Throws SolverError.
  Mumps(MPI_Comm comm, Symmetry symmetry);
  ~Mumps();
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  DMUMPS_STRUC_C& id() { return id_; }
  MUMPS_INT& icntl(int k) { return id_.icntl[k - 1]; }
  double& cntl(int k) { return id_.cntl[k - 1]; }
  MUMPS_INT infog(int k) const { return id_.infog[k - 1]; }
  MUMPS_INT info(int k) const { return id_.info[k - 1]; }

  /// Takes options from the database of PETSc, under the names that PETSc gives them. Throws InputError
  /// if one of them would change an inertia count. Those for data input have no effect.
  void take_users_options();

  /// Runs a job. `task` completes the message "MUMPS could not …". Collective. Throws SolverError.
  void run(Job job, const char* task);

  /// Factors. If the workspace is too small, because delayed pivots needed more than the analysis estimated,
  /// doubles its margin and tries again. Returns false if the matrix is singular. Collective. Throws
  /// SolverError.
  bool factor(const char* task);

 private:
  void succeed(const char* task) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  DMUMPS_STRUC_C id_{};
};

}  // namespace ricochet::modes
