// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the words and numbers of a .msh file, of any size, not trusted.
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
  /// Throws InputError when the file can't be read.
  explicit MshStream(const std::filesystem::path& file);

  /// Throws InputError "FILE: line N: `what`", or the byte where numbers are binary.
  [[noreturn]] void fail(const std::string& what) const;

  bool ended();
  /// The next word, which stays until the next call; the end of the file is an error, naming what is missing.
  std::string_view word(const char* expected);
  /// What is left of this line, without the end of it and spaces around.
  std::string rest_of_line();
  void skip_line();

  /// Numbers are binary from here on, or text again.
  void set_binary(bool binary) { binary_ = binary; }
  bool binary() const { return binary_; }

  /// A whole number from `low` to `high`: a word, or as wide as T.
  template <class T>
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  /// A finite number.
  double real(const char* what);

 private:
  bool fill();
  int next();
  void raw(void* to, std::size_t length, const char* what);
  [[noreturn]] void out_of_range(const char* what, std::int64_t found, std::int64_t low,
                                 std::int64_t high) const;

  std::string name_;
  std::ifstream stream_;
  std::array<char, 1 << 16> buffer_;
  std::size_t at_ = 0, end_ = 0;
  std::int64_t line_ = 1, before_ = 0;  ///< bytes before the buffer
  bool binary_ = false;
  std::string word_;
};

}  // namespace ricochet::mesh
