// The bodies of a scene where contact finds them, and which of their candidates it makes use of.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/pairing/pairing_cache.hpp"
#include "ricochet/error.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

/// Contact points and bodies are named to the user by the scene.
template <class Action>
auto in_scene(const scene::Scene& scene, Action action) {
  try {
    return action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.file.string(), error.what()));
  }
}

/// @param kernels  of the scene's bodies, in their order; they outlive what is returned
std::vector<contact::PlacedBody> placed_bodies(const scene::Scene& scene,
                                               const std::vector<const kernels::Kernel*>& kernels);
std::vector<contact::HalfSpace> half_spaces(const scene::Scene& scene);
std::vector<contact::PairRequest> pair_requests(const scene::Scene& scene);

/// Reads the files that loads take their histories from. Throws InputError where one can't be.
void check_histories(const scene::Scene& scene);

/// Whether every pair of a body has a reach, so that its kernel need not hold all candidates.
bool is_limited(const scene::Scene& scene, const scene::Body& body);

/// Numbers of some candidates of a whole surface, ascending; none: all.
using Points = std::optional<std::vector<std::int64_t>>;

/// What the kernels of the scene's bodies have to hold, by their surfaces; all of bodies that are not
/// limited. Throws InputError like contact::pair. @param known  as of contact::pair
std::vector<Points> points_within_reach(const scene::Scene& scene,
                                        const std::vector<kernels::WholeSurface>& surfaces,
                                        contact::Pairings& known);

struct KernelFile {
  std::filesystem::path path;
  Points held;
  bool holds(const Points& points) const;
};

/// The kernel files in `folder` that answer `whole`, a request for all candidates, but for those that reach
/// left out; those with the fewest candidates first.
std::vector<KernelFile> kernel_files(const std::filesystem::path& folder, const scene::KernelRequest& whole);

}  // namespace ricochet::programs
