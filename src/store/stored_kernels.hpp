// SPDX-License-Identifier: BSD-2-Clause
// The store of kernels: the files that ricochet-kernel wrote, and the data that a process keeps from one run
// to the next.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ricochet/kernel.hpp"
#include "src/scene/data/body.hpp"
#include "src/scene/request.hpp"
#include "src/store/placing.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::store {

/// Kernels of the scene's bodies, in their order.
struct Kernels {
  std::vector<std::shared_ptr<const kernels::Kernel>> kernel;
  std::vector<std::string> file;
  std::vector<std::string> warnings;  ///< those of body_warnings.hpp
  KernelPointers pointers() const;
};

/// The last few placements of one thread. Each is identified by the data that determine it: surfaces in their
/// initial positions, obstacles, pairs and the description of rotations.
class PlacementStore {
 public:
  /// Returns the placement of the scene's bodies, stored or new. Throws InputError in the same cases as
  /// contact::place.
  contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels);

 private:
  struct Body {
    std::string name;
    int components = 3;
    std::optional<Vector3> direction;
    kernels::WholeSurface surface;  ///< body axes
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    bool operator==(const Body&) const = default;
  };
  struct Key {
    std::vector<Body> bodies;
    std::vector<Obstacle> obstacles;
    std::vector<Pair> pairs;
    Rotation rotation = Rotation::linear;  ///< finite: pairs hold all candidates
    bool operator==(const Key&) const = default;
  };
  std::deque<std::pair<Key, contact::Placement>> known_;
};

/// Data that one process keeps from one run to the next, so that nothing is read or computed twice: kernels
/// of the previous run, files that were recognised as kernels, hashes of meshes, and placements.
struct KernelStore {
  std::map<std::filesystem::path, std::shared_ptr<const kernels::Kernel>> kernels;
  std::set<std::filesystem::path> seen;
  scene::MeshHashes meshes;
  PlacementStore placements;
};

/// The file of a body's kernel. Files may differ in the candidates that they contain, and in the components
/// of their static correction. The smallest sufficient file is chosen, or the smallest one if none suffices.
/// If there is no file, `path` is that of a kernel with all candidates.
struct StoredKernel {
  std::filesystem::path path;
  bool enough = false;
  std::filesystem::path whole;        ///< path of a kernel with all candidates
  std::string hash;                   ///< hash of a kernel with all candidates
  bool depends_on_placement = false;  ///< whether files of several hashes may serve the body
};

/// The files of the scene's bodies, in their order. A file that is damaged or belongs to another scene counts
/// as missing. If the choice depends on a reach, throws InputError in the same cases as contact::place.
std::vector<StoredKernel> find_kernels(const scene::Scene& scene, const std::filesystem::path& folder,
                                       KernelStore& store);

/// Reads the kernels of the scene. Throws InputError if the kernel of a body is missing or belongs to another
/// scene. A kernel with too few candidates is read as well, and contact::build_model then throws. Afterwards,
/// `store` contains only the kernels of this scene.
/// @param view  whether to read the visualisation surfaces too
Kernels read_kernels(const scene::Scene& scene, const std::filesystem::path& folder, KernelStore& store,
                     bool view = false);

}  // namespace ricochet::store
