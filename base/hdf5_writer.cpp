// SPDX-License-Identifier: BSD-2-Clause
#include "base/hdf5_writer.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>

#include "base/hdf5_internal.hpp"
#include "ricochet/error.hpp"

namespace ricochet::base::hdf5 {
namespace {

/// Capacity of a message in an object header, minus space for name and type.
constexpr std::size_t kLongestAttribute = 64'000;

/// Size of a chunk of rows, written at once, unless a row is longer [bytes].
constexpr std::size_t kBlockBytes = 64 * 1024;

/// Higher levels of compression make motions hardly smaller and take longer.
constexpr unsigned kDeflate = 4;

/// Strings have a fixed length. HDF5 does not check its heap of variable-length strings when reading, and a
/// damaged heap crashes the reader.
Id utf8_type(std::size_t size) {
  Id type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), std::max<std::size_t>(size, 1));
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  return type;
}

Id simple_space(const Shape& shape) {
  const std::vector<hsize_t> dims(shape.begin(), shape.end());
  return Id(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr));
}

/// Creation properties of files, groups and datasets: no times are stored, and links and attributes stay in
/// the object header, which has a checksum. The heaps that HDF5 uses for large numbers of them have
/// incomplete checksums, and a damaged heap crashes the reader.
Id properties(hid_t property_class) {
  constexpr unsigned kInHeader = 64;
  Id list(H5Pcreate(property_class));
  H5Pset_obj_track_times(list.get(), false);
  H5Pset_attr_phase_change(list.get(), kInHeader, kInHeader);
  if (property_class != H5P_DATASET_CREATE) H5Pset_link_phase_change(list.get(), kInHeader, kInHeader);
  return list;
}

std::size_t count_of(const Shape& shape) {
  std::size_t count = 1;
  for (const std::size_t length : shape) count *= length;
  return count;
}

/// Creation properties of a dataset whose values have a checksum: few values are stored in the object header,
/// which has one; many values in chunks, each with one. HDF5 verifies them when it reads.
Id checked_properties(const Shape& shape, std::size_t element) {
  constexpr std::size_t kInHeader = 8 * 1024, kChunkBytes = 1 << 20;
  Id list = properties(H5P_DATASET_CREATE);
  const std::size_t bytes = count_of(shape) * element;
  if (bytes <= kInHeader) {
    H5Pset_layout(list.get(), H5D_COMPACT);
    return list;
  }
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  // As many entries along the first dimensions as fill a chunk.
  std::size_t below = bytes;
  for (std::size_t d = 0; d < shape.size(); ++d) {
    below /= shape[d];
    chunk[d] = std::clamp<std::size_t>(kChunkBytes / std::max<std::size_t>(below, 1), 1, shape[d]);
  }
  H5Pset_chunk(list.get(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_fletcher32(list.get());
  return list;
}

}  // namespace

Rows::Rows(Id dataset, std::string file, std::string name, Shape row, std::size_t block)
    : dataset_(std::move(dataset)),
      file_(std::move(file)),
      name_(std::move(name)),
      row_(std::move(row)),
      width_(count_of(row_)),
      capacity_(block) {}

void Rows::append(std::span<const double> row) {
  if (row.size() != width_) throw std::logic_error(name_ + ": a row of another length");
  block_.insert(block_.end(), row.begin(), row.end());
  if (++held_ >= capacity_) flush();
}

void Rows::flush() {
  if (held_ == 0) return;
  silence();
  errno = 0;
  std::vector<hsize_t> start(row_.size() + 1, 0), count(row_.begin(), row_.end());
  start[0] = written_;
  count.insert(count.begin(), held_);
  std::vector<hsize_t> size = count;
  size[0] = written_ + held_;
  const int rank = static_cast<int>(size.size());
  bool done = H5Dset_extent(dataset_.get(), size.data()) >= 0;
  const Id file_space(H5Dget_space(dataset_.get()));
  const Id memory_space(H5Screate_simple(rank, count.data(), nullptr));
  done = done && H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                                     nullptr) >= 0;
  done = done && H5Dwrite(dataset_.get(), H5T_NATIVE_DOUBLE, memory_space.get(), file_space.get(),
                          H5P_DEFAULT, block_.data()) >= 0;
  if (!done) fail_to_write(file_, name_);
  written_ += std::exchange(held_, 0);
  block_.clear();
}

