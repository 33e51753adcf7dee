// SPDX-License-Identifier: BSD-2-Clause
// Files that take their final name only once they are complete, even if the program that writes them is
// killed.
//
//   AtomicFile file("out/body.kernel.h5");     // creates out/body.kernel.h5.<process>.partial
//   write_to(file.path());
//   file.commit();                             // syncs, then renames
//
// The writer holds a lock on its temporary file. The next writer of the same name therefore recognises and
// removes the temporary file of a killed writer.
#pragma once

#include <filesystem>
#include <string>

namespace ricochet::base {

/// Throws an InputError stating that `what` could not be written at `place`, with the reason in errno.
[[noreturn]] void fail_to_write(const std::filesystem::path& place, const std::string& what = "the file");

class AtomicFile {
 public:
  /// Creates an empty file beside `target`. Throws InputError if it cannot be created.
  explicit AtomicFile(std::filesystem::path target);
  /// Removes the file unless it was committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Throws InputError as fail_to_write does.
  [[noreturn]] void fail() const;

  /// Syncs the file to disk, gives it its final name, and syncs the folder. The file at `path` must be
  /// closed. Throws InputError on failure; a previous file of that name then remains.
  /// @param outdated  a file that describes the one to be replaced; it is removed just before the renaming
  void commit(const std::filesystem::path& outdated = {});

 private:
  std::filesystem::path target_, path_;
  int descriptor_ = -1;  ///< file descriptor that holds the lock
  int slot_ = -1;        ///< entry in the list of remove_unfinished_files
};

/// Lets one process at a time give the files of a set their names, so that the sets of runs that write to
/// the same names do not mix. The lock is that of the file `<stem>.lock` (flock). The system releases it
/// when the process ends, for whatever cause; the destructor removes the file.
class SetLock {
 public:
  /// Waits while another process holds the lock. Throws InputError after a minute, or if the file cannot be
  /// created. Does nothing on file systems without locks: there, sets can mix, and their identifiers show it.
  explicit SetLock(const std::filesystem::path& stem);
  ~SetLock();
  SetLock(const SetLock&) = delete;
  SetLock& operator=(const SetLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;  ///< -1: no locks here
  int slot_ = -1;        ///< entry in the list of remove_unfinished_files
};

/// Removes the temporary files of this process. Signal handlers that end the process may call it.
void remove_unfinished_files() noexcept;

/// Creates the folder of `file` if it is missing, and creates and removes an AtomicFile as a trial. Throws
/// InputError if that fails, or if fewer than `bytes` are free there.
void check_place(const std::filesystem::path& file, double bytes = 0);

}  // namespace ricochet::base
