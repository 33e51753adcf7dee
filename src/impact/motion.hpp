// SPDX-License-Identifier: BSD-2-Clause
// The motion for ParaView that a scene or --vtk requests.
#pragma once

#include <cstdint>
#include <filesystem>

#include "contact/files/motion_file.hpp"
#include "src/store/stored_kernels.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::impact {

/// Throws InputError if the motion of the scene cannot be written: with sampled responses, or without
/// visualisation surfaces.
void check_motion(const scene::Scene& scene);

/// Throws InputError if a kernel has no visualisation surface.
void check_views(const store::Kernels& kernels);

/// Options of `<stem>.motion.xdmf` and `.motion.h5`: a frame every output.vtk_every samples, or about 200
/// frames.
contact::MotionOptions motion_options(const scene::Scene& scene, std::int64_t samples,
                                      const std::filesystem::path& stem);

}  // namespace ricochet::impact
