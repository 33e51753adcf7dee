// SPDX-License-Identifier: BSD-2-Clause
// The store of kernels: the files that ricochet-kernel wrote, and what a process keeps of them between runs.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "contact/pairing/surface_projection.hpp"
#include "ricochet/kernel.hpp"
#include "src/programs/placing.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::programs {

/// Kernels of the scene's bodies, in their order.
struct Kernels {
  std::vector<std::shared_ptr<const kernels::Kernel>> kernel;
  std::vector<std::string> file;
  std::vector<std::string> warnings;            ///< about elements that do not suit their material
  std::optional<contact::Placement> placement;  ///< where choosing the files took the pairs
  KernelPointers pointers() const;
};

/// The last few placements of one thread, by all that they follow from: surfaces in their initial positions,
/// obstacles and pair requests.
class PlacementStore {
 public:
  /// The placement of the scene's bodies, found or known. Throws InputError as contact::place does.
  contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels);

 private:
  struct Body {
    std::string name;
    int components = 3;
    std::optional<Vector3> direction;
    contact::WorldSurface surface;
    bool operator==(const Body&) const = default;
  };
  struct Key {
    std::vector<Body> bodies;
    std::vector<contact::HalfSpace> obstacles;
    std::vector<contact::PairRequest> pairs;
    bool operator==(const Key&) const = default;
  };
  std::deque<std::pair<Key, contact::Placement>> known_;
};

/// Kept between the runs of one process, so that what stays the same is neither read nor found again: kernels
/// of the run before, files that were seen to be kernels, hashes of meshes, and placements.
struct KernelStore {
  std::map<std::filesystem::path, std::shared_ptr<const kernels::Kernel>> kernels;
  std::set<std::filesystem::path> seen;
  scene::MeshHashes meshes;
  PlacementStore placements;
};

/// The file of a body's kernel. Files may differ in the candidates that they hold: the smallest that suffices
/// is taken; if none suffices, the smallest; without any file, the name of a kernel with all candidates.
struct StoredKernel {
  std::filesystem::path path;
  bool enough = false;
  std::filesystem::path whole;  ///< the name of a kernel with all candidates
  std::string hash;             ///< of that kernel
};

struct StoredKernels {
  std::vector<StoredKernel> of_body;            ///< in the order of the scene's bodies
  std::optional<contact::Placement> placement;  ///< where the choice took the pairs
};

/// A damaged file and one of another scene count as none. Throws InputError like contact::place where a reach
/// decides which file suffices.
StoredKernels find_kernels(const scene::Scene& scene, const std::filesystem::path& folder,
                           KernelStore& store);

/// Throws InputError when a body has no kernel, or one of another scene. A kernel that holds too few
/// candidates is read; contact::build_model refuses it. Afterwards `store` holds the scene's kernels alone.
/// @param view  with their visualisation surfaces
Kernels read_kernels(const scene::Scene& scene, const std::filesystem::path& folder, KernelStore& store,
                     bool view = false);

}  // namespace ricochet::programs
