// SPDX-License-Identifier: BSD-2-Clause
// A kernel file, edited as described in tests/fuzz/hdf5_edits.hpp. An accepted kernel must satisfy the
// guarantees of ricochet/kernel.hpp, and must be unchanged after it is written and read again.
#include "ricochet/kernel.hpp"
#include "kernels/read.hpp"
#include "kernels/write.hpp"

#include <cmath>

#include "tests/fuzz/hdf5_edits.hpp"
#include "tests/kernels/sample.hpp"

namespace {

using namespace ricochet;
using fuzz::accepts;
using fuzz::require;

/// Checks values that must be finite in every accepted kernel.
void check_numbers(const kernels::Kernel& kernel) {
  const auto finite = [](const std::vector<double>& values) {
    for (double value : values) require(std::isfinite(value), "a number that is not finite was accepted");
  };
  for (const auto* values : {&kernel.modes.angular_frequency, &kernel.modes.decay_rate, &kernel.surface.node,
                             &kernel.surface.centroid, &kernel.surface.bulge, &kernel.surface.element_normal,
                             &kernel.surface.normal, &kernel.surface.area, &kernel.surface.shape,
                             &kernel.surface.residual_flexibility, &kernel.loads.body_force,
                             &kernel.loads.rotation, &kernel.loads.body_force_residual})
    finite(*values);
  require(kernel.mass > 0, "a body without mass was accepted");
  const std::size_t m = kernel.surface.size(), n = kernel.modes.size();
  require(kernel.surface.node.size() == 3 * m && kernel.surface.group.size() == m, "points were lost");
  require(kernel.surface.shape.size() == m * n * static_cast<std::size_t>(kernel.surface.components),
          "shapes have another size");
  for (std::int64_t point : kernel.surface.element)
    require(point >= 0 && point < static_cast<std::int64_t>(m), "an element of a point that is not there");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch folder;
  const std::filesystem::path file = folder / "body.kernel.h5", copy = folder / "copy.kernel.h5";
  fuzz::make_hdf5(data, size, file, 4, [](unsigned variant, const std::filesystem::path& path) {
    kernels::Kernel kernel = kernels::test::sample_kernel(variant % 2 == 0 ? 3 : 1, 2, 2);
    kernel.scene = "[body]\n";
    if (variant > 1) kernel.surface.whole = kernels::whole_surface(kernel.surface);
    kernels::write(kernel, path);
  });
  kernels::read_header(file);
  kernels::Kernel kernel;
  if (!accepts([&] { kernel = kernels::read(file); })) return 0;
  check_numbers(kernel);
  kernels::write(kernel, copy);
  require(kernels::read(copy) == kernel, "a written kernel is another one");
  return 0;
}
