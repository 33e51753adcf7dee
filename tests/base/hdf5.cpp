// SPDX-License-Identifier: BSD-2-Clause
// Tests of the HDF5 wrapper alone: growing datasets, suppressed error output, closed handles.
#include "base/hdf5_reader.hpp"
#include "base/hdf5_writer.hpp"

#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::base::hdf5 {
namespace hdf5_test {

using test::complaint_of;
using test::Folder;

TEST(Rows, read_back_in_order_for_any_block) {
  const Folder folder;
  constexpr std::size_t kRows = 3000;  // longer than the longest block of 1024 rows, and no multiple of it
  {
    Writer file(folder / "rows.h5");
    Rows& time = file.rows("/time", {}, "s");
    Rows& force = file.rows("/contact/force", {7}, "N");
    Rows& wide = file.rows("/contact/wide", {3, 5000}, "m");  // a row is larger than a block
    for (std::size_t k = 0; k < kRows; ++k) {
      time.append(static_cast<double>(k));
      std::vector<double> row(7);
      for (std::size_t i = 0; i < 7; ++i) row[i] = static_cast<double>(100 * k + i);
      force.append(row);
      if (k < 3) wide.append(std::vector<double>(15000, static_cast<double>(k)));
    }
    file.commit();
  }
  const Reader file(folder / "rows.h5", "Advice.");
  const std::vector<double> time = file.read<double>("/time", {kRows});
  const std::vector<double> force = file.read<double>("/contact/force", {kRows, 7});
  for (std::size_t k = 0; k < kRows; ++k) {
    ASSERT_EQ(time[k], static_cast<double>(k));
    for (std::size_t i = 0; i < 7; ++i) ASSERT_EQ(force[7 * k + i], static_cast<double>(100 * k + i));
  }
  EXPECT_EQ(file.read<double>("/contact/wide", {any, 3, 5000})[2 * 15000 + 14999], 2.0);
  EXPECT_EQ(file.string_attribute("/contact/force", "unit"), "N");
}

TEST(FileWithoutAName, is_compressed_and_returned_whole) {
  const Folder folder;
  const auto temporary = [] {
    const std::filesystem::directory_iterator all(std::filesystem::temp_directory_path());
    return std::ranges::count_if(all, [](const auto& entry) {
      const std::string name = entry.path().filename().string();
      return name.starts_with("ricochet-") && name.size() == std::string_view("ricochet-XXXXXX").size() &&
             entry.is_regular_file();
    });
  };
  const auto before = temporary();
  constexpr std::size_t kRows = 3000;
  Writer file(Unnamed{});
  Rows& smooth = file.rows("/smooth", {2}, "m");
  for (std::size_t k = 0; k < kRows; ++k)
    smooth.append(std::vector<double>{static_cast<double>(k), -static_cast<double>(k)});
  EXPECT_EQ(temporary(), before);  // nothing remains of a process that is killed here
  const std::string content = file.content();
  EXPECT_LT(content.size(), kRows * 2 * sizeof(double) / 2);
  std::ofstream(folder / "copy.h5", std::ios::binary) << content;
  const Reader copy(folder / "copy.h5", "Advice.");
  const std::vector<double> values = copy.read<double>("/smooth", {kRows, 2});
  for (std::size_t k = 0; k < kRows; ++k) {
    ASSERT_EQ(values[2 * k], static_cast<double>(k));
    ASSERT_EQ(values[2 * k + 1], -static_cast<double>(k));
  }
}

TEST(Rows, may_stay_empty) {
  const Folder folder;
  Writer file(folder / "rows.h5");
  file.rows("/contact/force", {7}, "N");
  file.rows("/contact/none", {0}, "N").append(std::vector<double>());
  file.commit();
  const Reader reader(folder / "rows.h5", "Advice.");
  EXPECT_TRUE(reader.read<double>("/contact/force", {0, 7}).empty());
  EXPECT_EQ(reader.shape("/contact/none"), (Shape{1, 0}));
}

TEST(Rows, of_another_length_are_a_logic_error) {
  const Folder folder;
  Writer file(folder / "rows.h5");
  Rows& force = file.rows("/contact/force", {7}, "N");
  EXPECT_THROW(force.append(std::vector<double>(6)), std::logic_error);
  EXPECT_THROW(file.write<double>("/x", std::vector<double>(6), {7}, "m"), std::logic_error);
}

TEST(Wrapper, leaves_no_handle_open) {
  const Folder folder;
  {
    Writer file(folder / "file.h5");
    file.rows("/a/rows", {2}, "m").append(std::vector<double>{1, 2});
    file.write<float>("/a/b/values", std::vector<float>{1, 2}, {2}, "m");
    file.write_strings("/names", {"one", "three"});
    file.attribute("/", "text", std::string("x"));
    file.commit();
    const Reader reader(folder / "file.h5", "Advice.");
    reader.read<float>("/a/b/values", {2});
    EXPECT_EQ(reader.read_strings("/names", 2), (std::vector<std::string>{"one", "three"}));
    reader.string_attribute("/", "text");
    complaint_of([&] { reader.read<double>("/missing", {2}); });
    complaint_of([&] { reader.read<double>("/names", {2}); });
    Writer given_up(folder / "other.h5");
    given_up.rows("/a/rows", {2}, "m").append(std::vector<double>{1, 2});
  }
  EXPECT_EQ(H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_ALL), 0);
}

