// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ricochet/error.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::impact {
namespace {

constexpr std::int64_t usual_frames = 200;

}  // namespace

void check_motion(const scene::Scene& scene) {
  if (scene.contact.kernel == scene::ContactKernel::table)
    throw InputError(
        fmt::format("{}: contact.kernel = \"table\" gives no motion of the bodies: leave out --vtk, or set "
                    "contact.kernel = \"modes\".",
                    scene.file.string()));
  if (!scene.output.view)
    throw InputError(
        fmt::format("{0}: output.view = false: --vtk draws the visualisation surface of each body, which its "
                    "kernel does not contain. "
                    "Set output.view = true and run ricochet-kernel {0} again.",
                    scene.file.string()));
}

void check_views(const store::Kernels& kernels) {
  for (std::size_t k = 0; k < kernels.kernel.size(); ++k)
    if (const auto& view = kernels.kernel[k]->view; !view || view->element.empty())
      throw InputError(fmt::format(
          "{}: has no visualisation surface (/view): compute it with output.view = true, or leave out --vtk.",
          kernels.file[k]));
}

contact::MotionOptions motion_options(const scene::Scene& scene, std::int64_t samples,
                                      const std::filesystem::path& stem) {
  contact::MotionOptions out{.stem = stem,
                             .title = scene.title,
                             .created_by = std::string("ricochet-contact ") + RICOCHET_VERSION,
                             .every = scene.output.vtk_every > 0
                                          ? scene.output.vtk_every
                                          : std::max<std::int64_t>(1, samples / usual_frames)};
  out.stem += ".motion";
  for (const scene::Pair& pair : scene.contact.pairs) out.pairs.push_back(pair.a + " on " + pair.b);
  return out;
}

}  // namespace ricochet::impact
