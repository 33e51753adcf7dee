// SPDX-License-Identifier: BSD-2-Clause
// Places the bodies of a scene and finds the candidates that the contact pairs use.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "contact/model/model.hpp"
#include "ricochet/error.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::store {

/// Runs `action` and puts the scene's file in front of the message of its InputErrors.
template <class Action>
auto in_scene(const scene::Scene& scene, Action action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.file.string(), error.what()));
  }
}

using KernelPointers = std::vector<const kernels::Kernel*>;

/// @param kernels  kernels of the scene's bodies, in their order; must outlive the result
std::vector<contact::PlacedBody> placed_bodies(const scene::Scene& scene, const KernelPointers& kernels);
std::vector<contact::HalfSpace> half_spaces(const scene::Scene& scene);
std::vector<contact::PairRequest> pair_requests(const scene::Scene& scene);

/// Places the bodies of the scene and finds their contact pairs. Throws InputError in the same cases as
/// contact::place.
contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels);

/// Returns the placement with other kernels of the same surfaces.
contact::Placement with_kernels(contact::Placement placement, const KernelPointers& kernels);

/// An obstacle that moves along its surface: `vector` times a history.
struct BeltRequest {
  std::string obstacle;
  Eigen::Vector3d vector;  ///< [m]
  contact::History history;
};

/// Everything in a scene that follows a history.
struct Driven {
  std::vector<contact::ForcingRequest> forcing;  ///< loads and moving supports
  std::vector<BeltRequest> belts;
};

/// Loads, moving supports and moving obstacles with their histories. At rest, obstacles have no velocity.
/// Throws InputError if a history cannot be read.
Driven forcing_of(const scene::Scene& scene);

/// Builds the model of placed bodies under the scene's loads. Throws InputError in the same cases as
/// contact::build_model, contact::refuse_early_contact and contact::add_belt, and if a rod has friction.
contact::Model model_of(const scene::Scene& scene, const contact::Placement& placement, const Driven& driven);

/// Options of the scene's steps. If the scene leaves the precision open, it is double.
StepOptions step_options(const scene::Scene& scene);

/// The complaint about friction on a rod.
std::string friction_on_rod(const std::string& body);

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
  Points held;
  bool normal_residual = false;
  /// Whether the kernel serves a scene that needs these points, and for which normals suffice or not.
  bool holds(const Points& points, bool normals_suffice) const;
};

/// Kernel files in `folder` that answer `whole`, a request for all candidates, or the same request limited by
/// a reach, or with its static correction along the normals alone. The smallest files come first.
std::vector<KernelFile> kernel_files(const std::filesystem::path& folder, const scene::KernelRequest& whole);

}  // namespace ricochet::store
