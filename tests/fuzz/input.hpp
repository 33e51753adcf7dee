// SPDX-License-Identifier: BSD-2-Clause
// Common parts of the fuzz targets: decoding of the input, files in memory, and checks of every refusal. Each
// target defines LLVMFuzzerTestOneInput. libFuzzer calls it with generated inputs (scripts/fuzz), the tests
// call it with those of corpus/ (replay.cpp).
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "ricochet/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace ricochet::fuzz {

/// Ends the program if `holds` is false; a fuzzer reports this as a fault.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what.c_str());
  std::abort();
}

/// Returns whether `task` succeeds. Otherwise it must throw an
/// InputError with a single line of limited length.
template <class Task>
bool accepts(Task&& task) {
  try {
    task();
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (unsigned char c : text) require(c >= 32 && c != 127, "more than one line: " + text);
    require(text.size() < 4000, "a line without end: " + text);
    return false;
  }
  return true;
}

/// A folder, in memory if there is such a file system, which is removed when the program ends.
class Scratch {
 public:
  Scratch() {
    const std::filesystem::path memory = "/dev/shm";
    std::string name =
        ((std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) /
         "ricochet-fuzz-XXXXXX")
            .string();
    require(::mkdtemp(name.data()) != nullptr, "no folder " + name);
    folder_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  std::filesystem::path put(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = folder_ / name;
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

 private:
  std::filesystem::path folder_;
};

/// Reads an input from its front; gives 0 after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  bool empty() const { return left_ == 0; }
  unsigned below(unsigned count) { return number<std::uint8_t>() % count; }
  template <class T>
  T number() {
    T value{};
    const std::size_t length = std::min(sizeof(T), left_);
    std::memcpy(&value, at_, length);
    at_ += length;
    left_ -= length;
    return value;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

}  // namespace ricochet::fuzz
