// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/stored_kernels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/api/scene_model.hpp"
#include "kernels/read.hpp"
#include "ricochet/error.hpp"
#include "src/scene/scene.hpp"
#include "src/store/body_warnings.hpp"

namespace ricochet::store {

namespace fs = std::filesystem;

namespace {

/// Whether the scene's placement decides which of several files serves the body.
bool depends_on_placement(const scene::Scene& scene, const scene::Body& body,
                          const scene::KernelRequest& request) {
  return is_limited(scene, body) || scene::may_be_normal(request);
}

/// Files that contain all or some candidates of a body.
std::vector<KernelFile> files_of(const scene::Scene& scene, const scene::Body& body,
                                 const scene::KernelRequest& request, const fs::path& folder,
                                 KernelStore& store) {
  if (depends_on_placement(scene, body, request)) return kernel_files(folder, request);
  for (const scene::KernelRequest& one : with_substitutes(request)) {
    const fs::path path = scene::kernel_path(folder, one);
    if (!fs::exists(path)) continue;
    if (!store.seen.contains(path)) {
      if (kernels::read_hash(path) != one.hash) continue;
      store.seen.insert(path);
    }
    return {{path, one.hash}};
  }
  return {};
}

std::shared_ptr<const kernels::Kernel> read(const fs::path& path, KernelStore& store, bool view = false) {
  std::shared_ptr<const kernels::Kernel>& kernel = store.kernels[path];
  if (!kernel || (view && !kernel->view))
    kernel = std::make_shared<const kernels::Kernel>(kernels::read(path, view));
  return kernel;
}

/// Number of placements kept, enough for a sweep whose rows take some positions in turn.
constexpr std::size_t most_placements = 16;

}  // namespace

contact::Placement PlacementStore::place(const scene::Scene& scene, const KernelPointers& kernels) {
  const Scene library = library_scene(scene, kernels);
  Key key{{}, library.obstacles, library.pairs, library.rotation};
  // Pairing depends neither on the velocities of obstacles nor on friction.
  for (Obstacle& obstacle : key.obstacles) obstacle.velocity = obstacle.angular_velocity = {};
  for (Pair& pair : key.pairs) pair.friction.reset();
  const std::vector<contact::PlacedBody> bodies = bodies_of(library);
  for (const contact::PlacedBody& body : bodies)
    key.bodies.push_back({body.name, body.kernel->surface.components, body.kernel->surface.direction,
                          kernels::whole_surface(body.kernel->surface), body.rotation, body.translation});
  const auto same = std::ranges::find(known_, key, &std::pair<Key, contact::Placement>::first);
  if (same == known_.end()) {
    known_.emplace_back(std::move(key), in_file(scene.file, [&] { return placement_of(library); }));
    if (known_.size() > most_placements) known_.pop_front();
    return known_.back().second;
  }
  contact::Placement out = with_kernels(same->second, kernels);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    out.bodies[k].velocity = bodies[k].velocity;
    out.bodies[k].angular_velocity = bodies[k].angular_velocity;
    out.bodies[k].displacement = bodies[k].displacement;
  }
  for (std::size_t k = 0; k < library.pairs.size(); ++k)
    out.pairs[k].request.friction = library.pairs[k].friction;
  return out;
}

KernelPointers Kernels::pointers() const {
  KernelPointers out;
  for (const auto& one : kernel) out.push_back(one.get());
  return out;
}

std::vector<StoredKernel> find_kernels(const scene::Scene& scene, const fs::path& folder,
                                       KernelStore& store) {
  std::vector<std::vector<KernelFile>> files;
  std::vector<StoredKernel> out;
  for (const scene::Body& body : scene.bodies) {
    const scene::KernelRequest request = scene::kernel_request(scene, body, &store.meshes);
    const fs::path whole = scene::kernel_path(folder, request);
    files.push_back(files_of(scene, body, request, folder, store));
    const bool none = files.back().empty();
    out.push_back({none ? whole : files.back().front().path, !none, whole,
                   none ? request.hash : files.back().front().hash,
                   depends_on_placement(scene, body, request)});
  }
  const auto whole = [](const auto& of_body) {
    return of_body.size() == 1 && !of_body.front().held && !of_body.front().normal_residual;
  };
  const auto none = [](const auto& of_body) { return of_body.empty(); };
  if (scene.contact.pairs.empty()) return out;  // kernels alone: any will do
  if (std::ranges::all_of(files, whole) || std::ranges::any_of(files, none)) return out;

  KernelPointers kernels;
  for (const StoredKernel& stored : out) kernels.push_back(read(stored.path, store).get());
  const contact::Placement placement = store.placements.place(scene, kernels);
  const std::vector<Points> points = points_within_reach(scene, placement);
  const std::vector<bool> normals = normals_suffice(placement);
  for (std::size_t k = 0; k < files.size(); ++k) {
    const auto enough = std::ranges::find_if(
        files[k], [&](const KernelFile& file) { return file.holds(points[k], normals[k]); });
    out[k].enough = enough != files[k].end();
    if (out[k].enough) out[k].path = enough->path;
  }
  return out;
}

Kernels read_kernels(const scene::Scene& scene, const fs::path& folder, KernelStore& store, bool view) {
  const std::vector<StoredKernel> stored = find_kernels(scene, folder, store);
  Kernels out;
  decltype(store.kernels) kept;
  for (std::size_t k = 0; k < stored.size(); ++k) {
    const scene::Body& body = scene.bodies[k];
    const fs::path& path = stored[k].path;
    const bool several = stored[k].depends_on_placement;
    if (!stored[k].enough && !fs::exists(path))
      throw InputError(fmt::format(
          "{}: no kernel for body \"{}\" {}. Run ricochet-kernel {} first, with the same --set and --out.",
          scene.file.string(), body.name, several ? "in " + folder.string() : "at " + path.string(),
          scene.file.string()));
    const auto kernel = read(path, store, view);
    if (!several && kernel->hash != stored[k].hash)
      throw InputError(
          fmt::format("{}: is a kernel of another scene, not of body \"{}\". Run ricochet-kernel {} again.",
                      path.string(), body.name, scene.file.string()));
    out.kernel.push_back(kernel);
    out.file.push_back(path.filename().string());
    for (const std::string& warning : warnings_of(body, *kernel)) out.warnings.push_back(warning);
    kept[path] = kernel;
  }
  store.kernels = std::move(kept);
  return out;
}

}  // namespace ricochet::store
