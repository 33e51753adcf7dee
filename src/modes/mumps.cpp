// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/mumps.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

using parallel::check;

namespace {

constexpr int job_init = -1, job_end = -2, host_works = 1;

}  // namespace

Mumps::Mumps(MPI_Comm comm, Symmetry symmetry) {
  MPI_Comm_dup(comm, &comm_);
  id_.sym = static_cast<MUMPS_INT>(symmetry);
  id_.par = host_works;
  id_.comm_fortran = MPI_Comm_c2f(comm_);
  id_.job = job_init;
  dmumps_c(&id_);
  succeed("start");
  // Disables output, and ScaLAPACK at the root, which would hide a part of the inertia.
  for (int k : {1, 2, 3}) icntl(k) = -1;
  icntl(4) = 0;
  icntl(13) = 1;
}

Mumps::~Mumps() {
  id_.job = job_end;
  dmumps_c(&id_);
  MPI_Comm_free(&comm_);
}

void Mumps::take_users_options() {
  const auto refuse = [](const std::string& option) {
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));
    if (given)
      throw InputError(fmt::format(
          "PETSC_OPTIONS: {}: would change the inertia counts that prove the modes: leave it out", option));
  };
  // A root in ScaLAPACK, Schur complements, null pivots, discarded factors and low rank; then the thresholds
  // of null and static pivots, and of low rank.
  for (int k : {13, 19, 24, 25, 31, 35, 36}) refuse(fmt::format("-mat_mumps_icntl_{}", k));
  for (int k : {3, 4, 5, 7}) refuse(fmt::format("-mat_mumps_cntl_{}", k));
  for (int k : {4, 6, 8, 10, 12, 14, 22, 23, 58}) {
    PetscInt value = 0;
    PetscBool given = PETSC_FALSE;
    check(
        PetscOptionsGetInt(nullptr, nullptr, fmt::format("-mat_mumps_icntl_{}", k).c_str(), &value, &given));
    if (given) icntl(k) = static_cast<MUMPS_INT>(value);
  }
  if (icntl(4) > 0)
    for (int k : {1, 2, 3}) icntl(k) = 6;
  PetscReal threshold = 0;
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetReal(nullptr, nullptr, "-mat_mumps_cntl_1", &threshold, &given));
  if (given) cntl(1) = threshold;
}

void Mumps::run(Job job, const char* task) {
  id_.job = static_cast<MUMPS_INT>(job);
  dmumps_c(&id_);
  succeed(task);
}

bool Mumps::factor(const char* task) {
  constexpr int singular = -10, more_integers = -8, more_reals = -9;
  for (int attempt = 0; attempt < 5; ++attempt) {
    id_.job = static_cast<MUMPS_INT>(Job::factor);
    dmumps_c(&id_);
    if (infog(1) == singular) return false;
    if (infog(1) != more_integers && infog(1) != more_reals) break;
    icntl(14) = 2 * std::max<MUMPS_INT>(icntl(14), 20);
  }
  succeed(task);
  return true;
}

void Mumps::succeed(const char* task) const {
  const int code = infog(1);
  if (code >= 0) return;
  const bool memory = code == -7 || code == -8 || code == -9 || code == -13 || code == -19;
  throw SolverError(fmt::format("MUMPS could not {} (INFOG(1) = {}, INFOG(2) = {}){}", task, code, infog(2),
                                memory ? ": not enough memory, use more ranks or a coarser mesh" : ""));
}

}  // namespace ricochet::modes
