// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <thread>

#include "base/memory.hpp"

static_assert(!PetscDefined(USE_COMPLEX), "ricochet needs a real build of PETSc");

namespace ricochet::parallel {

namespace {

/// MPI counts are of type int, so longer vectors are sent in pieces.
constexpr std::size_t piece_bytes = std::size_t{1} << 30;

std::string last_message;

/// Stores the innermost message for `check` instead of printing a trace from every rank.
PetscErrorCode keep_message(MPI_Comm, int, const char* function, const char*, PetscErrorCode code,
                            PetscErrorType kind, const char* message, void*) {
  if (kind == PETSC_ERROR_INITIAL)
    last_message = fmt::format("{}: {}", function, message != nullptr ? message : "");
  return code;
}

/// Sends bytes to one rank and receives bytes from another at the same time.
void pass_bytes(MPI_Comm comm, const void* out, std::size_t out_bytes, int to, void* in, std::size_t in_bytes,
                int from) {
  const char* out_at = static_cast<const char*>(out);
  char* in_at = static_cast<char*>(in);
  for (std::size_t done = 0; done < std::max(out_bytes, in_bytes); done += piece_bytes) {
    const std::size_t sent = std::min(done, out_bytes), got = std::min(done, in_bytes);
    MPI_Sendrecv(out_at + sent, static_cast<int>(std::min(piece_bytes, out_bytes - sent)), MPI_BYTE,
                 sent < out_bytes ? to : MPI_PROC_NULL, 0, in_at + got,
                 static_cast<int>(std::min(piece_bytes, in_bytes - got)), MPI_BYTE,
                 got < in_bytes ? from : MPI_PROC_NULL, 0, comm, MPI_STATUS_IGNORE);
  }
}

}  // namespace

Session::Session() {
  // A program without mpirun would start a daemon of Open MPI, which it does not need: it starts no further
  // ranks. It also needs no folder for talking to them, and MPI_Init fails if two programs make theirs at
  // once.
  if (getenv("PMIX_RANK") == nullptr) {
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  }
  int count = 0;
  char** none = nullptr;
  check(SlepcInitialize(&count, &none, nullptr, nullptr));
  // SuperLU_DIST, which PETSc loads, lets the allocator keep all memory that is freed.
  base::return_large_blocks();
  check(PetscPushErrorHandler(keep_message, nullptr));
  MPI_Comm_dup(PETSC_COMM_WORLD, &failed_);
  // Options that are intended for another program of the batch job must not cause output.
  check(PetscOptionsSetValue(nullptr, "-options_left", "no"));
}

Session::~Session() {
  MPI_Comm_free(&failed_);
  PetscPopErrorHandler();
  SlepcFinalize();
}

bool Session::is_called_on_all_ranks() const {
  constexpr std::chrono::milliseconds patience{3000}, pause{10};
  const auto end = std::chrono::steady_clock::now() + patience;
  MPI_Request all = MPI_REQUEST_NULL;
  MPI_Ibarrier(failed_, &all);
  for (int done = 0;;) {
    MPI_Test(&all, &done, MPI_STATUS_IGNORE);
    if (done != 0) return true;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(pause);
  }
}

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

MPI_Comm comm_of(Mat matrix) {
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm));
  return comm;
}

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

void check(PetscErrorCode code, std::source_location at) {
  if (code == 0) return;
  throw SolverError(fmt::format("{}:{}: PETSc error {}: {}", at.file_name(), at.line(),
                                static_cast<int>(code), std::exchange(last_message, {})));
}

void agree(MPI_Comm comm, const std::string& complaint) {
  const int mine = complaint.empty() ? std::numeric_limits<int>::max() : rank_of(comm);
  int first = mine;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == std::numeric_limits<int>::max()) return;
  std::string text = complaint;
  broadcast(comm, text, first);
  throw InputError(text);
}

