// SPDX-License-Identifier: BSD-2-Clause
// Reads HDF5 files as untrusted input. Errors are one-line InputErrors. Arrays are row-major.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

/// An existing file, opened read-only and not trusted. The reader refuses links, data stored in other files,
/// filters from plug-ins, strings of variable length, and datasets that claim far more data than the file can
/// contain. HDF5 itself verifies the checksums of the headers that Writer creates.
class Reader {
 public:
  /// @param advice  last sentence of every error, such as "Compute it again with ricochet-kernel."
  /// Throws InputError if `path` is missing, is not HDF5, or is damaged.
  Reader(std::filesystem::path path, std::string advice);

  /// Whether a group or dataset of this name exists. Throws InputError if it is a link or is reached through
  /// one.
  bool exists(const std::string& object) const;
  bool has_attribute(const std::string& object, const std::string& name) const;

  /// Shape of a dataset. Throws InputError if there is no such dataset.
  Shape shape(const std::string& dataset) const;

  /// Whether there is a dataset of floating-point numbers of this name that are stored in single precision.
  bool is_single(const std::string& dataset) const;

  /// Values of a dataset of floating-point numbers (double, float) or integers (int64), row-major.
  /// Throws InputError if the dataset is missing, or if its type or shape differs from the expected one.
  template <Element T>
  std::vector<T> read(const std::string& dataset, const Shape& expected) const;
  std::vector<std::string> read_strings(const std::string& dataset, std::size_t expected) const;

  /// Return a scalar attribute. Throw InputError if it is missing or has another type.
  std::string string_attribute(const std::string& object, const std::string& name) const;
  double double_attribute(const std::string& object, const std::string& name) const;
  std::int64_t integer_attribute(const std::string& object, const std::string& name) const;
  /// Returns an attribute that contains `count` numbers.
  std::vector<double> doubles_attribute(const std::string& object, const std::string& name,
                                        std::size_t count) const;

  /// Throws an InputError with the message "FILE: `what` ADVICE".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool inside(const std::string& object) const;
  void check_group(const std::string& name) const;
  Id open_dataset(const std::string& dataset) const;
  void check_shape(const std::string& dataset, const Shape& expected) const;
  void check_storage(const Id& dataset, const std::string& name, std::size_t element) const;
  Id open_attribute(const std::string& object, const std::string& name) const;
  void read_numeric_attribute(const std::string& object, const std::string& name, bool integer,
                              std::size_t count, void* values) const;

  std::filesystem::path path_;
  std::string advice_;
  std::uintmax_t bytes_ = 0;
  Id file_;
};

}  // namespace ricochet::base::hdf5
