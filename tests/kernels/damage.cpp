// SPDX-License-Identifier: BSD-2-Clause
// Kernel files that are truncated, damaged, foreign or malicious. Each gives a one-line
// error that names the file and the fault.
#include <functional>

#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "tests/kernels/hostile.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace damage_test {

using test::bytes_of;
using test::complaint_of;
using test::Folder;
using test::put_bytes;
using test::sample_kernel;

/// A complete kernel file, modified by `spoil`.
class Damage : public testing::Test {
 protected:
  Damage() : path_(folder_ / "body.kernel.h5") {
    Kernel kernel = sample_kernel(3, 5, 4);
    kernel.surface.element_normal.clear();  // which would have to fit damaged elements
    write(kernel, path_);
  }

  void spoil(const std::function<void(hid_t)>& change) const {
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    change(file);
    ASSERT_GE(H5Fclose(file), 0);
  }

  void replace(const std::string& name, hid_t type, const std::vector<hsize_t>& dims, const void* values,
               hid_t creation = H5P_DEFAULT) const {
    spoil([&](hid_t file) {
      H5Ldelete(file, name.c_str(), H5P_DEFAULT);
      const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
      const hid_t dataset = H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
      ASSERT_GE(dataset, 0);
      if (values != nullptr) H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
      H5Dclose(dataset);
      H5Sclose(space);
    });
  }

  void replace_attribute(const std::string& object, const std::string& name, hid_t type,
                         const void* value) const {
    spoil([&](hid_t file) {
      H5Adelete_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT);
      const hid_t space = H5Screate(H5S_SCALAR);
      const hid_t attribute = H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space, H5P_DEFAULT,
                                                H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, type, value);
      H5Aclose(attribute);
      H5Sclose(space);
    });
  }

  /// Overwrites one value of a dataset of doubles.
  void poke(const std::string& name, std::size_t place, double value) const {
    spoil([&](hid_t file) {
      const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
      const hid_t space = H5Dget_space(dataset);
      std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
      H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      values.at(place) = value;
      H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      H5Sclose(space);
      H5Dclose(dataset);
    });
  }

  /// Expects that reading fails with a line that starts with the file name and contains each of `parts`.
  void expect_refused(const std::vector<std::string>& parts) const {
    const std::string message = complaint_of([&] { read(path_); });
    EXPECT_EQ(message.find(path_.string() + ": "), 0U) << message;
    for (const std::string& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  }

  Folder folder_;
  std::filesystem::path path_;
};

TEST_F(Damage, a_file_cut_anywhere_is_refused) {
  const std::string whole = bytes_of(path_);
  for (std::size_t i = 0; i < 20; ++i) {
    // From the empty file and the first header bytes to a file that lacks only its last byte.
    const std::size_t kept = i < 4 ? i * 16 : i == 19 ? whole.size() - 1 : whole.size() * i / 20;
    put_bytes(path_, whole.substr(0, kept));
    expect_refused({"Compute it again with ricochet-kernel."});
    EXPECT_EQ(read_hash(path_), "") << kept;
  }
}

