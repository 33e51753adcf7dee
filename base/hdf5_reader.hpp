// SPDX-License-Identifier: BSD-2-Clause
// HDF5 files, read as untrusted input. Errors are one-line InputErrors. Arrays are row-major.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/hdf5.hpp"

namespace ricochet::base::hdf5 {

/// An existing file, opened read-only and not trusted: links out of the file or across it, data stored in
/// other files, filters from plug-ins, strings of variable length, and datasets that claim far more than the
/// file can hold are refused. HDF5 itself checks the headers that Writer makes by their checksums.
class Reader {
 public:
  /// @param advice  sentence that ends each error, such as "Compute it again with ricochet-kernel."
  /// Throws InputError when `path` is missing, not HDF5, or damaged.
  Reader(std::filesystem::path path, std::string advice);

  /// Whether there is a group or dataset of this name. Throws InputError when it is a link, or behind one.
  bool exists(const std::string& object) const;
  bool has_attribute(const std::string& object, const std::string& name) const;

  /// Shape of a dataset. Throws InputError when there is none.
  Shape shape(const std::string& dataset) const;

  /// Values of a dataset of floating-point numbers (double, float) or integers (int64), row-major.
  /// Throws InputError on a missing dataset, another kind of value or another shape.
  template <Element T>
  std::vector<T> read(const std::string& dataset, const Shape& expected) const;
  std::vector<std::string> read_strings(const std::string& dataset, std::size_t expected) const;

  /// Scalars. Throw InputError when missing or of another kind.
  std::string string_attribute(const std::string& object, const std::string& name) const;
  double double_attribute(const std::string& object, const std::string& name) const;
  std::int64_t integer_attribute(const std::string& object, const std::string& name) const;
  /// A list of `count` numbers.
  std::vector<double> doubles_attribute(const std::string& object, const std::string& name,
                                        std::size_t count) const;

  /// Throws InputError "FILE: `what`. ADVICE".
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
