// SPDX-License-Identifier: BSD-2-Clause
// MPI, PETSc and SLEPc: a scope for the session, owners of handles, checked calls, and errors that all ranks
// throw together.
#pragma once

#include <petscsys.h>
#include <slepceps.h>

#include <cstdint>
#include <functional>
#include <source_location>
#include <string>
#include <utility>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::parallel {

/// Initialises MPI, PETSc and SLEPc until the end of the scope. Must be the first local variable of `main`;
/// all handles must be destroyed before it. PETSc takes its options from PETSC_OPTIONS, never from the
/// arguments of the program.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  /// Whether all ranks call this within a few seconds. A rank that has failed calls it to find out whether
  /// the others may still wait for it in a collective call.
  bool is_called_on_all_ranks() const;

 private:
  MPI_Comm failed_ = MPI_COMM_NULL;
};

/// Receives the progress of a long task: `done` of `total` parts. May be called on one rank or on all.
using Progress = std::function<void(std::int64_t done, std::int64_t total)>;

int rank_of(MPI_Comm comm);
int size_of(MPI_Comm comm);
MPI_Comm comm_of(Mat matrix);

/// Throws SolverError with the message of PETSc and the caller's line unless `code` is 0.
void check(PetscErrorCode code, std::source_location at = std::source_location::current());

/// Collective. Returns if `complaint` is empty on every rank; otherwise every rank throws InputError with the
/// complaint of the lowest rank that has one.
void agree(MPI_Comm comm, const std::string& complaint);

/// Collective. Runs `task` on every rank. If it throws InputError on some ranks, all ranks throw as in
/// `agree`.
template <class Task>
void on_all_ranks(MPI_Comm comm, Task&& task) {
  std::string complaint;
  try {
    task();
  } catch (const InputError& error) {
    complaint = error.what();
  }
  agree(comm, complaint);
}

/// Collective. Runs `task` on rank 0; an InputError there is thrown on every rank.
template <class Task>
void on_first_rank(MPI_Comm comm, Task&& task) {
  on_all_ranks(comm, [&] {
    if (rank_of(comm) == 0) task();
  });
}

/// Move-only owner of a PETSc or SLEPc object. Throws if a null handle is used, because passing it to a call
/// would crash.
template <class Raw, PetscErrorCode (*Destroy)(Raw*)>
class Handle {
 public:
  Handle() = default;
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      raw_ = std::exchange(other.raw_, nullptr);
    }
    return *this;
  }
  operator Raw() const {
    if (raw_ == nullptr) throw SolverError("internal: a PETSc object was used before it was made");
    return raw_;
  }
  /// Returns the address to which PETSc writes a new object.
  Raw* out() {
    reset();
    return &raw_;
  }

 private:
  void reset() noexcept {
    if (raw_ != nullptr) Destroy(&raw_);
    raw_ = nullptr;
  }
  Raw raw_ = nullptr;
};

/// The MPI datatype of several consecutive doubles.
class RowType {
 public:
  RowType() = default;
  explicit RowType(int doubles) {
    MPI_Type_contiguous(doubles, MPI_DOUBLE, &type_);
    MPI_Type_commit(&type_);
  }
  ~RowType() {
    if (type_ != MPI_DATATYPE_NULL) MPI_Type_free(&type_);
  }
  RowType(RowType&& other) noexcept : type_(std::exchange(other.type_, MPI_DATATYPE_NULL)) {}
  RowType& operator=(RowType&& other) noexcept {
    std::swap(type_, other.type_);
    return *this;
  }
  operator MPI_Datatype() const { return type_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

using Matrix = Handle<Mat, MatDestroy>;
using Vector = Handle<Vec, VecDestroy>;

/// Converts to PETSc's integer; throws SolverError if the value does not fit (use a build of PETSc with
/// 64-bit indices).
PetscInt petsc_int(std::int64_t value);

void sum(MPI_Comm comm, double* values, std::size_t count);  ///< over all ranks, in place
/// Sums the doubles of a vector, array or matrix over all ranks, in place.
template <class Values>
void sum(MPI_Comm comm, Values& values) {
  sum(comm, values.data(), static_cast<std::size_t>(values.size()));
}
std::int64_t sum(MPI_Comm comm, std::int64_t value);
std::int64_t sum_before(MPI_Comm comm, std::int64_t value);  ///< over the ranks before this one
double largest(MPI_Comm comm, double value);

/// Sends one vector to each rank, and returns the vectors received from each rank. Collective.
template <class T>
std::vector<std::vector<T>> exchange(MPI_Comm comm, const std::vector<std::vector<T>>& to);
/// Concatenates the vectors of all ranks on rank 0; empty elsewhere. Collective.
template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& mine);
/// Copies a vector or a text of one rank to every rank. Collective.
template <class Values>
void broadcast(MPI_Comm comm, Values& values, int from = 0);
/// Returns the value of one rank on every rank. T is a number or a struct of numbers. Collective.
template <class T>
T of_rank(MPI_Comm comm, int rank, T value) {
  MPI_Bcast(&value, sizeof value, MPI_BYTE, rank, comm);
  return value;
}

}  // namespace ricochet::parallel
