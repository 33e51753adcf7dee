// SPDX-License-Identifier: BSD-2-Clause
// Applies the accuracy dial (contact/accuracy/dial.hpp) to a scene, with the settings that ricochet-kernel
// has chosen for it (settings.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/accuracy/settings.hpp"
#include "src/scene/scene.hpp"
#include "src/store/stored_kernels.hpp"

namespace ricochet::accuracy {

/// A scene with the settings that its kernels need.
struct ClosedScene {
  scene::Scene scene;
  std::optional<Settings> settings{};  ///< no value if the scene has no accuracy, or no such file exists
};

/// Closes a scene with the settings stored in `folder`, and finds the triangles of its obstacles there.
/// Throws InputError if there are no settings although the scene leaves its modes open, and as
/// store::find_surfaces.
ClosedScene closed(scene::Scene scene, const std::filesystem::path& folder, store::KernelStore& store);

/// The scene with the settings stored in `folder`, that of the steps among them, and without accuracy: it
/// runs with them, and nothing is estimated. Throws as `closed` does. A scene without accuracy stays as it
/// is.
scene::Scene chosen(const scene::Scene& scene, const std::filesystem::path& folder,
                    store::KernelStore& store);

/// The scene with the settings stored in `folder`; as it is if there are none yet, or a mesh is missing.
scene::Scene closed_if_known(const scene::Scene& scene, const std::filesystem::path& folder);

/// The path of the settings of a scene with an accuracy if there is no such file.
std::optional<std::filesystem::path> missing_settings(const scene::Scene& scene,
                                                      const std::filesystem::path& folder,
                                                      store::KernelStore& store);

struct Dialled : contact::Dialled {
  /// To which the model refers, besides those that it was chosen for.
  std::vector<std::shared_ptr<const kernels::Kernel>> kernels{};
};

/// Chooses the settings of steps that a closed scene leaves open. With finite rotations, they serve the first
/// touch: the bodies that take part in it are run with linear ones, from shortly before until after it, and
/// the model returned is theirs.
/// @param model  built from these kernels and parts
/// @param rate  rate at which the search starts; 0: unknown
/// @param poll  called after each step; may throw to end the run
/// Throws InputError in the same cases as building the model and running it.
Dialled dial_of(const scene::Scene& scene, const store::Kernels& kernels, const store::Prepared& prepared,
                contact::Model model, Hertz rate, std::function<void()> poll);

/// Returns the scene with the settings of steps that were chosen, as results store it.
scene::Scene resolved(scene::Scene scene, const contact::Dialled& dialled);

}  // namespace ricochet::accuracy
