// SPDX-License-Identifier: BSD-2-Clause
// The store of kernels: the files that ricochet-kernel wrote, and the data that a process keeps between runs.
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
  std::vector<std::string> warnings;  ///< about elements that do not suit their material
  KernelPointers pointers() const;
};

/// The last few placements of one thread, by the data that determine them: surfaces in their initial
/// positions, obstacles and pair requests.
class PlacementStore {
 public:
  /// The placement of the scene's bodies, new or stored. Throws InputError as contact::place does.
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

/// Data that one process keeps between runs, so that nothing is read or computed twice: kernels of the
/// previous run, files that were found to be kernels, hashes of meshes, and placements.
struct KernelStore {
  std::map<std::filesystem::path, std::shared_ptr<const kernels::Kernel>> kernels;
  std::set<std::filesystem::path> seen;
  scene::MeshHashes meshes;
  PlacementStore placements;
};

/// The file of a body's kernel. Files may differ in the candidates that they hold: the smallest sufficient
/// one is chosen; if none suffices, the smallest; without any file, `path` names a kernel with all
/// candidates.
struct StoredKernel {
  std::filesystem::path path;
  bool enough = false;
  std::filesystem::path whole;  ///< the name of a kernel with all candidates
  std::string hash;             ///< of that kernel
};

/// The files of the scene's bodies, in their order. A damaged file or one of another scene counts as none.
/// Throws InputError like contact::place if the choice of a file depends on a reach.
std::vector<StoredKernel> find_kernels(const scene::Scene& scene, const std::filesystem::path& folder,
                                       KernelStore& store);

/// Throws InputError if a body has no kernel, or one of another scene. A kernel that holds too few candidates
/// is read; contact::build_model refuses it. Afterwards `store` holds only the kernels of the scene.
/// @param view  whether to read their visualisation surfaces too
Kernels read_kernels(const scene::Scene& scene, const std::filesystem::path& folder, KernelStore& store,
                     bool view = false);

}  // namespace ricochet::programs
