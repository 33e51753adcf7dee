// SPDX-License-Identifier: BSD-2-Clause
// HDF5 files, written whole or not at all. Errors are one-line InputErrors.
//
//   Writer file(path);                                     // a temporary name beside path
//   file.attribute("/", "format", "my-format");
//   file.write<double>("/modes/angular_frequency", omega, {omega.size()}, "rad/s");
//   Rows& force = file.rows("/contact/force", {m}, "N");   // grows by a row at a time
//   force.append(lambda);
//   file.commit();                                         // now path exists
//
// Names start with "/"; groups on the way to a dataset are created as needed. No times are stored, so equal
// content gives equal bytes. Arrays are row-major.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

/// A dataset that grows along its first dimension. Rows are held back and written in blocks.
class Rows {
 public:
  /// @param block  rows that are written at once
  Rows(Id dataset, std::string file, std::string name, Shape row, std::size_t block);

  /// @param row  as many values as a row holds
  /// Throws InputError when the file can't be written, std::logic_error when the length is another one.
  void append(std::span<const double> row);
  void append(double value) { append(std::span<const double>(&value, 1)); }

  /// Rows appended so far, those held back included.
  std::size_t size() const { return written_ + held_; }

 private:
  friend class Writer;
  void flush();

  Id dataset_;
  std::string file_, name_;
  Shape row_;
  std::size_t width_, capacity_, written_ = 0, held_ = 0;
  std::vector<double> block_;
};

/// A new file. Until `commit` it has a temporary name; destroyed without it, it leaves nothing behind.
class Writer {
 public:
  /// Throws InputError when the file can't be made.
  explicit Writer(std::filesystem::path path);
  Writer(Writer&& other) = default;
  Writer& operator=(Writer&&) = delete;
  ~Writer();

  /// Makes an empty group (and those above it), for attributes that come before any dataset.
  void group(const std::string& name);

  /// @param values  as many as `shape` says, else std::logic_error
  /// @param unit    SI, "1" for pure numbers; no attribute when empty
  template <Element T>
  void write(const std::string& dataset, std::span<const T> values, const Shape& shape,
             const std::string& unit);
  template <Element T>
  void write(const std::string& dataset, const std::vector<T>& values, const Shape& shape,
             const std::string& unit) {
    write(dataset, std::span<const T>(values), shape, unit);
  }
  /// One-dimensional, UTF-8, padded to the longest.
  void write_strings(const std::string& dataset, const std::vector<std::string>& values);

  /// An empty dataset of shape (0, row...) that grows; the reference holds until `commit`.
  Rows& rows(const std::string& dataset, const Shape& row, const std::string& unit);

  /// Attributes of "/", a group or a dataset that exists.
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::span<const double> values);
  template <std::integral Integer>
  void attribute(const std::string& object, const std::string& name, Integer value) {
    integer_attribute(object, name, static_cast<std::int64_t>(value));
  }

  /// Writes what is held back, closes, syncs to the disk and renames. Nothing may be called after it.
  /// Throws InputError when any of it fails; then there is no file at the final path, or the old one.
  /// @param outdated  as of AtomicFile
  void commit(const std::filesystem::path& outdated = {});

  const std::filesystem::path& path() const { return path_; }

 private:
  Id make_dataset(const std::string& name, std::int64_t type, const Id& space, const Id& creation);
  void integer_attribute(const std::string& object, const std::string& name, std::int64_t value);
  void write_attribute(const std::string& object, const std::string& name, std::int64_t type, const Id& space,
                       const void* value);

  std::filesystem::path path_;
  std::unique_ptr<AtomicFile> temporary_;
  Id file_;
  std::vector<std::unique_ptr<Rows>> rows_;
};

}  // namespace ricochet::base::hdf5