TEST_F(Damage, a_file_with_a_wrong_byte_is_refused_or_read_but_never_a_crash) {
  const std::string whole = bytes_of(path_);
  std::mt19937_64 random(11);
  for (int i = 0; i < 2000; ++i) {
    std::string spoilt = whole;
    for (int j = 0; j <= i % 3; ++j) spoilt[random() % spoilt.size()] = static_cast<char>(random());
    put_bytes(path_, spoilt);
    try {
      read(path_);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

// Few values are stored in object headers and many in chunks; both have checksums, and so has the rest of the
// file but its unused bytes.
TEST_F(Damage, a_flipped_bit_is_refused_or_changes_nothing) {
  write(sample_kernel(3, 40, 30), path_);
  const std::string whole = bytes_of(path_);
  const auto again = folder_ / "again.kernel.h5";
  write(read(path_), again);
  ASSERT_EQ(bytes_of(again), whole);
  std::mt19937_64 random(7);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string spoilt = whole;
    spoilt[random() % spoilt.size()] ^= static_cast<char>(1U << (random() % 8));
    put_bytes(path_, spoilt);
    try {
      write(read(path_), again);
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    ASSERT_EQ(bytes_of(again), whole) << "flip " << i;
  }
  EXPECT_GT(refused, 250);
}

TEST_F(Damage, files_that_are_not_kernels_are_recognised) {
  put_bytes(path_, "title = \"Two disks\"\n");
  expect_refused({"is not an HDF5 file"});
  std::filesystem::remove(path_);
  expect_refused({"there is no such file"});
  EXPECT_EQ(read_hash(path_), "");
  std::filesystem::create_directory(path_);
  expect_refused({"is not a file"});
  std::filesystem::remove(path_);
  H5Fclose(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  expect_refused({"is not a Ricochet kernel"});
  EXPECT_EQ(read_hash(path_), "");
}

TEST_F(Damage, of_each_kind_is_refused_in_its_line) {
  const std::string whole = bytes_of(path_), certificate = "/modes/certificate", rate = "/modes/decay_rate";
  const std::vector<double> ones(5, 1.0);
  const std::vector<std::int64_t> integers(8, 0);
  const auto count = [&](const char* name, std::int64_t value) {
    replace_attribute(certificate, name, H5T_NATIVE_INT64, &value);
  };
  const auto without = [&](const char* name) {
    spoil([&](hid_t file) { H5Ldelete(file, name, H5P_DEFAULT); });
  };
  const std::vector<std::pair<std::function<void()>, std::vector<std::string>>> refusals = {
      {[&] {
         const std::int64_t version = 4;
         replace_attribute("/", "version", H5T_NATIVE_INT64, &version);
         EXPECT_EQ(read_hash(path_), "");
       },
       {"format version 4", "reads versions up to 3", "Use a newer Ricochet"}},
      {[&] { count("complete", 0); }, {"certificate is not complete"}},
      {[&] { count("count_found", 6); }, {"certificate is for 4 modes", "has 5"}},
      // The sample has five modes, and two were truncated. Without this note, two modes are missing.
      {[&] { count("count_found", 5), count("left_out", 0); },
       {"has 5 modes below 1591.55 Hz, but its certificate counted 7"}},
      {[&] { count("count_found", INT64_MIN), count("left_out", 1); }, {"contains a negative count"}},
      {[&] { count("approximate", 1); },
       {"its modes are not certified", "Compute it again with ricochet-kernel."}},
      // The name is quoted in messages, which must fit on one line.
      {[&] {
         const hid_t type = H5Tcopy(H5T_C_S1);
         H5Tset_size(type, 3);
         replace_attribute("/", "body", type, "a\nb");
         H5Tclose(type);
       },
       {"attribute \"body\" contains control characters"}},
      {[&] { without("/loads/rotation"); }, {"dataset \"/loads/rotation\" is missing"}},
      {[&] { spoil([](hid_t file) { H5Adelete_by_name(file, "/", "mass", H5P_DEFAULT); }); },
       {"attribute \"mass\" of \"/\" is missing"}},
      {[&] { replace(rate, H5T_NATIVE_DOUBLE, {3}, ones.data()); },
       {"dataset \"/modes/decay_rate\" has shape (3), expected (5). Was it truncated? Compute it again"}},
      {[&] {
         replace(rate, H5T_NATIVE_DOUBLE, {1, 3}, ones.data());
       },
       {"has shape (1, 3), expected (5)"}},
      {[&] { replace(rate, H5T_NATIVE_INT64, {5}, integers.data()); },
       {"dataset \"/modes/decay_rate\" does not hold floating-point numbers"}},
      {[&] {
         without("/modes/decay_rate");
         spoil([&](hid_t file) {
           H5Gclose(H5Gcreate2(file, rate.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
         });
       },
       {"\"/modes/decay_rate\" is not a dataset"}},
      {[&] { replace_attribute("/", "dofs", H5T_NATIVE_DOUBLE, ones.data()); },
       {"attribute \"dofs\" of \"/\" does not hold 1 integer"}},
      {[&] { replace_attribute("/", "body", H5T_NATIVE_DOUBLE, ones.data()); },
       {"attribute \"body\" of \"/\" is not a string of fixed length"}},
      {[&] { poke("/surface/area", 3, -1e-6); },
       {"\"/surface/area\" contains -1e-06 at index 3: must be positive"}},
      {[&] { poke("/surface/normal", 4, 0.5); }, {"\"/surface/normal\"", "row 1", "unit vector"}},
      {[&] {
         replace("/surface/element", H5T_NATIVE_INT64, {2, 4}, integers.data());
       },
       {"\"/surface/element\" has 4 corners"}},
      {[&] {
         replace("/surface/element", H5T_NATIVE_INT64, {2, 0}, nullptr);
       },
       {"\"/surface/element\" has 0 corners"}}};
  for (const auto& [change, parts] : refusals) {
    SCOPED_TRACE(parts[0]);
    put_bytes(path_, whole);
    change();
    expect_refused(parts);
  }
}

// One truncated mode suffices for the counts to differ from the modes that are left.
TEST_F(Damage, inertia_counts_apply_only_to_modes_of_which_none_is_truncated) {
  Kernel kernel = sample_kernel(3, 5, 4);
  for (const std::int64_t left_out : {1, 2}) {
    kernel.modes.certificate.left_out = left_out;
    kernel.modes.certificate.count_found = 5 + left_out;
    write(kernel, path_);
    EXPECT_EQ(read(path_).modes.certificate.left_out, left_out);
  }
}

TEST_F(Damage, a_value_that_is_not_a_number_is_refused_wherever_it_stands) {
  const std::string whole = bytes_of(path_);
  for (const std::string name : {"/body/centre",
                                 "/body/inertia",
                                 "/body/outline",
                                 "/body/piece_box",
                                 "/modes/angular_frequency",
                                 "/modes/decay_rate",
                                 "/modes/residual",
                                 "/surface/node",
                                 "/surface/normal",
                                 "/surface/area",
                                 "/surface/shape",
                                 "/surface/residual_flexibility",
                                 "/loads/body_force",
                                 "/loads/rotation",
                                 "/loads/body_force_residual",
                                 "/loads/point 1",
                                 "/load_data/upper face/total",
                                 "/load_data/upper face/moment",
                                 "/load_data/point 1/residual",
                                 "/motions/f\u00fc\u00dfe/participation",
                                 "/motions/f\u00fc\u00dfe/residual",
                                 "/motions/f\u00fc\u00dfe/momentum",
                                 "/receivers/rotations",
                                 "/receiver_data/rotations/point",
                                 "/receiver_data/rotations/residual_flexibility",
                                 "/receiver_data/rotations/body_force_residual",
                                 "/receiver_data/rotations/load_residual",
                                 "/receiver_data/rotations/motion_residual",
                                 "/view/node"}) {
    put_bytes(path_, whole);
    poke(name, 2, std::nan(""));
    expect_refused({"dataset \"" + name + "\" contains nan at index 2"});
  }
}

TEST_F(Damage, a_surface_element_of_points_that_do_not_exist_is_refused) {
  for (const std::int64_t index : {std::int64_t{-1}, std::int64_t{4}, INT64_MAX, INT64_MIN}) {
    const std::vector<std::int64_t> element = {0, 1, index, 2};
    replace("/surface/element", H5T_NATIVE_INT64, {2, 2}, element.data());
    expect_refused(
        {"\"/surface/element\" contains " + std::to_string(index) + " at index 2: must be an index below 4"});
  }
}

TEST_F(Damage, a_dataset_that_claims_more_than_the_file_holds_is_refused_before_memory_is_taken) {
  replace("/modes/angular_frequency", H5T_NATIVE_DOUBLE, {hsize_t{1} << 50}, nullptr);
  expect_refused({"\"/modes/angular_frequency\" claims shape (1125899906842624)"});
  replace("/view/node", H5T_NATIVE_DOUBLE, {hsize_t{1} << 59, 3}, nullptr);  // 3·8·2^59 overflows 64 bits
  expect_refused({"\"/modes/angular_frequency\""});
}

TEST_F(Damage, a_product_of_dimensions_beyond_64_bits_is_refused) {
  replace("/view/node", H5T_NATIVE_INT8, {hsize_t{1} << 59, 3}, nullptr);
  expect_refused({"\"/view/node\" does not hold floating-point numbers"});
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t chunk[2] = {16, 3};
  H5Pset_chunk(creation, 2, chunk);
  replace("/view/node", H5T_NATIVE_FLOAT, {hsize_t{1} << 60, 3}, nullptr, creation);
  H5Pclose(creation);
  expect_refused({"\"/view/node\" claims shape (1152921504606846976, 3)"});
}

TEST_F(Damage, a_link_to_another_file_is_refused) {
  const Folder elsewhere;
  write(sample_kernel(3, 5, 4), elsewhere / "secret.h5");
  spoil([&](hid_t file) {
    H5Ldelete(file, "/modes/decay_rate", H5P_DEFAULT);
    H5Lcreate_external((elsewhere / "secret.h5").c_str(), "/modes/decay_rate", file, "/modes/decay_rate",
                       H5P_DEFAULT, H5P_DEFAULT);
  });
  expect_refused({"dataset \"/modes/decay_rate\" is a link"});
}

TEST_F(Damage, a_group_that_is_a_link_to_another_file_is_refused) {
  const Folder elsewhere;
  write(sample_kernel(3, 5, 4), elsewhere / "secret.h5");
  spoil([&](hid_t file) {
    H5Ldelete(file, "/loads", H5P_DEFAULT);
    H5Lcreate_external((elsewhere / "secret.h5").c_str(), "/loads", file, "/loads", H5P_DEFAULT, H5P_DEFAULT);
  });
  expect_refused({"\"/loads/body_force\" is a link"});
}

TEST_F(Damage, data_kept_in_another_file_is_refused) {
  const Folder elsewhere;
  put_bytes(elsewhere / "secret.bin", std::string(40, '\0'));
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(creation, (elsewhere / "secret.bin").c_str(), 0, 40);
  replace("/modes/decay_rate", H5T_NATIVE_DOUBLE, {5}, nullptr, creation);
  H5Pclose(creation);
  expect_refused({"\"/modes/decay_rate\" keeps its data in another file"});
}

// Units are informative, and only those of loads are read. A pressure without its attribute is another load,
// which no scene with a pressure takes.
TEST_F(Damage, whatever_stands_in_the_place_of_an_object_is_refused_in_one_line) {
  ricochet::test::for_each_hostile_change(
      path_, {"unit", "parts", "held_on_lines", "mesh_error_coupling", "acts"}, [&](const std::string& what) {
        SCOPED_TRACE(what);
        expect_refused({});
      });
}

TEST_F(Damage, compressed_copies_of_a_kernel_are_read) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t chunk[1] = {5};
  H5Pset_chunk(creation, 1, chunk);
  H5Pset_deflate(creation, 9);
  const std::vector<double> values = {0.0, 0.01, 0.02, 0.03, 0.04};
  replace("/modes/decay_rate", H5T_NATIVE_DOUBLE, {5}, values.data(), creation);
  H5Pclose(creation);
  EXPECT_EQ(read(path_).modes.decay_rate, values);
}

}  // namespace damage_test
}  // namespace ricochet::kernels
