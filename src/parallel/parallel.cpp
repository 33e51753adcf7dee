// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

static_assert(!PetscDefined(USE_COMPLEX), "ricochet needs a real build of PETSc");

namespace ricochet::parallel {

namespace {

/// MPI counts are of type int: longer vectors are sent in pieces.
constexpr std::size_t piece_bytes = std::size_t{1} << 30;

std::string last_message;

/// Stores the innermost message for `check` instead of printing a trace from every rank.
PetscErrorCode keep_message(MPI_Comm, int, const char* function, const char*, PetscErrorCode code,
                            PetscErrorType kind, const char* message, void*) {
  if (kind == PETSC_ERROR_INITIAL)
    last_message = fmt::format("{}: {}", function, message != nullptr ? message : "");
  return code;
}

void send_bytes(MPI_Comm comm, const void* data, std::size_t bytes, int to) {
  const char* at = static_cast<const char*>(data);
  for (std::size_t sent = 0; sent < bytes; sent += piece_bytes)
    MPI_Send(at + sent, static_cast<int>(std::min(piece_bytes, bytes - sent)), MPI_BYTE, to, 0, comm);
}

void receive_bytes(MPI_Comm comm, void* data, std::size_t bytes, int from = 0) {
  char* at = static_cast<char*>(data);
  for (std::size_t got = 0; got < bytes; got += piece_bytes)
    MPI_Recv(at + got, static_cast<int>(std::min(piece_bytes, bytes - got)), MPI_BYTE, from, 0, comm,
             MPI_STATUS_IGNORE);
}

void broadcast_bytes(MPI_Comm comm, void* data, std::size_t bytes) {
  char* at = static_cast<char*>(data);
  for (std::size_t done = 0; done < bytes; done += piece_bytes)
    MPI_Bcast(at + done, static_cast<int>(std::min(piece_bytes, bytes - done)), MPI_BYTE, 0, comm);
}

/// Sends to one rank while another sends to this one.
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
  int count = 0;
  char** none = nullptr;
  check(SlepcInitialize(&count, &none, nullptr, nullptr));
  check(PetscPushErrorHandler(keep_message, nullptr));
  // Options that are meant for another program of the batch job must not cause output.
  check(PetscOptionsSetValue(nullptr, "-options_left", "no"));
}

Session::~Session() {
  PetscPopErrorHandler();
  SlepcFinalize();
}

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
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
  std::int64_t length = static_cast<std::int64_t>(complaint.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, first, comm);
  std::string text = complaint;
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, first, comm);
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

double largest(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

template <class T>
std::vector<T> scatter(MPI_Comm comm, const std::vector<std::vector<T>>& per_rank) {
  if (rank_of(comm) == 0) {
    for (int to = 1; to < size_of(comm); ++to) {
      const std::uint64_t count = per_rank[to].size();
      MPI_Send(&count, 1, MPI_UINT64_T, to, 0, comm);
      send_bytes(comm, per_rank[to].data(), count * sizeof(T), to);
    }
    return per_rank[0];
  }
  std::uint64_t count = 0;
  MPI_Recv(&count, 1, MPI_UINT64_T, 0, 0, comm, MPI_STATUS_IGNORE);
  std::vector<T> mine(count);
  receive_bytes(comm, mine.data(), count * sizeof(T));
  return mine;
}

template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& mine) {
  std::vector<std::uint64_t> size(static_cast<std::size_t>(size_of(comm)));
  const std::uint64_t own = mine.size();
  MPI_Gather(&own, 1, MPI_UINT64_T, size.data(), 1, MPI_UINT64_T, 0, comm);
  if (rank_of(comm) != 0) {
    send_bytes(comm, mine.data(), own * sizeof(T), 0);
    return {};
  }
  std::vector<T> all = mine;
  for (std::size_t from = 1; from < size.size(); ++from) {
    const std::size_t start = all.size();
    all.resize(start + size[from]);
    receive_bytes(comm, all.data() + start, size[from] * sizeof(T), static_cast<int>(from));
  }
  return all;
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
void broadcast(MPI_Comm comm, std::vector<T>& values) {
  std::uint64_t count = values.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, 0, comm);
  values.resize(count);
  broadcast_bytes(comm, values.data(), count * sizeof(T));
}

void broadcast(MPI_Comm comm, std::string& text) {
  std::vector<char> bytes(text.begin(), text.end());
  broadcast(comm, bytes);
  text.assign(bytes.begin(), bytes.end());
}

template std::vector<double> scatter(MPI_Comm, const std::vector<std::vector<double>>&);
template std::vector<std::int64_t> scatter(MPI_Comm, const std::vector<std::vector<std::int64_t>>&);
template std::vector<char> gather(MPI_Comm, const std::vector<char>&);
template std::vector<int> gather(MPI_Comm, const std::vector<int>&);
template std::vector<std::int64_t> gather(MPI_Comm, const std::vector<std::int64_t>&);
template std::vector<double> gather(MPI_Comm, const std::vector<double>&);
template std::vector<std::vector<double>> exchange(MPI_Comm, const std::vector<std::vector<double>>&);
template std::vector<std::vector<std::int64_t>> exchange(MPI_Comm,
                                                         const std::vector<std::vector<std::int64_t>>&);
template void broadcast(MPI_Comm, std::vector<char>&);
template void broadcast(MPI_Comm, std::vector<double>&);
template void broadcast(MPI_Comm, std::vector<std::int64_t>&);

}  // namespace ricochet::parallel
