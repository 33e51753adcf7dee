// Kernels of a scene's bodies from the folder where ricochet-kernel left them.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "contact/pairing/pairing_cache.hpp"
#include "ricochet/kernel.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

/// Kernels of the scene's bodies, in their order.
struct Kernels {
  std::vector<std::shared_ptr<const kernels::Kernel>> kernel;
  std::vector<std::string> file;
  std::vector<std::string> warnings;  ///< of elements that are not made for their material
  std::vector<const kernels::Kernel*> pointers() const;
};

/// Kernels of the run before, by path, files that were seen to be kernels, hashes of meshes, and who meets
/// whom: what stays the same is neither read nor found again.
struct KernelCache {
  std::map<std::filesystem::path, std::shared_ptr<const kernels::Kernel>> kernels;
  std::set<std::filesystem::path> seen;
  scene::MeshHashes meshes;
  contact::Pairings pairings;
};

/// The file of a body's kernel; of several that differ in the candidates that they hold, the one with the
/// fewest that are enough. Where there is none, the name of a kernel with all candidates; where none has
/// enough, the one with the fewest.
struct StoredKernel {
  std::filesystem::path path;
  bool enough = false;
  std::filesystem::path whole;  ///< the name of one with all candidates
  std::string hash;             ///< that this one must have
};

/// Of each body; a damaged file and one of another scene count as none. Throws InputError like contact::pair
/// where a reach has to be looked at.
std::vector<StoredKernel> find_kernels(const scene::Scene& scene, const std::filesystem::path& folder,
                                       KernelCache& cache);

/// Throws InputError when there is none for a body, or one of another scene. One that holds too few
/// candidates is read: pairing tells. Afterwards `cache` holds the scene's kernels alone.
/// @param view  with their skins
Kernels read_kernels(const scene::Scene& scene, const std::filesystem::path& folder, KernelCache& cache,
                     bool view = false);

}  // namespace ricochet::programs
