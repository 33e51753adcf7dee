// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/child.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <fcntl.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace ricochet::mesh {

namespace {

[[noreturn]] void fail(const std::filesystem::path& program, int error) {
  throw std::runtime_error(fmt::format("{}: cannot be started: {}: install Ricochet again, or free memory",
                                       program.string(), std::strerror(error)));
}

/// A file descriptor that is closed at the end of the scope.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }
  int number() const { return number_; }

 private:
  int number_;
};

std::pair<Descriptor, Descriptor> make_pipe(const std::filesystem::path& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) fail(program, errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// An anonymous file with this content, read from its start.
Descriptor file_of(const std::string& content, const std::filesystem::path& program) {
  Descriptor file(memfd_create("ricochet", MFD_CLOEXEC));
  std::size_t done = 0;
  while (file.number() >= 0 && done < content.size()) {
    const ssize_t n = write(file.number(), content.data() + done, content.size() - done);
    if (n < 0 && errno != EINTR) fail(program, errno);
    done += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  if (file.number() < 0 || lseek(file.number(), 0, SEEK_SET) != 0) fail(program, errno);
  return file;
}

/// A process that is killed at the end of the scope unless it was waited for.
class Process {
 public:
  Process(const std::filesystem::path& program, std::vector<std::string> arguments, int input, int output,
          int log) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&files, input, 0);
    posix_spawn_file_actions_adddup2(&files, output, 1);
    posix_spawn_file_actions_adddup2(&files, log, 2);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    std::string name = program.string();
    std::vector<char*> words{name.data()};
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    const int error = posix_spawn(&pid_, name.c_str(), &files, &attributes, words.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) {
      pid_ = -1;
      fail(program, error);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (pid_ < 0) return;
    kill();
    Ending ignored;
    wait(ignored);
  }
  void kill() const { ::kill(pid_, SIGKILL); }

  void wait(Ending& ending) {
    rusage used{};
    while (wait4(pid_, &ending.status, 0, &used) < 0 && errno == EINTR) {
    }
    ending.peak_bytes = 1024.0 * static_cast<double>(used.ru_maxrss);
    pid_ = -1;
  }

  /// Processor time until now [ns].
  std::int64_t used() const {
    clockid_t clock{};
    timespec time{};
    if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  }

 private:
  pid_t pid_ = -1;
};

/// Keeps the last error message and the last line of a log.
class Log {
 public:
  void add(const char* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      if (data[i] != '\n' && data[i] != '\r') {
        if (line_.size() < longest) line_ += data[i];
        continue;
      }
      end_line();
    }
  }
  std::string last() {
    end_line();
    return error_.empty() ? last_ : error_;
  }

 private:
  static constexpr std::size_t longest = 300;

  void end_line() {
    if (line_.find_first_not_of(" \t") != std::string::npos) {
      last_ = line_;
      if (line_.rfind("Error", 0) == 0) error_ = line_;
    }
    line_.clear();
  }

  std::string line_, last_, error_;
};

/// @return whether there may be more
template <class Take>
bool read_once(int from, const Take& take) {
  std::array<char, 1 << 16> buffer{};
  const ssize_t n = read(from, buffer.data(), buffer.size());
  if (n > 0) take(buffer.data(), static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && (errno == EINTR || errno == EAGAIN));
}

}  // namespace

std::filesystem::path helper_program(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "libexec" /
         "ricochet" / name;
}

Ending run_child(const std::filesystem::path& program, const std::string& input,
                 const std::function<void(const char* data, std::size_t size)>& received, int idle_s,
                 const std::vector<std::string>& arguments) {
  Descriptor asked = file_of(input, program);
  auto [answer, answer_end] = make_pipe(program);
  auto [log, log_end] = make_pipe(program);
  Process process(program, arguments, asked.number(), answer_end.number(), log_end.number());
  asked.close();
  answer_end.close();
  log_end.close();
  // What the child starts may keep the log open.
  fcntl(log.number(), F_SETFL, O_NONBLOCK);

  Ending ending;
  Log lines;
  const auto add_line = [&](const char* data, std::size_t size) { lines.add(data, size); };
  std::int64_t used = 0;
  int idle = 0;
  bool logged = true;
  for (bool open = true; open;) {
    std::array<pollfd, 2> ends{{{answer.number(), POLLIN, 0}, {logged ? log.number() : -1, POLLIN, 0}}};
    const int ready = poll(ends.data(), ends.size(), 1000);
    if (ready > 0) {
      if (ends[1].revents != 0) logged = read_once(log.number(), add_line);
      if (ends[0].revents != 0) open = read_once(answer.number(), received);
      continue;
    }
    // Seconds are counted here, because a clock goes on while a batch system suspends both processes.
    const std::int64_t now = process.used();
    idle = now == used ? idle + 1 : 0;
    used = now;
    if (idle < idle_s) continue;
    ending.stuck = true;
    process.kill();
    break;
  }
  process.wait(ending);
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = read(log.number(), buffer.data(), buffer.size())) > 0;)
    lines.add(buffer.data(), static_cast<std::size_t>(n));
  ending.last_line = lines.last();
  return ending;
}

}  // namespace ricochet::mesh
