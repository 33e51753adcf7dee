// SPDX-License-Identifier: BSD-2-Clause
// Places the bodies of a scene and finds the candidates that the contact pairs use.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "contact/model/model.hpp"
#include "ricochet/error.hpp"
#include "ricochet/ricochet.hpp"
#include "ricochet/step_options.hpp"
#include "src/scene/data/body.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::store {

/// Runs `action` and puts the file of its scene in front of the message of an InputError.
template <class Action>
auto in_file(const std::filesystem::path& file, Action action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

using KernelPointers = std::vector<const kernels::Kernel*>;

/// The scene that the library runs (ricochet/ricochet.hpp), without what follows a history.
/// @param kernels  of the scene's bodies, in their order; must outlive all that is made of the result.
/// Without any, the result has no bodies, and serves for step_options and read_histories alone.
Scene library_scene(const scene::Scene& scene, const KernelPointers& kernels);
/// Adds loads, moving supports and moving obstacles. Throws InputError if a history cannot be read.
void read_histories(const scene::Scene& scene, Scene& out);
/// Throws InputError if a history cannot be read.
void check_histories(const scene::Scene& scene);

/// Places the bodies of the scene and finds their contact pairs. Throws InputError in the same cases as
/// placement_of.
contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels);

/// Returns the placement with other kernels of the same surfaces.
contact::Placement with_kernels(contact::Placement placement, const KernelPointers& kernels);

/// The bodies of a scene at their places, and what acts on them: the parts of their model.
struct Prepared {
  Scene scene;
  contact::Placement placement;
};

/// Builds the model. Throws InputError in the same cases as ricochet::model_of.
contact::Model model_of(const scene::Scene& scene, const Prepared& prepared);

/// Options of the scene's steps. If the scene leaves the precision open, it is double.
StepOptions step_options(const scene::Scene& scene);

/// Whether every pair of the body has a reach or a zone, so that its kernel may omit candidates.
bool is_limited(const scene::Scene& scene, const scene::Body& body);

/// Numbers of candidates on the whole surface, ascending; no value: all.
using Points = std::optional<std::vector<std::int64_t>>;

/// Whether displacements along the normals of its candidates suffice for each body, because no pair is tilted
/// against them by more than contact::most_tilt.
std::vector<bool> normals_suffice(const contact::Placement& placement);

/// Candidates that the kernels of the scene's bodies must contain. A body that is not limited needs all of
/// its candidates.
std::vector<Points> points_within_reach(const scene::Scene& scene, const contact::Placement& placement);

struct KernelFile {
  std::filesystem::path path;
  std::string hash;
  Points held{};
  bool normal_residual = false;
  bool mesh_error = false;  ///< whether errors by the mesh are estimated
  /// Whether the kernel serves a scene that needs these points, and for which normals suffice or not.
  bool holds(const Points& points, bool normals_suffice) const;
};

/// A request and those whose kernels serve, too: of a body that does not turn, if this one does, and with a
/// visualisation surface, if this one has none.
std::vector<scene::KernelRequest> with_substitutes(const scene::KernelRequest& request);

/// Kernel files in `folder` that answer `whole`, a request for all candidates, or the same request limited by
/// a reach, or with its static correction along the normals alone. Those with the fewest candidates come
/// first. The substitutes of `with_substitutes` count, too.
std::vector<KernelFile> kernel_files(const std::filesystem::path& folder, const scene::KernelRequest& whole);

}  // namespace ricochet::store
