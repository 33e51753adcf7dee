// SPDX-License-Identifier: BSD-2-Clause
// What the fuzz targets share: their input in pieces, files in memory, and what must hold of every refusal.
//
// Each target defines LLVMFuzzerTestOneInput. libFuzzer calls it with inputs of its own (scripts/fuzz), the
// tests with those of corpus/ (replay.cpp).
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

/// Ends the program, which is what a fuzzer takes for a fault.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what.c_str());
  std::abort();
}

/// Whether `task` does its work. Otherwise it has to throw an InputError of one line that is not endless.
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

/// A folder in memory, where there is such a file system, gone when the program ends.
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

/// Takes an input apart from its front; 0 where it has ended.
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
