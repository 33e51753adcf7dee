// SPDX-License-Identifier: BSD-2-Clause
// The accuracy dial (contact/accuracy/dial.hpp) for a scene, and the resulting scene.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/programs/stored_kernels.hpp"

namespace ricochet::programs {

/// Options of the scene's steps. A precision that the scene leaves open is double.
StepOptions step_options(const scene::Scene& scene);

/// Chooses the settings that the scene, which has an accuracy, leaves open.
/// @param model  of these kernels, placement and forcing
/// @param folder  of the kernels of another order, beside those of the scene
/// @param poll  called after each step; may throw to end the run
/// Throws InputError as building the model and running it do.
contact::Dialled dial_of(const scene::Scene& scene, const Kernels& kernels,
                         const contact::Placement& placement,
                         const std::vector<contact::ForcingRequest>& forcing, contact::Model model,
                         const std::filesystem::path& folder, std::function<void()> poll);

/// The scene with the settings chosen, as results store it.
scene::Scene resolved(scene::Scene scene, const contact::Settings& settings);

}  // namespace ricochet::programs
