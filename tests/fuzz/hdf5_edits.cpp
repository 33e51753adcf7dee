// SPDX-License-Identifier: BSD-2-Clause
#include "tests/fuzz/hdf5_edits.hpp"

#define H5_USE_110_API
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

namespace ricochet::fuzz {
namespace {

void put(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The names of all objects of a file except its root, in alphabetical order.
std::vector<std::string> names_in(hid_t file) {
  std::vector<std::string> names;
  H5Lvisit(
      file, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->push_back(std::string("/") + name);
        return 0;
      },
      &names);
  return names;
}

/// Handles are closed with the file, because an edit may fail anywhere.
class Editor {
 public:
  Editor(hid_t file, Bytes& bytes) : file_(file), bytes_(bytes), names_(names_in(file)) {}

  void edit() {
    switch (bytes_.below(9)) {
      case 0:
        return replace(some_name());
      case 1:
        H5Ldelete(file_, some_name().c_str(), H5P_DEFAULT);
        return;
      case 2:
        return link(some_name());
      case 3:
        return replace_attribute();
      case 4:
        return delete_attribute();
      case 5:
      case 6:
        return poke<double>(H5T_NATIVE_DOUBLE, some_double());
      case 7:
        return poke<std::int64_t>(H5T_NATIVE_INT64, some_integer());
      default:
        return rename();
    }
  }

 private:
  const std::string& some_name() { return names_[bytes_.number<std::uint8_t>() % names_.size()]; }

  double some_double() {
    using limits = std::numeric_limits<double>;
    const std::array values = {0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               limits::quiet_NaN(),
                               limits::infinity(),
                               -limits::infinity(),
                               1e308,
                               -1e308,
                               1e-308,
                               5e-324,
                               1e30,
                               1e-30};
    const unsigned choice = bytes_.below(values.size() + 3);
    return choice < values.size() ? values[choice] : bytes_.number<double>();
  }

  std::int64_t some_integer() {
    using limits = std::numeric_limits<std::int64_t>;
    const std::array<std::int64_t, 8> values = {
        0, 1, 2, 3, -1, limits::max(), limits::min(), 1'000'000'000'000};
    const unsigned choice = bytes_.below(values.size() + 2);
    return choice < values.size() ? values[choice] : bytes_.number<std::int64_t>();
  }

  hid_t some_type() {
    const std::size_t length = 1 + bytes_.below(20);
    switch (bytes_.below(16)) {
      case 0:
        return H5T_IEEE_F64LE;
      case 1:
        return H5T_IEEE_F32BE;
      case 2:
        return H5T_STD_I64LE;
      case 3:
        return H5T_STD_U8BE;
      case 4:
        return H5T_STD_I32LE;
      case 5:
        return H5T_NATIVE_LDOUBLE;
      case 6: {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, length);
        return type;
      }
      case 7: {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        return type;
      }
      case 8: {
        const hid_t type = H5Tcreate(H5T_COMPOUND, 16);
        H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
        return type;
      }
      case 9: {
        const hsize_t size = length;
        return H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &size);
      }
      case 10:
        return H5Tvlen_create(H5T_NATIVE_DOUBLE);
      case 11:
        return H5T_STD_REF_OBJ;
      case 12:
        return H5Tcreate(H5T_OPAQUE, length);
      case 13: {
        const hid_t type = H5Tenum_create(H5T_NATIVE_INT);
        const int value = 1;
        H5Tenum_insert(type, "one", &value);
        return type;
      }
      case 14:
        return H5T_STD_B64LE;
      default: {  // an unusual floating-point format
        const hid_t type = H5Tcopy(H5T_IEEE_F64LE);
        H5Tset_fields(type, 15, 10, 5, 0, 10);
        H5Tset_precision(type, 16);
        H5Tset_size(type, 2 + bytes_.below(7));
        return type;
      }
    }
  }

