// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: reads words and numbers from an untrusted .msh file of any size.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace ricochet::mesh {

/// A place in a file. The line is that of text.
struct Place {
  std::int64_t byte = 0, line = 1;
};

class MshStream {
 public:
  /// Throws InputError if the file cannot be read.
  explicit MshStream(const std::filesystem::path& file);

  /// Throws InputError "FILE: line N: `what`", or with the byte offset instead of the line if numbers are
  /// binary.
  [[noreturn]] void fail(const std::string& what) const;

  bool ended();
  /// Returns the next word, valid until the next call. At the end of the file, throws an InputError that
  /// names `expected`.
  std::string_view word(const char* expected);
  /// Returns the rest of this line without the line break and surrounding spaces.
  std::string rest_of_line();
  void skip_line();

  Place place() const { return {before_ + static_cast<std::int64_t>(at_), line_}; }
  void go_to(Place place);
  /// Skips words or, if numbers are binary, numbers of eight bytes. At the end of the file, throws an
  /// InputError that names `what`.
  void skip(std::int64_t count, const char* what);

  /// Sets whether numbers are binary from here on.
  void set_binary(bool binary) { binary_ = binary; }

  /// Reads an integer from `low` to `high`: a word, or a T if numbers are binary.
  template <class T>
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  /// Reads a finite number.
  double real(const char* what);

 private:
  bool fill();
  int next();
  void raw(void* to, std::size_t length, const char* what);
  [[noreturn]] void fail_at_end(const char* missing) const;

  std::string name_;
  std::ifstream stream_;
  std::int64_t size_ = 0;
  std::array<char, 1 << 16> buffer_;
  std::size_t at_ = 0, end_ = 0;
  std::int64_t line_ = 1, before_ = 0;  ///< current line; number of bytes before the buffer
  bool binary_ = false;
  std::string word_;
};

}  // namespace ricochet::mesh
