// SPDX-License-Identifier: BSD-2-Clause
// The motion for ParaView that a scene or --vtk asks for.
#pragma once

#include <cstdint>
#include <filesystem>

#include "contact/output/motion_file.hpp"
#include "src/programs/stored_kernels.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

/// Throws InputError when the scene's kernels do not hold the motion: those of a table, or without skins.
void check_motion(const scene::Scene& scene);

/// Throws InputError when a kernel file holds no skin.
void check_skins(const Kernels& kernels);

/// `<stem>.motion.xdmf` and `.motion.h5`: every output.vtk_every-th step, or about 200 frames.
contact::MotionOptions motion_options(const scene::Scene& scene, std::int64_t steps,
                                      const std::filesystem::path& stem);

}  // namespace ricochet::programs