Writer::Writer(std::filesystem::path path)
    : path_(std::move(path)), temporary_(std::make_unique<AtomicFile>(path_)) {
  silence();
  const Id access = unlocked_access();
  // The file format of HDF5 1.8 adds checksums to metadata, and that of 1.10 to the index of chunks, which
  // also takes less space.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  create(temporary_->path().string(), access);
}

// Files in memory are of no use here: the image that HDF5 1.10 returns of them has a wrong checksum. The name
// is removed at once, so that nothing remains of a process that is killed.
Writer::Writer(Unnamed) {
  silence();
  std::error_code unusable;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(unusable);
  std::string name = ((unusable ? std::filesystem::path("/tmp") : folder) / "ricochet-XXXXXX").string();
  errno = 0;
  unnamed_ = mkostemp(name.data(), O_CLOEXEC);
  path_ = name;
  if (unnamed_ < 0) fail_to_write(path_);
  const Id access = unlocked_access();
  // In older formats, the index of a compressed dataset takes 2.6 kB, often more than its values.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  try {
    create(name, access);
  } catch (...) {  // no destructor runs
    unlink(name.c_str());
    close(unnamed_);
    throw;
  }
  unlink(name.c_str());
}

void Writer::create(const std::string& name, const Id& access) {
  // Rows are written by whole chunks, of which HDF5 would otherwise keep 1 MiB for each dataset.
  constexpr std::size_t kSlots = 521;
  H5Pset_cache(access.get(), 0, kSlots, kBlockBytes, 1);
  errno = 0;
  file_ = Id(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, properties(H5P_FILE_CREATE).get(), access.get()));
  if (!file_.valid()) fail_to_write(path_);
}

Writer::~Writer() {
  rows_.clear();
  file_.reset();
  if (unnamed_ >= 0) close(unnamed_);
}

void Writer::group(const std::string& name) {
  silence();
  errno = 0;
  // Created one by one: groups that HDF5 creates implicitly would store the time.
  for (std::size_t end = 0; end != std::string::npos;) {
    end = name.find('/', end + 1);
    const std::string part = name.substr(0, end);
    if (part == "/" || H5Lexists(file_.get(), part.c_str(), H5P_DEFAULT) > 0) continue;
    const Id made(
        H5Gcreate2(file_.get(), part.c_str(), H5P_DEFAULT, properties(H5P_GROUP_CREATE).get(), H5P_DEFAULT));
    if (!made.valid()) fail_to_write(path_, part);
  }
}

