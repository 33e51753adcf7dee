// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/mesh_levels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ricochet::accuracy {
namespace {

/// As entries of a list, aggregates with a default member break GCC 13.
MeshSettings mesh_of(int order, double size_factor) { return {order, size_factor}; }

std::vector<MeshSettings> levels_of(const scene::Body& body) {
  if (!body.meshable()) return {};
  const double own = body.size_factor;
  if (!body.order_open) return {mesh_of(body.order > 1 ? body.order - 1 : 2, own), mesh_of(body.order, own)};
  if (!body.size_open) return {mesh_of(2, own), mesh_of(3, own), mesh_of(4, own), mesh_of(5, own)};
  const double root = std::sqrt(2.0);
  return {mesh_of(2, 2), mesh_of(3, 2),        mesh_of(4, 2),  mesh_of(4, root),
          mesh_of(4, 1), mesh_of(4, 1 / root), mesh_of(4, 0.5)};
}

/// The same elements, without those near contact.
std::map<std::string, MeshSettings> without_balls(std::map<std::string, MeshSettings> meshes) {
  for (auto& [body, mesh] : meshes) mesh.refine.clear();
  return meshes;
}

}  // namespace

std::map<std::string, MeshSettings> meshes_at(const scene::Scene& scene, int level) {
  std::map<std::string, MeshSettings> out;
  for (const scene::Body& body : scene.bodies)
    if (const auto levels = levels_of(body); !levels.empty())
      out[body.name] = levels[std::min(static_cast<std::size_t>(level), levels.size() - 1)];
  return out;
}

bool has_finer(const scene::Scene& scene, int level) {
  return meshes_at(scene, level) != meshes_at(scene, level + 1);
}

std::optional<int> level_of(const scene::Scene& scene, const KernelSettings& settings) {
  for (int level = 0;; ++level) {
    if (meshes_at(scene, level) == without_balls(settings.mesh)) return level;
    if (!has_finer(scene, level)) return std::nullopt;
  }
}

scene::Scene with_own_sizes(scene::Scene scene) {
  for (scene::Body& body : scene.bodies) body.size_open = false;
  return scene;
}

KernelSettings at_level(KernelSettings settings, const scene::Scene& scene, int level) {
  for (auto& [body, mesh] : meshes_at(scene, level)) {
    mesh.refine = std::move(settings.mesh[body].refine);
    settings.mesh[body] = std::move(mesh);
  }
  return settings;
}

MeshChange change_between(const KernelSettings& coarser, const KernelSettings& finer) {
  const bool elsewhere = without_balls(coarser.mesh) != without_balls(finer.mesh);
  bool near_contact = false;
  for (const auto& [body, mesh] : finer.mesh) {
    const auto was = coarser.mesh.find(body);
    near_contact = near_contact || was == coarser.mesh.end() || was->second.refine != mesh.refine;
  }
  return {near_contact, elsewhere};
}

MeshChange last_change(const Settings& settings) {
  return settings.coarser ? change_between(*settings.coarser, settings.found) : MeshChange{};
}

}  // namespace ricochet::accuracy
