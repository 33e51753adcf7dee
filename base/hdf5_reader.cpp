// SPDX-License-Identifier: BSD-2-Clause
#include "base/hdf5_reader.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <span>
#include <system_error>

#include "base/hdf5_internal.hpp"
#include "ricochet/error.hpp"

namespace ricochet::base::hdf5 {
namespace {

/// A dataset may need at most this many times the size of the file in memory (which allows for narrow or
/// compressed data, but not for decompression bombs), plus an allowance for chunks that are not full.
constexpr std::uintmax_t kMemoryPerFileByte = 64, kMemoryOfSmallFiles = 1 << 20;

/// Product of `shape` and `element`, or the largest number if it overflows.
std::uintmax_t bytes_of(std::span<const hsize_t> shape, std::uintmax_t element) {
  std::uintmax_t bytes = element;
  if (std::ranges::find(shape, hsize_t{0}) != shape.end()) return 0;
  for (const hsize_t length : shape) {
    if (bytes > std::numeric_limits<std::uintmax_t>::max() / length)
      return std::numeric_limits<std::uintmax_t>::max();
    bytes *= length;
  }
  return bytes;
}

/// Whether the data is stored in this file, uses only filters that every HDF5 library contains, and has no
/// chunk of more than `bound` bytes.
bool data_is_inside(hid_t dataset, std::uintmax_t element, std::uintmax_t bound) {
  const Id list(H5Dget_create_plist(dataset));
  const H5D_layout_t layout = H5Pget_layout(list.get());
  if (layout != H5D_COMPACT && layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED) return false;
  if (H5Pget_external_count(list.get()) != 0) return false;
  if (layout == H5D_CHUNKED) {
    std::array<hsize_t, H5S_MAX_RANK> chunk{};
    const int rank = H5Pget_chunk(list.get(), static_cast<int>(chunk.size()), chunk.data());
    if (rank < 1 || bytes_of(std::span(chunk).first(static_cast<std::size_t>(rank)), element) > bound)
      return false;
  }
  for (int i = 0; i < H5Pget_nfilters(list.get()); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(list.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      return false;
  }
  return true;
}

}  // namespace

Reader::Reader(std::filesystem::path path, std::string advice)
    : path_(std::move(path)), advice_(std::move(advice)) {
  silence();
  std::error_code error;
  const auto status = std::filesystem::status(path_, error);
  if (!std::filesystem::exists(status)) fail("there is no such file.");
  if (!std::filesystem::is_regular_file(status)) fail("is not a file.");
  bytes_ = std::filesystem::file_size(path_, error);
  errno = 0;
  file_ = Id(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, unlocked_access().get()));
  if (!file_.valid()) {
    if (::access(path_.c_str(), R_OK) != 0) fail(fmt::format("cannot be read ({}).", std::strerror(errno)));
    if (H5Fis_hdf5(path_.c_str()) > 0) fail("is a damaged or truncated HDF5 file.");
    fail("is not an HDF5 file.");
  }
}

void Reader::fail(const std::string& what) const {
  std::string line = fmt::format("{}: {} {}", path_.string(), what, advice_);
  // The message may quote values of the file.
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  throw InputError(line);
}

/// Checks that an existing object is a group, where a group is required.
void Reader::check_group(const std::string& name) const {
  H5O_info_t info{};
  if (!name.empty() && H5Oget_info_by_name(file_.get(), name.c_str(), &info, H5P_DEFAULT) >= 0 &&
      info.type != H5O_TYPE_GROUP)
    fail(fmt::format("\"{}\" is not a group.", name));
}

bool Reader::inside(const std::string& object) const {
  for (std::size_t end = object.find('/', 1);; end = object.find('/', end + 1)) {
    const std::string part = object.substr(0, end);
    if (part != "/") {
      H5L_info_t info{};
      if (H5Lget_info(file_.get(), part.c_str(), &info, H5P_DEFAULT) < 0) {
        check_group(part.substr(0, part.rfind('/')));
        return false;
      }
      if (info.type != H5L_TYPE_HARD)
        fail(fmt::format("dataset \"{}\" is a link; only data in the file itself is read.", object));
    }
    if (end == std::string::npos) return true;
  }
}

bool Reader::exists(const std::string& object) const {
  silence();
  return inside(object);
}

bool Reader::has_attribute(const std::string& object, const std::string& name) const {
  silence();
  return inside(object) && H5Aexists_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

Id Reader::open_dataset(const std::string& dataset) const {
  if (!inside(dataset)) fail(fmt::format("dataset \"{}\" is missing.", dataset));
  Id opened(H5Dopen2(file_.get(), dataset.c_str(), H5P_DEFAULT));
  if (!opened.valid()) fail(fmt::format("\"{}\" is not a dataset, or damaged.", dataset));
  return opened;
}

Shape Reader::shape(const std::string& dataset) const {
  silence();
  const Id opened = open_dataset(dataset);
  const Id space(H5Dget_space(opened.get()));
  std::array<hsize_t, H5S_MAX_RANK> dims{};
  const int rank = H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
  if (rank < 0 || H5Sget_simple_extent_type(space.get()) == H5S_NULL)
    fail(fmt::format("dataset \"{}\" has no shape.", dataset));
  return {dims.begin(), dims.begin() + rank};
}

void Reader::check_storage(const Id& dataset, const std::string& name, std::size_t element) const {
  const std::uintmax_t bound = bytes_ * kMemoryPerFileByte + kMemoryOfSmallFiles;
  const Shape found = shape(name);
  const std::vector<hsize_t> dims(found.begin(), found.end());
  if (bytes_of(dims, element) > bound)
    fail(fmt::format("dataset \"{}\" claims shape {}, more than a file of {} bytes can hold.", name,
                     to_string(found), bytes_));
  if (!data_is_inside(dataset.get(), element, bound))
    fail(fmt::format(
        "dataset \"{}\" keeps its data in another file, or uses a filter that is not HDF5's own.", name));
}

void Reader::check_shape(const std::string& dataset, const Shape& expected) const {
  const Shape found = shape(dataset);
  const auto agrees = [](std::size_t is, std::size_t should) { return should == any || is == should; };
  if (!std::ranges::equal(found, expected, agrees))
    fail(fmt::format("dataset \"{}\" has shape {}, expected {}. Was it truncated?", dataset, to_string(found),
                     to_string(expected)));
}

bool Reader::is_single(const std::string& dataset) const {
  if (!exists(dataset)) return false;
  const Id type(H5Dget_type(open_dataset(dataset).get()));
  return H5Tget_class(type.get()) == H5T_FLOAT && H5Tget_size(type.get()) == sizeof(float);
}

template <Element T>
std::vector<T> Reader::read(const std::string& dataset, const Shape& expected) const {
  silence();
  check_shape(dataset, expected);
  const Id opened = open_dataset(dataset);
  const Id type(H5Dget_type(opened.get()));
  const H5T_class_t kind = std::same_as<T, std::int64_t> ? H5T_INTEGER : H5T_FLOAT;
  if (H5Tget_class(type.get()) != kind || H5Tget_size(type.get()) > sizeof(double))
    fail(fmt::format("dataset \"{}\" does not hold {}.", dataset,
                     kind == H5T_INTEGER ? "integers" : "floating-point numbers"));
  check_storage(opened, dataset, std::max(sizeof(T), H5Tget_size(type.get())));
  const Id space(H5Dget_space(opened.get()));
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  if (!values.empty() &&
      H5Dread(opened.get(), element_type<T>().memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail(fmt::format("dataset \"{}\" is damaged.", dataset));
  return values;
}
template std::vector<double> Reader::read(const std::string&, const Shape&) const;
template std::vector<float> Reader::read(const std::string&, const Shape&) const;
template std::vector<std::int64_t> Reader::read(const std::string&, const Shape&) const;

std::vector<std::string> Reader::read_strings(const std::string& dataset, std::size_t expected) const {
  silence();
  check_shape(dataset, {expected});
  const Id opened = open_dataset(dataset);
  const Id type(H5Dget_type(opened.get()));
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0)
    fail(fmt::format("dataset \"{}\" does not hold strings of fixed length.", dataset));
  const std::size_t width = H5Tget_size(type.get());
  check_storage(opened, dataset, width);
  const std::size_t count = shape(dataset)[0];
  std::string padded(count * width, '\0');
  if (count > 0 && H5Dread(opened.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail(fmt::format("dataset \"{}\" is damaged.", dataset));
  std::vector<std::string> values;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string value = padded.substr(i * width, width);
    values.push_back(value.substr(0, value.find('\0')));
  }
  return values;
}

Id Reader::open_attribute(const std::string& object, const std::string& name) const {
  if (!has_attribute(object, name)) fail(fmt::format("attribute \"{}\" of \"{}\" is missing.", name, object));
  Id opened(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  if (!opened.valid()) fail(fmt::format("attribute \"{}\" of \"{}\" is damaged.", name, object));
  return opened;
}

std::string Reader::string_attribute(const std::string& object, const std::string& name) const {
  silence();
  const Id opened = open_attribute(object, name);
  const Id type(H5Aget_type(opened.get())), space(H5Aget_space(opened.get()));
  const std::size_t width = H5Tget_size(type.get());
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Sget_simple_extent_npoints(space.get()) != 1 || width > bytes_)
    fail(fmt::format("attribute \"{}\" of \"{}\" is not a string of fixed length.", name, object));
  std::string value(width, '\0');
  if (H5Aread(opened.get(), type.get(), value.data()) < 0)
    fail(fmt::format("attribute \"{}\" of \"{}\" is damaged.", name, object));
  value.resize(std::min(value.find('\0'), value.size()));
  return value;
}

void Reader::read_numeric_attribute(const std::string& object, const std::string& name, bool integer,
                                    std::size_t count, void* values) const {
  silence();
  const Id opened = open_attribute(object, name);
  const Id type(H5Aget_type(opened.get())), space(H5Aget_space(opened.get()));
  if (H5Tget_class(type.get()) != (integer ? H5T_INTEGER : H5T_FLOAT) ||
      H5Tget_size(type.get()) > sizeof(double) ||
      H5Sget_simple_extent_npoints(space.get()) != static_cast<hssize_t>(count))
    fail(fmt::format("attribute \"{}\" of \"{}\" does not hold {} {}.", name, object, count,
                     integer ? "integer" : "floating-point number(s)"));
  if (H5Aread(opened.get(), integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, values) < 0)
    fail(fmt::format("attribute \"{}\" of \"{}\" is damaged.", name, object));
}

double Reader::double_attribute(const std::string& object, const std::string& name) const {
  return doubles_attribute(object, name, 1).front();
}

std::int64_t Reader::integer_attribute(const std::string& object, const std::string& name) const {
  std::int64_t value = 0;
  read_numeric_attribute(object, name, true, 1, &value);
  return value;
}

std::vector<double> Reader::doubles_attribute(const std::string& object, const std::string& name,
                                              std::size_t count) const {
  std::vector<double> values(count);
  read_numeric_attribute(object, name, false, count, values.data());
  return values;
}

}  // namespace ricochet::base::hdf5
