// SPDX-License-Identifier: BSD-2-Clause
// Applies the accuracy dial (contact/accuracy/dial.hpp) to a scene.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/programs/stored_kernels.hpp"

namespace ricochet::programs {

/// Options of the scene's steps. If the scene leaves the precision open, it is double.
StepOptions step_options(const scene::Scene& scene);

/// Chooses the settings that a scene with an accuracy leaves open.
/// @param model  built from these kernels, placement and forcing
/// @param folder  contains the kernels of another element order, beside those of the scene
/// @param poll  called after each step; may throw to end the run
/// Throws InputError in the same cases as building the model and running it.
contact::Dialled dial_of(const scene::Scene& scene, const Kernels& kernels,
                         const contact::Placement& placement,
                         const std::vector<contact::ForcingRequest>& forcing, contact::Model model,
                         const std::filesystem::path& folder, std::function<void()> poll);

/// Returns the scene with the chosen settings, as results store it.
scene::Scene resolved(scene::Scene scene, const contact::Settings& settings);

}  // namespace ricochet::programs
