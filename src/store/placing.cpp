// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/placing.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "contact/api/scene_model.hpp"
#include "contact/files/history_file.hpp"
#include "contact/files/surface_file.hpp"
#include "contact/pairing/placement.hpp"
#include "kernels/read.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::store {
namespace fs = std::filesystem;

Scene library_scene(const scene::Scene& scene, const KernelPointers& kernels) {
  Scene out{scene.contact, scene.time, scene.motion};
  for (std::size_t k = 0; k < scene.bodies.size() && k < kernels.size(); ++k)
    out.bodies.emplace_back(scene.bodies[k]).kernel = SharedKernel(SharedKernel(), kernels[k]);
  for (const scene::Obstacle& obstacle : scene.obstacles) {
    out.obstacles.emplace_back(obstacle);
    const fs::path& file = obstacle.is_drawn() ? obstacle.triangles : obstacle.surface;
    if (!file.empty()) out.obstacles.back().mesh = contact::read_surface(file, obstacle.scale);
  }
  out.pairs.assign(scene.contact.pairs.begin(), scene.contact.pairs.end());
  out.gravity = scene.loads.gravity;
  return out;
}

void read_histories(const scene::Scene& scene, Scene& out) {
  const auto add = [&](const std::vector<scene::Forcing>& all, bool support) {
    for (const scene::Forcing& driven : all) {
      Forcing made = driven;
      made.support = support;
      if (support) made.name = driven.group;
      if (!driven.history.empty()) {
        contact::History history = contact::read_history(driven.history);
        made.time = std::move(history.time);
        made.factor = std::move(history.value);
      }
      if (driven.obstacle.empty())
        out.forcing.push_back(std::move(made));
      else
        std::ranges::find(out.obstacles, driven.obstacle, &Obstacle::name)
            ->slides.push_back({made.vector, std::move(made.time), std::move(made.factor), driven.turn_deg});
    }
  };
  add(scene.loads.tractions, false);
  add(scene.loads.points, false);
  add(scene.loads.motions, true);
}

void check_histories(const scene::Scene& scene) {
  Scene out = library_scene(scene, {});
  read_histories(scene, out);
}

contact::Placement place(const scene::Scene& scene, const KernelPointers& kernels) {
  return placement_of(library_scene(scene, kernels));
}

contact::Placement with_kernels(contact::Placement placement, const KernelPointers& kernels) {
  for (std::size_t k = 0; k < kernels.size(); ++k) placement.bodies[k].kernel = kernels[k];
  return placement;
}

contact::Model model_of(const scene::Scene& scene, const Prepared& prepared) {
  contact::Model model = ricochet::model_of(prepared.scene, prepared.placement);
  if (scene.contact.kernel == scene::ContactKernel::table) contact::use_mean_gaps(model);
  for (contact::Model::Receiver& receiver : model.receivers)
    for (const scene::Receiver& recorded : scene.output.receivers)
      if (recorded.name == receiver.name) receiver.axes = recorded.axes;
  return model;
}

StepOptions step_options(const scene::Scene& scene) {
  return ricochet::step_options(library_scene(scene, {}));
}

bool is_limited(const scene::Scene& scene, const scene::Body& body) {
  const auto names = [&](const scene::Pair& pair) { return pair.names(body.name); };
  return std::ranges::any_of(scene.contact.pairs, names) &&
         std::ranges::all_of(scene.contact.pairs, [&](const scene::Pair& pair) {
           return pair.reach || pair.zone || !names(pair);
         });
}

std::vector<Points> points_within_reach(const scene::Scene& scene, const contact::Placement& placement) {
  auto paired = contact::paired_candidates(placement);
  std::vector<Points> out(paired.size());
  for (std::size_t k = 0; k < paired.size(); ++k) {
    const kernels::Surface& surface = placement.bodies[k].kernel->surface;
    const std::size_t all = surface.whole ? surface.whole->area.size() : surface.size();
    if (is_limited(scene, scene.bodies[k]) && paired[k].size() < all) out[k] = std::move(paired[k]);
  }
  return out;
}

std::vector<bool> normals_suffice(const contact::Placement& placement) {
  std::vector<bool> out;
  for (const double tilt : contact::largest_tilts(placement)) out.push_back(tilt <= contact::most_tilt);
  return out;
}

bool KernelFile::holds(const Points& points, bool normals) const {
  return (normals || !normal_residual) && (!held || (points && std::ranges::includes(*held, *points)));
}

std::vector<scene::KernelRequest> with_substitutes(const scene::KernelRequest& request) {
  std::vector<scene::KernelRequest> out{request};
  const auto add = [&](bool scene::KernelRequest::*key, bool value) {
    for (std::size_t k = 0, count = out.size(); k < count; ++k) {
      out.push_back(out[k]);
      out.back().*key = value;
      scene::seal(out.back());
    }
  };
  if (!request.view) add(&scene::KernelRequest::view, true);
  if (request.turns) add(&scene::KernelRequest::turns, false);
  return out;
}

std::vector<KernelFile> kernel_files(const fs::path& folder, const scene::KernelRequest& whole) {
  std::vector<KernelFile> out;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(whole.body.name + "-") || !name.ends_with(".kernel.h5")) continue;
    const auto header = kernels::read_header(entry.path());
    if (!header) continue;
    if (header->normal_residual && !scene::may_be_normal(whole)) continue;
    for (scene::KernelRequest request : with_substitutes(whole)) {
      request.points = header->held;
      request.within_reach = header->held.has_value();
      request.normal_residual = header->normal_residual;
      scene::seal(request);
      if (request.hash == header->hash && entry.path() == scene::kernel_path(folder, request))
        out.push_back(
            {entry.path(), header->hash, header->held, header->normal_residual, header->mesh_error});
    }
  }
  const auto candidates = [](const KernelFile& file) {
    return file.held ? file.held->size() : std::numeric_limits<std::size_t>::max();
  };
  std::ranges::sort(out, [&](const KernelFile& a, const KernelFile& b) {
    const auto lacks = [&](const KernelFile& file) { return whole.mesh_error && !file.mesh_error; };
    return std::tuple(lacks(a), candidates(a), !a.normal_residual, a.path) <
           std::tuple(lacks(b), candidates(b), !b.normal_residual, b.path);
  });
  return out;
}

}  // namespace ricochet::store