PetscInt petsc_int(std::int64_t value) {
  if (value > static_cast<std::int64_t>(PETSC_MAX_INT) || value < 0)
    throw SolverError(
        fmt::format("{} does not fit PETSc's integers: use a 64-bit-index build of PETSc", value));
  return static_cast<PetscInt>(value);
}

void sum(MPI_Comm comm, double* values, std::size_t count) {
  constexpr std::size_t piece = std::size_t{1} << 26;
  for (std::size_t done = 0; done < count; done += piece)
    MPI_Allreduce(MPI_IN_PLACE, values + done, static_cast<int>(std::min(piece, count - done)), MPI_DOUBLE,
                  MPI_SUM, comm);
}

std::int64_t sum(MPI_Comm comm, std::int64_t value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, comm);
  return value;
}

std::int64_t sum_before(MPI_Comm comm, std::int64_t value) {
  std::int64_t before = 0;
  MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  return rank_of(comm) == 0 ? 0 : before;  // MPI_Exscan leaves it undefined on the first rank
}

double largest(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

template <class T>
std::vector<std::vector<T>> exchange(MPI_Comm comm, const std::vector<std::vector<T>>& to) {
  const int ranks = size_of(comm), me = rank_of(comm);
  std::vector<std::uint64_t> out(static_cast<std::size_t>(ranks)), in(out.size());
  for (std::size_t r = 0; r < out.size(); ++r) out[r] = to[r].size();
  MPI_Alltoall(out.data(), 1, MPI_UINT64_T, in.data(), 1, MPI_UINT64_T, comm);
  std::vector<std::vector<T>> from(out.size());
  from[static_cast<std::size_t>(me)] = to[static_cast<std::size_t>(me)];
  // In step s, each rank sends to the rank s positions ahead.
  for (int step = 1; step < ranks; ++step) {
    const int next = (me + step) % ranks, last = (me + ranks - step) % ranks;
    std::vector<T>& got = from[static_cast<std::size_t>(last)];
    got.resize(in[static_cast<std::size_t>(last)]);
    const std::vector<T>& sent = to[static_cast<std::size_t>(next)];
    pass_bytes(comm, sent.data(), sent.size() * sizeof(T), next, got.data(), got.size() * sizeof(T), last);
  }
  return from;
}

template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& mine) {
  std::vector<std::vector<T>> to(static_cast<std::size_t>(size_of(comm)));
  to[0] = mine;
  std::vector<T> all;
  for (const std::vector<T>& part : parallel::exchange(comm, to))
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

template <class Values>
void broadcast(MPI_Comm comm, Values& values, int from) {
  std::uint64_t count = values.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, from, comm);
  values.resize(count);
  const std::size_t bytes = count * sizeof(values[0]);
  char* at = reinterpret_cast<char*>(values.data());
  for (std::size_t done = 0; done < bytes; done += piece_bytes)
    MPI_Bcast(at + done, static_cast<int>(std::min(piece_bytes, bytes - done)), MPI_BYTE, from, comm);
}

template std::vector<char> gather(MPI_Comm, const std::vector<char>&);
template std::vector<int> gather(MPI_Comm, const std::vector<int>&);
template std::vector<std::int64_t> gather(MPI_Comm, const std::vector<std::int64_t>&);
template std::vector<double> gather(MPI_Comm, const std::vector<double>&);
template std::vector<std::vector<double>> exchange(MPI_Comm, const std::vector<std::vector<double>>&);
template std::vector<std::vector<std::int64_t>> exchange(MPI_Comm,
                                                         const std::vector<std::vector<std::int64_t>>&);
template void broadcast(MPI_Comm, std::string&, int);
template void broadcast(MPI_Comm, std::vector<char>&, int);
template void broadcast(MPI_Comm, std::vector<double>&, int);
template void broadcast(MPI_Comm, std::vector<std::int64_t>&, int);

}  // namespace ricochet::parallel