TEST(Wrapper, prints_nothing_about_bad_files_even_when_the_program_ends) {
  const Folder folder;
  kernels::write(kernels::test::sample_kernel(3), folder / "body.h5");
  kernels::test::put_bytes(folder / "text.h5", "text");
  std::string spoilt = kernels::test::bytes_of(folder / "body.h5");
  // Damages object headers after their signature. Their checksums fail, and
  // HDF5 records this until the program ends.
  for (std::size_t at = 0; (at = spoilt.find("OHDR", at + 1)) != std::string::npos;)
    if (at > 1000) spoilt[at + 20] = static_cast<char>(~spoilt[at + 20]);
  kernels::test::put_bytes(folder / "spoilt.h5", spoilt);
  const auto meet_bad_files = [&] {
    complaint_of([&] { Reader(folder / "missing.h5", "Advice."); });
    complaint_of([&] { Reader(folder / "text.h5", "Advice."); });
    complaint_of([&] { Writer(folder / "no/folder.h5"); });
    complaint_of([&] { kernels::read(folder / "spoilt.h5"); });
    std::exit(0);
  };
  EXPECT_EXIT(meet_bad_files(), testing::ExitedWithCode(0), "^$");
}

TEST(Reader, distinguishes_links_and_missing_objects_from_its_own) {
  const Folder folder;
  Writer file(folder / "file.h5");
  file.write<double>("/a/values", std::vector<double>{1}, {1}, "m");
  file.commit();
  {
    const hid_t raw = H5Fopen((folder / "file.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Lcreate_soft("/a/values", raw, "/soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(raw);
  }
  const Reader reader(folder / "file.h5", "Advice.");
  EXPECT_TRUE(reader.exists("/a"));
  EXPECT_TRUE(reader.exists("/a/values"));
  EXPECT_EQ(complaint_of([&] { reader.exists("/soft"); }),
            (folder / "file.h5").string() +
                ": dataset \"/soft\" is a link; only data in the file itself is read. Advice.");
  EXPECT_FALSE(reader.exists("/b/values"));
  EXPECT_FALSE(reader.has_attribute("/b", "unit"));
  EXPECT_EQ(complaint_of([&] { reader.read<double>("/b/values", {1}); }),
            (folder / "file.h5").string() + ": dataset \"/b/values\" is missing. Advice.");
}

}  // namespace hdf5_test
}  // namespace ricochet::base::hdf5
