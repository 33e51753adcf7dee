// SPDX-License-Identifier: BSD-2-Clause
// Malicious replacements of the datasets and attributes of an HDF5 file.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace ricochet::test {

struct Objects {
  std::vector<std::string> groups, datasets;
  std::vector<std::pair<std::string, std::string>>
      attributes;  ///< attributes, each with the name of its object
};

/// All objects of a file, except the attributes listed in `kept`.
inline Objects objects_in(const std::filesystem::path& path, const std::set<std::string>& kept) {
  Objects found;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t at, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    auto& [objects, keep] = *static_cast<std::pair<Objects*, std::set<std::string>>*>(data);
    const std::string object = std::string(name) == "." ? "/" : "/" + std::string(name);
    if (object != "/")
      (info->type == H5O_TYPE_DATASET ? objects->datasets : objects->groups).push_back(object);
    for (hsize_t k = 0; k < info->num_attrs; ++k) {
      std::vector<char> text(300);
      H5Aget_name_by_idx(at, name, H5_INDEX_NAME, H5_ITER_INC, k, text.data(), text.size(), H5P_DEFAULT);
      if (!keep.contains(text.data())) objects->attributes.emplace_back(object, text.data());
    }
    return 0;
  };
  std::pair<Objects*, std::set<std::string>> data(&found, kept);
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, visit, &data);
  H5Fclose(file);
  return found;
}

/// Creates an object with this name in a file.
using Maker = std::function<void(hid_t file, const char* name)>;

inline void make_dataset(hid_t file, const char* name, hid_t type, const std::vector<hsize_t>& dims,
                         hid_t creation = H5P_DEFAULT) {
  const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
  H5Dclose(H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Sclose(space);
}

/// The replacements and their names for messages.
inline const std::map<std::string, Maker>& hostile_objects() {
  static const hid_t text = [] {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    return type;
  }();
  static const hid_t pair = [] {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(type, "a", 0, H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "b", 8, H5T_NATIVE_DOUBLE);
    return type;
  }();
  static const std::map<std::string, Maker> all = {
      {"a soft link to itself",
       [](hid_t file, const char* name) { H5Lcreate_soft(name, file, name, H5P_DEFAULT, H5P_DEFAULT); }},
      {"a soft link to the root",
       [](hid_t file, const char* name) { H5Lcreate_soft("/", file, name, H5P_DEFAULT, H5P_DEFAULT); }},
      {"a link to another file",
       [](hid_t file, const char* name) {
         H5Lcreate_external("/dev/zero", "/x", file, name, H5P_DEFAULT, H5P_DEFAULT);
       }},
      {"the root itself",
       [](hid_t file, const char* name) { H5Lcreate_hard(file, "/", file, name, H5P_DEFAULT, H5P_DEFAULT); }},
      {"strings of any length", [](hid_t file, const char* name) { make_dataset(file, name, text, {4}); }},
      {"compounds", [](hid_t file, const char* name) { make_dataset(file, name, pair, {4}); }},
      {"references", [](hid_t file, const char* name) { make_dataset(file, name, H5T_STD_REF_OBJ, {4}); }},
      {"long doubles",
       [](hid_t file, const char* name) { make_dataset(file, name, H5T_NATIVE_LDOUBLE, {4}); }},
      {"bits", [](hid_t file, const char* name) { make_dataset(file, name, H5T_NATIVE_B8, {4}); }},
      {"six dimensions of nothing",
       [](hid_t file, const char* name) {
         make_dataset(file, name, H5T_NATIVE_DOUBLE, {0, 0, 0, 0, 0, 0});
       }},
      {"a petabyte in chunks",
       [](hid_t file, const char* name) {
         const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
         const hsize_t chunk = 1 << 16;
         H5Pset_chunk(creation, 1, &chunk);
         make_dataset(file, name, H5T_NATIVE_DOUBLE, {hsize_t{1'000'000'000'000'000}}, creation);
         H5Pclose(creation);
       }},
      {"no values",
       [](hid_t file, const char* name) {
         const hid_t space = H5Screate(H5S_NULL);
         H5Dclose(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
         H5Sclose(space);
       }},
      {"a view of another file",
       [](hid_t file, const char* name) {
         const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
         const hsize_t four = 4;
         const hid_t space = H5Screate_simple(1, &four, nullptr);
         H5Pset_virtual(creation, space, "/dev/zero", "/x", space);
         H5Sclose(space);
         make_dataset(file, name, H5T_NATIVE_DOUBLE, {4}, creation);
         H5Pclose(creation);
       }},
  };
  return all;
}

/// Replaces an object by the one that `make` creates.
inline void replace(const std::filesystem::path& path, const std::string& object, const Maker& make) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, object.c_str(), H5P_DEFAULT);
  make(file, object.c_str());
  H5Fclose(file);
}

/// Replaces an attribute by five thousand numbers, or removes it if `type` is 0.
inline void replace_attribute(const std::filesystem::path& path, const std::string& object,
                              const std::string& name, hid_t type) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Adelete_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT);
  if (type != 0) {
    const hsize_t many = 5'000;
    const hid_t space = H5Screate_simple(1, &many, nullptr);
    H5Aclose(H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT,
                               H5P_DEFAULT));
    H5Sclose(space);
  }
  H5Fclose(file);
}

/// Calls `read` after each malicious change of the file; `what` describes the change.
inline void for_each_hostile_change(const std::filesystem::path& path,
                                    const std::set<std::string>& kept_attributes,
                                    const std::function<void(const std::string& what)>& read) {
  const Objects objects = objects_in(path, kept_attributes);
  const std::filesystem::path whole = path.string() + ".whole";
  std::filesystem::rename(path, whole);
  const auto changed = [&](const std::string& what, const auto& change) {
    std::filesystem::copy_file(whole, path, std::filesystem::copy_options::overwrite_existing);
    change();
    read(what);
  };
  for (const auto* list : {&objects.datasets, &objects.groups})
    for (const std::string& object : *list)
      for (const auto& [what, make] : hostile_objects())
        changed(object + ": " + what, [&, &make = make] { replace(path, object, make); });
  for (const auto& [object, name] : objects.attributes)
    for (const hid_t type : {hid_t{0}, H5T_NATIVE_DOUBLE, H5T_NATIVE_INT64, H5T_STD_REF_OBJ})
      changed(object + ": " + name,
              [&, &object = object, &name = name] { replace_attribute(path, object, name, type); });
}

}  // namespace ricochet::test