  std::vector<hsize_t> some_shape() {
    constexpr std::array<hsize_t, 12> lengths = {
        0, 1, 2, 3, 4, 5, 6, 9, 100, 5000, hsize_t{1} << 32, hsize_t{1} << 60};
    std::vector<hsize_t> shape(bytes_.below(5));
    for (hsize_t& length : shape) length = lengths[bytes_.below(lengths.size())];
    return shape;
  }

  hid_t some_space(const std::vector<hsize_t>& shape) {
    if (shape.empty()) return H5Screate(bytes_.below(2) == 0 ? H5S_SCALAR : H5S_NULL);
    return H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  }

  hid_t some_layout(const std::vector<hsize_t>& shape) {
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    const unsigned choice = bytes_.below(8);
    if (choice == 1) H5Pset_layout(list, H5D_COMPACT);
    if (choice == 2) H5Pset_external(list, "/etc/hostname", 0, H5F_UNLIMITED);
    if (choice == 3 && !shape.empty()) {
      const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
      H5Pset_virtual(list, space, "/etc/hostname", "/x", space);
    }
    if (choice < 4) return list;
    std::vector<hsize_t> chunk = shape;
    for (hsize_t& length : chunk) length = std::clamp<hsize_t>(length, 1, 1 + bytes_.below(200));
    if (!chunk.empty()) H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
    const unsigned filters = bytes_.below(64);
    if ((filters & 1) != 0) H5Pset_deflate(list, 6);
    if ((filters & 2) != 0) H5Pset_shuffle(list);
    if ((filters & 4) != 0) H5Pset_fletcher32(list);
    if ((filters & 8) != 0) H5Pset_nbit(list);
    if ((filters & 16) != 0) H5Pset_scaleoffset(list, H5Z_SO_INT, 0);
    if ((filters & 32) != 0) H5Pset_szip(list, H5_SZIP_NN_OPTION_MASK, 8);
    return list;
  }

  /// `size` bytes that repeat the next ones of the input.
  std::vector<char> some_bytes(std::size_t size) {
    std::array<char, 16> piece{};
    for (char& c : piece) c = bytes_.number<char>();
    std::vector<char> all(size);
    for (std::size_t i = 0; i < size; ++i) all[i] = piece[i % piece.size()];
    return all;
  }

  static bool holds_pointers(hid_t type) {
    return H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0;
  }