Id Writer::make_dataset(const std::string& name, std::int64_t type, const Id& space, const Id& creation,
                        const std::string& unit) {
  group(name.substr(0, std::max<std::size_t>(name.rfind('/'), 1)));
  Id made(H5Dcreate2(file_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  if (!made.valid()) fail_to_write(path_, name);
  datasets_.push_back({name, unit});
  return made;
}

template <Element T>
void Writer::write(const std::string& dataset, std::span<const T> values, const Shape& shape,
                   const std::string& unit) {
  if (values.size() != count_of(shape)) throw std::logic_error(dataset + ": values do not fill the shape");
  {
    silence();
    const Id target = make_dataset(dataset, element_type<T>().file, simple_space(shape),
                                   checked_properties(shape, sizeof(T)), unit);
    errno = 0;
    if (!values.empty() &&
        H5Dwrite(target.get(), element_type<T>().memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      fail_to_write(path_, dataset);
  }
  if (!unit.empty()) attribute(dataset, "unit", unit);
}
template void Writer::write(const std::string&, std::span<const double>, const Shape&, const std::string&);
template void Writer::write(const std::string&, std::span<const float>, const Shape&, const std::string&);
template void Writer::write(const std::string&, std::span<const std::int64_t>, const Shape&,
                            const std::string&);

void Writer::write_strings(const std::string& dataset, const std::vector<std::string>& values) {
  silence();
  std::size_t longest = 1;
  for (const std::string& value : values) longest = std::max(longest, value.size());
  std::string padded;
  for (const std::string& value : values) padded += value + std::string(longest - value.size(), '\0');
  const Id type = utf8_type(longest);
  const Id target = make_dataset(dataset, type.get(), simple_space({values.size()}),
                                 checked_properties({values.size()}, longest), "");
  errno = 0;
  if (!values.empty() && H5Dwrite(target.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail_to_write(path_, dataset);
}

Rows& Writer::rows(const std::string& dataset, const Shape& row, const std::string& unit) {
  constexpr std::size_t kLongestBlock = 1024;
  const std::size_t row_bytes = std::max<std::size_t>(count_of(row), 1) * sizeof(double);
  const std::size_t block = std::clamp<std::size_t>(kBlockBytes / row_bytes, 1, kLongestBlock);
  {
    silence();
    std::vector<hsize_t> size(row.begin(), row.end()), limit, chunk;
    // Even a row without columns needs a chunk of nonzero width.
    for (const hsize_t length : size) chunk.push_back(std::max<hsize_t>(length, 1));
    limit = chunk;
    size.insert(size.begin(), 0);
    limit.insert(limit.begin(), H5S_UNLIMITED);
    chunk.insert(chunk.begin(), block);
    const int rank = static_cast<int>(size.size());
    const Id space(H5Screate_simple(rank, size.data(), limit.data()));
    const Id creation = properties(H5P_DATASET_CREATE);
    H5Pset_chunk(creation.get(), rank, chunk.data());
    if (!temporary_) {
      H5Pset_shuffle(creation.get());
      H5Pset_deflate(creation.get(), kDeflate);
    }
    H5Pset_fletcher32(creation.get());
    rows_.push_back(std::make_unique<Rows>(make_dataset(dataset, H5T_IEEE_F64LE, space, creation, unit),
                                           path_.string(), dataset, row, block));
  }
  attribute(dataset, "unit", unit);
  return *rows_.back();
}

void Writer::write_attribute(const std::string& object, const std::string& name, std::int64_t type,
                             const Id& space, const void* value) {
  silence();
  errno = 0;
  const Id target(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT));
  // The types in memory and in the file differ only in byte order; the native types below have that of the
  // processor.
  const hid_t memory = H5Tget_class(type) == H5T_FLOAT     ? H5T_NATIVE_DOUBLE
                       : H5Tget_class(type) == H5T_INTEGER ? H5T_NATIVE_INT64
                                                           : type;
  if (!target.valid() || H5Awrite(target.get(), memory, value) < 0)
    fail_to_write(path_, fmt::format("attribute {} of {}", name, object));
}

void Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
  if (value.size() > kLongestAttribute)
    throw InputError(
        fmt::format("{}: attribute {} of {} has {} bytes, and HDF5 keeps up to {}. Shorten the scene.",
                    path_.string(), name, object, value.size(), kLongestAttribute));
  // c_str(), because even an empty string takes one byte.
  write_attribute(object, name, utf8_type(value.size()).get(), Id(H5Screate(H5S_SCALAR)), value.c_str());
}

void Writer::attribute(const std::string& object, const std::string& name, double value) {
  write_attribute(object, name, H5T_IEEE_F64LE, Id(H5Screate(H5S_SCALAR)), &value);
}

void Writer::attribute(const std::string& object, const std::string& name, std::span<const double> values) {
  write_attribute(object, name, H5T_IEEE_F64LE, simple_space({values.size()}), values.data());
}

void Writer::integer_attribute(const std::string& object, const std::string& name, std::int64_t value) {
  write_attribute(object, name, H5T_STD_I64LE, Id(H5Screate(H5S_SCALAR)), &value);
}

// The values of the attribute DIMENSION_LIST are in a heap of HDF5, without a checksum. Readers of Ricochet
// do not read it. REFERENCE_LIST, by which a scale names its datasets, is not written: only programs that
// remove scales need it, and its length has a limit, which results of many bodies exceed.
void Writer::name_dimensions(const Dataset& dataset, const std::vector<std::string>& scales) {
  silence();
  if (scales_.empty())  // the first call: no rows follow
    for (const auto& rows : rows_) rows->flush();
  errno = 0;
  const auto& [name, unit] = dataset;
  const Id target(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT));
  if (!target.valid()) fail_to_write(path_, name);
  const Id space(H5Dget_space(target.get()));
  std::vector<hsize_t> lengths(
      static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.get()))));
  H5Sget_simple_extent_dims(space.get(), lengths.data(), nullptr);
  if (lengths.size() != scales.size())
    throw std::logic_error(
        fmt::format("{}: {} names for {} dimensions", name, scales.size(), lengths.size()));
  std::vector<hobj_ref_t> references(scales.size());
  std::vector<hvl_t> list;
  bool done = true;
  for (std::size_t k = 0; k < scales.size(); ++k) {
    make_scale(scales[k], lengths[k]);
    done = done && H5Rcreate(&references[k], file_.get(), scales[k].c_str(), H5R_OBJECT, -1) >= 0;
    list.push_back({.len = 1, .p = &references[k]});
  }
  if (!done) fail_to_write(path_, name);
  if (!unit.empty()) attribute(name, "units", unit);
  if (scales.front() == name) return;
  const Id type(H5Tvlen_create(H5T_STD_REF_OBJ));
  write_attribute(name, "DIMENSION_LIST", type.get(), simple_space({list.size()}), list.data());
}

