// SPDX-License-Identifier: BSD-2-Clause
#include "base/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "ricochet/error.hpp"

namespace ricochet::base {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".partial";

/// An entry that a signal handler can read without allocation or lock.
struct Listed {
  std::atomic<bool> taken = false, ready = false;
  std::array<char, PATH_MAX> path{};
};
std::array<Listed, 32> listed;
static_assert(std::atomic<bool>::is_always_lock_free);

/// Blocks signals, so that a new file is listed before one can arrive.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~SignalsWait() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;

 private:
  sigset_t before_{};
};

/// @return the entry of the file, or -1 if no entry is free; if the process is killed, the next writer then
///   removes the file
int list(const std::string& path) {
  for (std::size_t k = 0; k < listed.size() && path.size() < PATH_MAX; ++k)
    if (!listed[k].taken.exchange(true)) {
      std::ranges::copy(path, listed[k].path.begin());
      listed[k].path[path.size()] = '\0';
      listed[k].ready = true;
      return static_cast<int>(k);
    }
  return -1;
}

void unlist(int slot) {
  if (slot < 0) return;
  listed[static_cast<std::size_t>(slot)].ready = false;
  listed[static_cast<std::size_t>(slot)].taken = false;
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

/// Whether `name` may belong to an AtomicFile for `target`.
bool is_temporary_of(const std::string& name, const std::string& target) {
  const std::string begin = target + ".", end = kEnding;
  if (name.size() <= begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end))
    return false;
  return name.find_first_not_of("0123456789-", begin.size()) == name.size() - end.size();
}

/// Removes an abandoned file. On a file system without locks, running writers cannot be recognised, so the
/// file stays.
void remove_if_left(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
  ::close(descriptor);
}

void remove_left(const fs::path& target) {
  std::error_code failed;
  for (fs::directory_iterator entry(folder_of(target), failed), end; !failed && entry != end;
       entry.increment(failed))
    if (is_temporary_of(entry->path().filename().string(), target.filename().string()))
      remove_if_left(entry->path());
}

/// Whether `path` still names the file open as `descriptor`. Before it was locked, another writer may have
/// removed it as abandoned.
bool names(const fs::path& path, int descriptor) {
  struct stat there {
  }, mine{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(descriptor, &mine) == 0 &&
         there.st_ino == mine.st_ino && there.st_dev == mine.st_dev;
}

}  // namespace

void fail_to_write(const fs::path& place, const std::string& what) {
  throw InputError(fmt::format(
      "{}: cannot write {} ({}). Is the disk full, or the folder read-only? Choose another --out.",
      place.string(), what, errno != 0 ? std::strerror(errno) : "no reason given by the system"));
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  remove_left(target_);
  // Processes on two machines may have the same number.
  for (int attempt = 0; attempt < 100; ++attempt) {
    path_ = target_;
    path_ += fmt::format(".{}{}{}", ::getpid(), attempt > 0 ? fmt::format("-{}", attempt) : "", kEnding);
    const SignalsWait until_listed;
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno == EEXIST) continue;
    if (descriptor_ < 0) fail_to_write(target_);
    ::flock(descriptor_, LOCK_EX | LOCK_NB);
    if (names(path_, descriptor_)) {
      slot_ = list(path_.string());
      return;
    }
    ::close(descriptor_);
  }
  errno = EEXIST;
  fail_to_write(target_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  // HDF5 may keep a file open that it could not close; truncation frees its space nevertheless.
  (void)!::ftruncate(descriptor_, 0);
  ::unlink(path_.c_str());
  unlist(slot_);
  ::close(descriptor_);
}

void AtomicFile::fail() const { fail_to_write(target_); }

void AtomicFile::commit(const fs::path& outdated) {
  if (::fsync(descriptor_) != 0) fail_to_write(target_);
  if (!outdated.empty()) ::unlink(outdated.c_str());
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail_to_write(target_);
  unlist(slot_);
  ::close(std::exchange(descriptor_, -1));
  // Some file systems cannot sync a folder; the file itself is complete in any case.
  const int opened = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  ::fsync(opened);
  ::close(opened);
}

SetLock::SetLock(const fs::path& stem) : path_(stem) {
  constexpr int kTries = 6000, kPause_us = 10'000;
  path_ += ".lock";
  for (int tries = 0; tries < kTries; ++tries) {
    const SignalsWait until_listed;
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) fail_to_write(path_);
    const bool locked = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    const bool others = !locked && (errno == EWOULDBLOCK || errno == EINTR);
    // The one that held the lock has removed its file: that lock keeps nobody out.
    if (locked && names(path_, descriptor_)) {
      slot_ = list(path_.string());
      return;
    }
    ::close(std::exchange(descriptor_, -1));
    if (!locked && !others) {
      ::unlink(path_.c_str());
      return;
    }
    if (others) ::usleep(kPause_us);
  }
  throw InputError(
      fmt::format("{}: another run has been writing files of this name for a minute: end it, or choose "
                  "another title or --out",
                  path_.string()));
}

SetLock::~SetLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());  // while it is locked
  unlist(slot_);
  ::close(descriptor_);
}

void remove_unfinished_files() noexcept {
  for (const Listed& entry : listed)
    if (entry.ready) ::unlink(entry.path.data());
}

void check_place(const fs::path& file, double bytes) {
  const fs::path folder = folder_of(file);
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw InputError(fmt::format("{}: cannot create this folder ({}): choose another with --out",
                                 folder.string(), failed.message()));
  const AtomicFile probe(file);
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) return;
  const double free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if (free < bytes)
    throw InputError(
        fmt::format("{}: {:.3g} MB are needed for it, and {:.3g} are free: make room, or choose "
                    "another place with --out",
                    file.string(), bytes / 1e6, free / 1e6));
}

}  // namespace ricochet::base