  /// HDF5 1.10 reads and writes out of bounds when it compresses data with some of its other filters.
  static bool safely_written(hid_t dataset) {
    const hid_t list = H5Dget_create_plist(dataset);
    for (int i = 0; i < H5Pget_nfilters(list); ++i) {
      unsigned flags = 0, config = 0;
      std::size_t values = 0;
      const H5Z_filter_t filter =
          H5Pget_filter2(list, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
      if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
        return false;
    }
    return true;
  }

  void replace(const std::string& name) {
    const hid_t type = some_type();
    const std::vector<hsize_t> shape = some_shape();
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    const hid_t dataset = H5Dcreate2(file_, name.c_str(), type, some_space(shape), H5P_DEFAULT,
                                     some_layout(shape), H5P_DEFAULT);
    if (dataset < 0 || !safely_written(dataset)) return;
    double values = 1;
    for (const hsize_t length : shape) values *= static_cast<double>(length);
    if (values * static_cast<double>(H5Tget_size(type)) > 1 << 20 || holds_pointers(type)) return;
    const std::vector<char> data = some_bytes(static_cast<std::size_t>(values) * H5Tget_size(type));
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
  }

  void link(const std::string& name) {
    const std::string& target = some_name();
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    switch (bytes_.below(5)) {
      case 0:
        H5Lcreate_soft(target.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      case 1:
        H5Lcreate_external("/etc/hostname", target.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      case 2:
        H5Lcreate_hard(file_, target.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      case 3:
        H5Lcreate_hard(file_, "/", file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      default:
        H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    }
  }

  hid_t some_object() {
    const std::string name = bytes_.below(2) == 0 ? "/" : some_name();
    return H5Oopen(file_, name.c_str(), H5P_DEFAULT);
  }

  static std::string attribute_name(hid_t object, unsigned number) {
    std::string name(100, '\0');
    const ssize_t length = H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, number, name.data(),
                                              name.size(), H5P_DEFAULT);
    return name.substr(0, length > 0 ? static_cast<std::size_t>(length) : 0);
  }

  void delete_attribute() {
    const hid_t object = some_object();
    H5Adelete(object, attribute_name(object, bytes_.below(14)).c_str());
  }

  void replace_attribute() {
    const hid_t object = some_object();
    const std::string name = attribute_name(object, bytes_.below(14));
    const unsigned kind = bytes_.below(4);
    const hid_t type = kind == 0 ? H5T_NATIVE_DOUBLE : kind == 1 ? H5T_NATIVE_INT64 : some_type();
    const hid_t space = kind < 2 ? H5Screate(H5S_SCALAR) : some_space(some_shape());
    // HDF5 keeps attributes of any size in memory.
    if (H5Sget_simple_extent_npoints(space) > 1 << 20) return;
    H5Adelete(object, name.c_str());
    const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0) return;
    if (kind == 0) {
      const double value = some_double();
      H5Awrite(attribute, type, &value);
    } else if (kind == 1) {
      const std::int64_t value = some_integer();
      H5Awrite(attribute, type, &value);
    } else if (H5Sget_simple_extent_npoints(space) < 5000 && !holds_pointers(type)) {
      const auto count = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
      const std::vector<char> data = some_bytes(count * H5Tget_size(type));
      H5Awrite(attribute, type, data.data());
    }
  }

  template <class T>
  void poke(hid_t type, T value) {
    const hid_t dataset = H5Dopen2(file_, some_name().c_str(), H5P_DEFAULT);
    const hssize_t count = dataset < 0 ? 0 : H5Sget_simple_extent_npoints(H5Dget_space(dataset));
    if (count < 1 || count > 1 << 20 || !safely_written(dataset)) return;
    std::vector<T> values(static_cast<std::size_t>(count));
    if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return;
    values[bytes_.number<std::uint16_t>() % values.size()] = value;
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }

  /// Replaces a list of names by other strings.
  void rename() {
    const std::string& name = some_name();
    const std::size_t width = 1 + bytes_.below(8);
    const hsize_t count = bytes_.below(4);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, width);
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    const hid_t dataset = H5Dcreate2(file_, name.c_str(), type, H5Screate_simple(1, &count, nullptr),
                                     H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    std::vector<char> text(width * count);
    for (char& c : text) c = bytes_.number<char>();
    if (dataset >= 0 && count > 0) H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  }

  hid_t file_;
  Bytes& bytes_;
  std::vector<std::string> names_;
};

}  // namespace

void make_hdf5(const std::uint8_t* data, std::size_t size, const std::filesystem::path& path,
               unsigned variants, const std::function<void(unsigned, const std::filesystem::path&)>& write) {
  constexpr std::string_view signature = "\x89HDF";
  if (size >= signature.size() && std::memcmp(data, signature.data(), signature.size()) == 0) {
    put(path, {reinterpret_cast<const char*>(data), size});
    return;
  }
  // HDF5 must not reuse freed memory, so that sanitizers detect accesses to it.
  static const herr_t unkept = H5set_free_list_limits(0, 0, 0, 0, 0, 0);
  require(unkept >= 0, "HDF5 keeps free lists");
  Bytes bytes(data, size);
  static std::map<unsigned, std::string> written;
  const unsigned variant = bytes.below(variants);
  if (written.count(variant) == 0) {
    write(variant, path);
    std::ifstream stream(path, std::ios::binary);
    written[variant].assign(std::istreambuf_iterator<char>(stream), {});
  }
  put(path, written[variant]);
  if (bytes.empty()) return;
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  Editor editor(file, bytes);
  for (int edits = 0; !bytes.empty() && edits < 8; ++edits) editor.edit();
  H5Fclose(file);
  // Closing a file does not close types, spaces and property lists.
  for (const H5I_type_t kind : {H5I_DATATYPE, H5I_DATASPACE, H5I_GENPROP_LST}) H5Iclear_type(kind, false);
}

}  // namespace ricochet::fuzz
