// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the words and numbers of a .msh file of any size, not trusted.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace ricochet::mesh {

class MshStream {
 public:
  /// Throws InputError if the file cannot be read.
  explicit MshStream(const std::filesystem::path& file);

  /// Throws InputError "FILE: line N: `what`", or with the byte offset if numbers are binary.
  [[noreturn]] void fail(const std::string& what) const;

  bool ended();
  /// The next word, valid until the next call. At the end of the file throws InputError that names
  /// `expected`.
  std::string_view word(const char* expected);
  /// The rest of this line, without its end and surrounding spaces.
  std::string rest_of_line();
  void skip_line();

  /// Sets whether numbers are binary from here on.
  void set_binary(bool binary) { binary_ = binary; }

  /// A whole number from `low` to `high`: a word, or binary of the width of T.
  template <class T>
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  /// A finite number.
  double real(const char* what);

 private:
  bool fill();
  int next();
  void raw(void* to, std::size_t length, const char* what);

  std::string name_;
  std::ifstream stream_;
  std::array<char, 1 << 16> buffer_;
  std::size_t at_ = 0, end_ = 0;
  std::int64_t line_ = 1, before_ = 0;  ///< line; bytes before the buffer
  bool binary_ = false;
  std::string word_;
};

}  // namespace ricochet::mesh
