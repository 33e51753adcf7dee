// SPDX-License-Identifier: BSD-2-Clause
// Checks that a step does nothing but arithmetic. A child process gives up all system calls except read,
// write and exit (strict seccomp), makes a million steps, and reports its calls of the heap and of locks.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <shared_mutex>

#include "tests/contact/heap_counter.hpp"
#include "tests/contact/plate.hpp"

namespace {
std::atomic<long> locks{0};
}

// Wrappers of the locks of libpthread. They look up the original functions on first use.
#define COUNT_LOCK(name, type)                                                   \
  extern "C" int name(type* lock) noexcept {                                     \
    static int (*real)(type*) = nullptr;                                         \
    if (!real) real = reinterpret_cast<int (*)(type*)>(dlsym(RTLD_NEXT, #name)); \
    ++locks;                                                                     \
    return real(lock);                                                           \
  }
COUNT_LOCK(pthread_mutex_lock, pthread_mutex_t)
COUNT_LOCK(pthread_mutex_trylock, pthread_mutex_t)
COUNT_LOCK(pthread_rwlock_rdlock, pthread_rwlock_t)
COUNT_LOCK(pthread_rwlock_wrlock, pthread_rwlock_t)

namespace {

using namespace ricochet;
using contact::test::falling;

struct Verdict {
  std::int64_t steps = 0, touching = 0;
  long heap = 0, locks = 0;
};

long heap_calls() { return heap_counter::calls + heap_counter::returns; }

enum class Ending { reported, killed, no_seccomp };
constexpr int cannot = 77;

/// Runs `action`, which returns a Verdict, in a child process that may only read, write and exit.
template <class Action>
Ending confined(Action action, Verdict& verdict) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) syscall(SYS_exit, cannot);
    const Verdict found = action();
    const bool reported = write(ends[1], &found, sizeof found) == sizeof found;
    syscall(SYS_exit, reported ? 0 : 1);  // not _exit, which calls exit_group
  }
  close(ends[1]);
  const bool whole = read(ends[0], &verdict, sizeof verdict) == sizeof verdict;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == cannot) return Ending::no_seccomp;
  return whole && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? Ending::reported : Ending::killed;
}

/// Makes half of the steps in blocks of 64 that write velocities and
/// forces, and the other half as single steps.
Verdict a_million_steps(Simulation& simulation, std::vector<double>& velocity, std::vector<double>& force) {
  constexpr std::int64_t block = 64, half = 500'032;
  const std::size_t points = simulation.points().size();
  Verdict out;
  const long heap = heap_calls(), locked = locks;
  for (std::int64_t k = 0; k < half; k += block) {
    out.steps += simulation.step_block(block, {.velocity = velocity.data(), .force = force.data()}).steps;
    for (std::int64_t i = 0; i < block; ++i) out.touching += force[static_cast<std::size_t>(i) * points] > 0;
  }
  for (std::int64_t k = 0; k < half; ++k) {
    out.steps += simulation.step() == StepStatus::ok;
    out.touching += simulation.force()[0] > 0;
  }
  out.heap = heap_calls() - heap;
  out.locks = locks - locked;
  return out;
}

/// A heavily damped body comes to rest on the floor on all its points.
void expect_nothing_but_arithmetic(Scheme scheme, Admittance admittance) {
  Scene scene = falling({.modes = 16, .points = 6, .ratio = 0.05, .rigid_decay = 5}, 1e-5, 0.1, 9.81);
  scene.scheme = scheme;
  scene.admittance = admittance;
  Simulation simulation(scene);
  std::vector<double> velocity(64), force(64 * 6);
  Verdict verdict;
  switch (confined([&] { return a_million_steps(simulation, velocity, force); }, verdict)) {
    case Ending::killed:
      FAIL() << "killed for a system call";
    case Ending::no_seccomp:
      verdict = a_million_steps(simulation, velocity, force);
      break;
    case Ending::reported:
      break;
  }
  EXPECT_EQ(verdict.steps, 1'000'064);
  EXPECT_GT(verdict.touching, 900'000);
#if RICOCHET_HEAP_COUNTED
  EXPECT_EQ(verdict.heap, 0);
#endif
  EXPECT_EQ(verdict.locks, 0);
}

TEST(RealTime, a_million_compliant_steps_touch_neither_heap_nor_locks_nor_the_system) {
  expect_nothing_but_arithmetic(Scheme::compliant, Admittance::jump);
}

TEST(RealTime, a_million_impulse_steps_touch_neither_heap_nor_locks_nor_the_system) {
  expect_nothing_but_arithmetic(Scheme::impulse, Admittance::jump);
}

TEST(RealTime, a_million_difference_steps_touch_neither_heap_nor_locks_nor_the_system) {
  expect_nothing_but_arithmetic(Scheme::impulse, Admittance::difference);
}

TEST(Watch, counts_memory_and_locks_and_stops_system_calls) {
  [[maybe_unused]] const long heap = heap_calls();
  const long locked = locks;
  void* volatile memory = std::malloc(1000);
  std::free(memory);
  std::mutex mutex;
  { const std::lock_guard guard(mutex); }
  std::shared_mutex shared;
  { const std::shared_lock guard(shared); }
#if RICOCHET_HEAP_COUNTED
  EXPECT_EQ(heap_calls() - heap, 2);
#endif
  EXPECT_EQ(locks - locked, 2);
  Verdict verdict;
  const Ending ending = confined(
      [] {
        syscall(SYS_getpid);
        return Verdict{};
      },
      verdict);
  if (ending == Ending::no_seccomp)
    GTEST_SKIP() << "this machine offers no seccomp: system calls go unwatched";
  EXPECT_EQ(ending, Ending::killed);
}

}  // namespace
