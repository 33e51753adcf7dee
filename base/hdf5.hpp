// HDF5 files, written whole or not at all and read as untrusted. Errors are one-line InputErrors.
//
//   Writer file(path);                                     // a temporary name beside path
//   file.attribute("/", "format", "my-format");
//   file.write<double>("/modes/angular_frequency", omega, {omega.size()}, "rad/s");
//   Rows& force = file.rows("/contact/force", {m}, "N");   // grows by a row at a time
//   force.append(lambda);
//   file.commit();                                         // now path exists
//
// Names start with "/"; groups on the way to a dataset are made as needed. No times are stored, so equal
// content gives equal bytes. Arrays are row-major. Whoever uses this switches HDF5's own printing of errors
// off, and its closing of files that are open when the program ends. The header needs no HDF5 header; handles
// never leave these classes.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.hpp"

namespace ricochet::base::hdf5 {

using Shape = std::vector<std::size_t>;

/// In an expected shape: a dimension of any length.
inline constexpr std::size_t any = static_cast<std::size_t>(-1);

/// "(5, 3)"; a dimension `any` is written "*".
std::string to_string(const Shape& shape);

template <class T>
concept Element = std::same_as<T, double> || std::same_as<T, float> || std::same_as<T, std::int64_t>;

/// Owner of one HDF5 identifier.
class Id {
 public:
  Id() = default;
  explicit Id(std::int64_t raw) : raw_(raw) {}
  Id(Id&& other) noexcept : raw_(std::exchange(other.raw_, -1)) {}
  Id& operator=(Id&& other) noexcept;
  ~Id() { reset(); }

  std::int64_t get() const { return raw_; }
  bool valid() const { return raw_ >= 0; }
  std::int64_t release() noexcept { return std::exchange(raw_, -1); }
  void reset() noexcept;

 private:
  std::int64_t raw_ = -1;
};

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
