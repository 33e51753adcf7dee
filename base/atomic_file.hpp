// SPDX-License-Identifier: BSD-2-Clause
// Files that have their final names only when they are whole, whatever ends the program that writes them.
//
//   AtomicFile file("out/body.kernel.h5");     // makes out/body.kernel.h5.<process>.partial
//   write_to(file.path());
//   file.commit();                            // synced, then renamed
//
// The file is locked as long as its writer lives: so the next writer of the same name tells what a killed
// one left, and removes it.
#pragma once

#include <filesystem>

namespace ricochet::base {

class AtomicFile {
 public:
  /// An empty file beside `target`. Throws InputError when it can't be made.
  explicit AtomicFile(std::filesystem::path target);
  /// Removes the file unless it was committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }

  /// Throws the InputError of a file that could not be written.
  [[noreturn]] void fail() const;

  /// Syncs the file to the disk, gives it its final name, and syncs the folder. Whoever wrote to `path` has
  /// closed it. Throws InputError when any of it fails; then what had the final name still has it.
  /// @param outdated  a file that tells of the one to be replaced: removed just before
  void commit(const std::filesystem::path& outdated = {});

 private:
  std::filesystem::path target_, path_;
  int descriptor_ = -1;  ///< holds the lock
  int slot_ = -1;        ///< in the list of remove_unfinished_files
};

/// Removes the temporary files of this process. For handlers of signals that end it.
void remove_unfinished_files() noexcept;

/// Makes the folder of `file` where it is missing, and a AtomicFile for a try. Throws InputError when that
/// fails, or when fewer than `bytes` are free there.
void check_place(const std::filesystem::path& file, double bytes = 0);

}  // namespace ricochet::base
