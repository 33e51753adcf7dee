// SPDX-License-Identifier: BSD-2-Clause
// The files of modes for ParaView, compared with the kernel whose modes they hold.
#include "kernels/modes_file.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "base/hdf5_reader.hpp"
#include "tests/kernels/sample.hpp"
#include "tests/support.hpp"

namespace ricochet::kernels {
namespace modes_file_test {

using namespace test;
using ricochet::test::complaint_of;
using ricochet::test::Folder;
using ::testing::HasSubstr;

/// A kernel whose visualisation surface has three nodes, with a bounding box of 1 m × 2 m × 2 m: its diagonal
/// is 3 m.
Kernel triangle() {
  Kernel kernel = sample_kernel(3);
  kernel.view->node = {0, 0, 0, 1, 2, 0, 0.5, 0, -2};
  return kernel;
}

TEST(ModesFile, holds_each_mode_with_a_largest_displacement_of_a_tenth_of_the_size) {
  const Folder folder;
  const Kernel kernel = triangle();
  write_modes(kernel, folder / "body.modes");
  const base::hdf5::Reader file(folder / "body.modes.h5", "");
  EXPECT_EQ(file.read<double>("/node", {3, 3}), kernel.view->node);
  EXPECT_EQ(file.read<std::int64_t>("/element", {2, 3}), kernel.view->element);
  const std::size_t n = kernel.modes.size();
  const std::vector<double> frequency = file.read<double>("/frequency", {n}),
                            amplitude = file.read<double>("/amplitude", {n});
  for (std::size_t k = 0; k < n; ++k) {
    SCOPED_TRACE(k);
    EXPECT_DOUBLE_EQ(frequency[k] * 2 * std::numbers::pi, kernel.modes.angular_frequency[k]);
    const std::vector<float> mode = file.read<float>("/modes/" + std::to_string(k + 1), {3, 3});
    double largest = 0;
    for (std::size_t v = 0; v < 3; ++v)
      largest = std::max(largest, std::sqrt(std::pow(mode[3 * v], 2) + std::pow(mode[3 * v + 1], 2) +
                                            std::pow(mode[3 * v + 2], 2)));
    EXPECT_NEAR(largest, 0.3, 1e-6);  // numbers are single
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(mode[i], amplitude[k] * kernel.view->shape[i * n + k], 1e-6) << i;
  }
}

TEST(ModesFile, names_each_mode_in_the_text_by_number_and_frequency) {
  const Folder folder;
  Kernel kernel = sample_kernel(3, 12);
  kernel.modes.angular_frequency[8] = 2 * std::numbers::pi * 1234.5;
  write_modes(kernel, folder / "body.modes");
  const std::string text = bytes_of(folder / "body.modes.xdmf");
  EXPECT_THAT(text, HasSubstr("mode 09: 1234.5 Hz"));
  EXPECT_THAT(text, HasSubstr("body.modes.h5:/modes/09"));
  EXPECT_THAT(text, HasSubstr("mode 12: "));
}

TEST(ModesFile, that_is_replaced_leaves_no_text_about_the_earlier_one_even_if_writing_ends_between) {
  const Folder folder;
  write_modes(triangle(), folder / "body");
  // The next temporary file of the text cannot be created, because folders have all its possible names.
  const std::string start = "body.xdmf." + std::to_string(::getpid());
  std::filesystem::create_directory(folder / (start + ".partial"));
  for (int attempt = 1; attempt < 100; ++attempt)
    std::filesystem::create_directory(folder / (start + "-" + std::to_string(attempt) + ".partial"));
  complaint_of([&] { write_modes(triangle(), folder / "body"); });
  EXPECT_FALSE(std::filesystem::exists(folder / "body.xdmf"));
  EXPECT_TRUE(std::filesystem::exists(folder / "body.h5"));
}

TEST(ModesFile, needs_a_visualisation_surface) {
  const Folder folder;
  Kernel kernel = triangle();
  kernel.view->node.clear();
  EXPECT_THAT(complaint_of([&] { write_modes(kernel, folder / "body"); }),
              HasSubstr("no visualisation surface"));
  kernel.view.reset();
  EXPECT_THAT(complaint_of([&] { write_modes(kernel, folder / "body"); }),
              HasSubstr("no visualisation surface"));
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace modes_file_test
}  // namespace ricochet::kernels
