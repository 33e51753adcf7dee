// SPDX-License-Identifier: BSD-2-Clause
// Kernels that contain only some of the candidates but record the complete surface.
#include <functional>

#include "kernels/algebra.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace whole_test {

using test::complaint_of;
using test::Folder;
using test::plain_kernel;

const std::vector<std::int64_t> kept = {1, 3, 4};

/// Candidates 1, 3 and 4 of six.
Kernel partial_kernel() {
  Kernel kernel = plain_kernel(3, 5, 6);
  WholeSurface whole = whole_surface(kernel.surface);
  kernel = restricted_to_points(std::move(kernel), kept);
  whole.held = kept;
  kernel.surface.whole = whole;
  return kernel;
}

TEST(WholeSurface, of_a_complete_kernel_is_its_own) {
  const Kernel kernel = plain_kernel();
  const WholeSurface whole = whole_surface(kernel.surface);
  EXPECT_EQ(whole.node, kernel.surface.node);
  EXPECT_EQ(whole.element, kernel.surface.element);
  EXPECT_EQ(whole.held, (std::vector<std::int64_t>{0, 1, 2, 3}));
}

TEST(WholeSurface, is_written_and_read) {
  const Folder folder;
  const Kernel kernel = partial_kernel();
  write(kernel, folder / "some.h5");
  write(plain_kernel(), folder / "all.h5");
  const Surface surface = read(folder / "some.h5").surface;
  ASSERT_TRUE(surface.whole);
  const WholeSurface &found = *surface.whole, &expected = *kernel.surface.whole;
  EXPECT_EQ(found.node, expected.node);
  EXPECT_EQ(found.centroid, expected.centroid);
  EXPECT_EQ(found.bulge, expected.bulge);
  EXPECT_EQ(found.element_normal, expected.element_normal);
  EXPECT_EQ(found.normal, expected.normal);
  EXPECT_EQ(found.area, expected.area);
  EXPECT_EQ(found.element_corners, expected.element_corners);
  EXPECT_EQ(found.element, expected.element);
  EXPECT_EQ(found.held, kept);
  EXPECT_EQ(read_header(folder / "some.h5")->held, kept);
  EXPECT_FALSE(read(folder / "all.h5").surface.whole);
  EXPECT_FALSE(read_header(folder / "all.h5")->held);
}

TEST(WholeSurface, grows_with_the_body) {
  const Kernel kernel = partial_kernel();
  const Kernel grown = rescaled(kernel, {.scale = 2}, {});
  ASSERT_TRUE(kernel.surface.whole && grown.surface.whole);
  const WholeSurface &before = *kernel.surface.whole, &after = *grown.surface.whole;
  EXPECT_EQ(after.node[5], 2 * before.node[5]);
  EXPECT_EQ(after.centroid[5], 2 * before.centroid[5]);
  EXPECT_EQ(after.bulge[3], 2 * before.bulge[3]);
  EXPECT_EQ(after.element_normal, before.element_normal);
  EXPECT_EQ(after.area[5], 4 * before.area[5]);
  EXPECT_EQ(after.normal, before.normal);
}

TEST(WholeSurface, is_dropped_if_points_are_chosen) {
  EXPECT_FALSE(restricted_to_points(partial_kernel(), {0, 2}).surface.whole);
}

TEST(Surface, keeps_bulges_and_normals_of_the_remaining_points_and_elements) {
  const Surface all = plain_kernel().surface, two = restricted_to_points(plain_kernel(), {1, 2}).surface,
                apart = restricted_to_points(plain_kernel(), {0, 2}).surface;
  EXPECT_EQ(two.bulge, (std::vector<double>{all.bulge[1], all.bulge[2]}));
  // The element between points 1 and 2 is the second one.
  EXPECT_EQ(two.element_normal,
            std::vector<double>(all.element_normal.begin() + 6, all.element_normal.begin() + 12));
  EXPECT_EQ(apart.element_corners, 1);
  EXPECT_TRUE(apart.element_normal.empty());
}

TEST(WholeSurface, must_fit_the_candidates) {
  for (const auto& [breach, named] : std::vector<std::pair<std::function<void(WholeSurface&)>, const char*>>{
           {[](WholeSurface& w) { w.held.pop_back(); }, "whole/held"},
           {[](WholeSurface& w) { w.held[2] = 6; }, "whole/held"},
           {[](WholeSurface& w) { w.held[0] = -1; }, "whole/held"},
           {[](WholeSurface& w) { std::swap(w.held[0], w.held[1]); }, "whole/held"},
           {[](WholeSurface& w) {
              w.held = {1, 3, 5};
            },
            "a candidate that differs"},
           {[](WholeSurface& w) { w.node.pop_back(); }, "whole/node"},
           {[](WholeSurface& w) { w.centroid.resize(9); }, "whole/centroid"},
           {[](WholeSurface& w) { w.bulge.pop_back(); }, "whole/bulge"},
           {[](WholeSurface& w) { w.element_normal.pop_back(); }, "whole/element_normal"},
           {[](WholeSurface& w) { w.element_normal[0] = 2; }, "whole/element_normal"},
           {[](WholeSurface& w) { w.area[0] = 0; }, "whole/area"},
           {[](WholeSurface& w) { w.normal[0] = 2; }, "whole/normal"},
           {[](WholeSurface& w) { w.element[0] = 6; }, "whole/element"}}) {
    Kernel kernel = partial_kernel();
    ASSERT_NO_THROW(validate(kernel, "origin"));
    breach(*kernel.surface.whole);
    const std::string message = complaint_of([&] { validate(kernel, "origin"); });
    EXPECT_EQ(message.find("origin: "), 0U) << message;
    EXPECT_NE(message.find(named), std::string::npos) << message;
  }
}

}  // namespace whole_test
}  // namespace ricochet::kernels
