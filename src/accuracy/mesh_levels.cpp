// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/mesh_levels.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "src/scene/scene.hpp"

namespace ricochet::accuracy {
namespace {

constexpr int lowest_order = 2, highest_order = 4, highest_of_given_size = 5, highest_of_rods = 8;

/// Factors of an open size, from the start on: those of solids, and more of rods, which cost nothing.
constexpr std::array sizes{2.0, std::numbers::sqrt2, 1.0, 1 / std::numbers::sqrt2, 0.5, 0.25, 0.125};
constexpr double smallest_of_solids = 0.5;

bool is_rod(const scene::Body& body) { return !body.materials.empty() && body.materials[0].area > 0; }

/// The same elements, without those near contact.
Meshes without_balls(Meshes meshes) {
  for (auto& [body, mesh] : meshes) mesh.refine.clear();
  return meshes;
}

MeshSettings finer(const scene::Body& body, MeshSettings mesh, bool fixed) {
  // Only elements that cannot shrink get orders above.
  const bool shrinks = body.size_open && !fixed && mesh.order <= highest_order;
  if (!body.order_open) {
    mesh.order = body.order;
  } else if (mesh.order < (shrinks        ? highest_order
                           : is_rod(body) ? highest_of_rods
                                          : highest_of_given_size)) {
    ++mesh.order;
  } else if (shrinks) {
    const auto smaller =
        std::ranges::find_if(sizes, [&](double size) { return size < 0.99 * mesh.size_factor; });
    if (smaller != sizes.end() && (is_rod(body) || *smaller >= smallest_of_solids))
      mesh.size_factor = *smaller;
  }
  return mesh;
}

}  // namespace

Meshes coarsest_meshes(const scene::Scene& scene) {
  Meshes out;
  for (const scene::Body& body : scene.bodies) {
    if (!body.meshable()) continue;
    MeshSettings& mesh = out[body.name];
    mesh.order = body.order_open ? lowest_order : body.order;
    mesh.size_factor = body.order_open && body.size_open ? sizes.front() : body.size_factor;
    mesh.refine = body.refine;  // none if they are open
  }
  return out;
}

Meshes finer_meshes(const scene::Scene& scene, Meshes meshes, const std::set<std::string>& fixed) {
  for (const scene::Body& body : scene.bodies)
    if (const auto mesh = meshes.find(body.name); mesh != meshes.end())
      mesh->second = finer(body, std::move(mesh->second), fixed.contains(body.name));
  return meshes;
}

bool has_finer(const scene::Scene& scene, const Meshes& meshes, const std::set<std::string>& fixed) {
  return finer_meshes(scene, meshes, fixed) != meshes;
}

Meshes meshes_at(const scene::Scene& scene, int level) {
  Meshes meshes = coarsest_meshes(scene);
  for (int k = 0; k < level; ++k) meshes = finer_meshes(scene, std::move(meshes));
  return meshes;
}

scene::Scene with_own_sizes(scene::Scene scene) {
  for (scene::Body& body : scene.bodies) body.size_open = false;
  return scene;
}

bool differs_elsewhere(const KernelSettings& one, const KernelSettings& other) {
  return without_balls(one.mesh) != without_balls(other.mesh);
}

}  // namespace ricochet::accuracy
