// SPDX-License-Identifier: BSD-2-Clause
// Writes HDF5 files, completely or not at all. Errors are one-line InputErrors.
//
//   Writer file(path);                                     // opens a temporary file beside path
//   file.attribute("/", "format", "my-format");
//   file.write<double>("/modes/angular_frequency", omega, {omega.size()}, "rad/s");
//   Rows& force = file.rows("/contact/force", {m}, "N");   // grows by one row at a time
//   force.append(lambda);
//   file.commit();                                         // now path exists
//
// Names start with "/"; the groups above a dataset are created as needed. No times are stored, so equal
// content gives equal bytes. Arrays are row-major.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

/// A dataset that grows along its first dimension. Rows are buffered and written in blocks.
class Rows {
 public:
  /// @param block  number of rows written at once
  Rows(Id dataset, std::string file, std::string name, Shape row, std::size_t block);

  /// @param row  the values of one row
  /// Throws InputError if the file cannot be written, and std::logic_error if the number of values differs.
  void append(std::span<const double> row);
  void append(double value) { append(std::span<const double>(&value, 1)); }

 private:
  friend class Writer;
  void flush();

  Id dataset_;
  std::string file_, name_;
  Shape row_;
  std::size_t width_, capacity_, written_ = 0, held_ = 0;
  std::vector<double> block_;
};

/// A file without a name, whose content goes elsewhere. Its rows are compressed.
struct Unnamed {};

/// A new file. It has a temporary name until `commit`; if it is destroyed earlier, nothing remains.
class Writer {
 public:
  /// Throws InputError if the file cannot be created.
  explicit Writer(std::filesystem::path path);
  /// Ends with `content` in place of `commit`. HDF5 1.10 and later read the content. It takes space in the
  /// folder of temporary files until then. Throws as above.
  explicit Writer(Unnamed);
  ~Writer();

  /// Creates an empty group and the groups above it, so that attributes can be written before any dataset.
  void group(const std::string& name);

  /// @param values  as many as `shape` requires; otherwise throws std::logic_error
  /// @param unit    SI, "1" for pure numbers; an empty unit writes no attribute
  template <Element T>
  void write(const std::string& dataset, std::span<const T> values, const Shape& shape,
             const std::string& unit);
  template <Element T>
  void write(const std::string& dataset, const std::vector<T>& values, const Shape& shape,
             const std::string& unit) {
    write(dataset, std::span<const T>(values), shape, unit);
  }
  /// Writes a one-dimensional dataset of UTF-8 strings, padded to the longest.
  void write_strings(const std::string& dataset, const std::vector<std::string>& values);

  /// Creates an empty dataset of shape (0, row...) that grows. The reference is valid until `commit`.
  Rows& rows(const std::string& dataset, const Shape& row, const std::string& unit);

  /// A dataset that was created.
  struct Dataset {
    std::string name, unit;  ///< the unit is empty if it has none
  };
  const std::vector<Dataset>& datasets() const { return datasets_; }

  /// Names the dimensions of a dataset by dimension scales, as the specification of HDF5 and netCDF-4 have
  /// them, so that readers such as xarray find the names. Also writes its unit as `units`, their name for it.
  /// Call it after all rows. Throws InputError if the file cannot be written, and std::logic_error if the
  /// number of dimensions or the length of a scale differs.
  /// @param scales  by dimension, datasets of one dimension. One that does not exist is created without
  ///                values. Alone, the dataset itself: it becomes a scale.
  void name_dimensions(const Dataset& dataset, const std::vector<std::string>& scales);

  /// Write an attribute of "/", or of a group or dataset that exists.
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::span<const double> values);
  template <std::integral Integer>
  void attribute(const std::string& object, const std::string& name, Integer value) {
    integer_attribute(object, name, static_cast<std::int64_t>(value));
  }

  /// Writes buffered rows, closes the file, syncs it to disk and renames it. No member may be called
  /// afterwards. Throws InputError on failure; the final path then still holds the previous file, if there
  /// was one.
  /// @param outdated  as for AtomicFile
  void commit(const std::filesystem::path& outdated = {});

  /// Writes buffered rows and returns the content of an unnamed file. No member may be called afterwards.
  /// Throws InputError on failure.
  std::string content();

  const std::filesystem::path& path() const { return path_; }

 private:
  void create(const std::string& name, const Id& access);
  void finish();
  Id make_dataset(const std::string& name, std::int64_t type, const Id& space, const Id& creation,
                  const std::string& unit);
  void make_scale(const std::string& name, std::uint64_t length);
  void integer_attribute(const std::string& object, const std::string& name, std::int64_t value);
  void write_attribute(const std::string& object, const std::string& name, std::int64_t type, const Id& space,
                       const void* value);

  std::filesystem::path path_;
  std::unique_ptr<AtomicFile> temporary_;  ///< null if the file has no name
  int unnamed_ = -1;                       ///< descriptor of a file without a name, or -1
  Id file_;
  std::vector<std::unique_ptr<Rows>> rows_;
  std::vector<Dataset> datasets_;
  std::set<std::string> scales_;
};

}  // namespace ricochet::base::hdf5