/// Makes a dataset a dimension scale, and creates it first if it does not exist.
void Writer::make_scale(const std::string& name, std::uint64_t length) {
  const std::string last = name.substr(name.rfind('/') + 1);
  std::string title = last;
  if (H5Lexists(file_.get(), name.c_str(), H5P_DEFAULT) <= 0) {
    // The words by which netCDF-4 knows a dimension without values. Nothing is stored but the length.
    title = fmt::format("This is a netCDF dimension but not a netCDF variable.{:>10}", length);
    make_dataset(name, H5T_IEEE_F32BE, simple_space({length}), properties(H5P_DATASET_CREATE), "");
  }
  const Id scale(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT));
  const Id space(H5Dget_space(scale.get()));
  if (H5Sget_simple_extent_npoints(space.get()) != static_cast<hssize_t>(length))
    throw std::logic_error(fmt::format("{}: a scale of another length than {}", name, length));
  if (!scales_.insert(name).second) return;
  // HDF5 requires a text that ends with a zero byte here.
  const auto text = [&](const char* attribute, const std::string& value) {
    const Id type(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.get(), value.size() + 1);
    write_attribute(name, attribute, type.get(), Id(H5Screate(H5S_SCALAR)), value.c_str());
  };
  text("CLASS", "DIMENSION_SCALE");
  text("NAME", title);
}

void Writer::finish() {
  silence();
  for (const auto& rows : rows_) rows->flush();
  rows_.clear();
  errno = 0;
  // Flush first: closing does not report every write error.
  if (H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0) fail_to_write(path_);
  if (H5Fclose(file_.release()) < 0) fail_to_write(path_);
}

std::string Writer::content() {
  finish();
  std::string out(static_cast<std::size_t>(std::max<off_t>(lseek(unnamed_, 0, SEEK_END), 0)), '\0');
  for (std::size_t at = 0; at < out.size();) {
    const ssize_t read = pread(unnamed_, out.data() + at, out.size() - at, static_cast<off_t>(at));
    if (read <= 0) fail_to_write(path_);
    at += static_cast<std::size_t>(read);
  }
  return out;
}

void Writer::commit(const std::filesystem::path& outdated) {
  finish();
  temporary_->commit(outdated);
}

}  // namespace ricochet::base::hdf5
