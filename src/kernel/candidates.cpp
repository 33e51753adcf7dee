// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "kernels/read.hpp"
#include "src/mesh/apart.hpp"
#include "src/mesh/body_file.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/parts.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/scene.hpp"
#include "src/surface/sources.hpp"

namespace ricochet::kernel {

namespace {

/// Meshes with more nodes than this are read again where they are needed: their modes take far longer.
constexpr std::size_t most_nodes_kept = 200'000;

std::string key_of(const scene::KernelRequest& request) { return limited_to(request, {}).hash; }

}  // namespace

Source OpenedMeshes::open(const scene::KernelRequest& request) {
  const scene::Body& body = request.body;
  const mesh::RequestedGroups asked = surface::requested_groups(request);
  Source source;
  source.files = mesh::open_msh(body, comm_);
  if (source.files) {
    if (parallel::rank_of(comm_) == 0 && !source.files->warning.empty()) console_.warn(source.files->warning);
    return source;
  }
  parallel::on_first_rank(comm_, [&] {
    if (body.imported()) {
      source.whole = mesh::read_body_file(body, asked);
      return;
    }
    source.whole = mesh::read_mesh_apart(
        body, [&](std::int64_t done, std::int64_t total) { console_.advance(done, total); }, asked);
    mesh::forget_meshes();
    for (const std::string& warning : source.whole.warnings) console_.warn(warning);
  });
  return source;
}

void OpenedMeshes::forget_large_ones(const std::string& but) {
  std::erase_if(kept_, [&](const auto& one) {
    return one.first != but && one.second.whole.position.size() > 3 * most_nodes_kept;
  });
}

const Source& OpenedMeshes::look(const scene::KernelRequest& request) {
  const std::string key = key_of(request);
  forget_large_ones(key);
  if (!parallel::of_rank(comm_, 0, kept_.contains(key))) kept_.insert_or_assign(key, open(request));
  return kept_.at(key);
}

Source OpenedMeshes::take(const scene::KernelRequest& request) {
  const std::string key = key_of(request);
  forget_large_ones(key);
  if (!parallel::of_rank(comm_, 0, kept_.contains(key))) return open(request);
  Source source = std::move(kept_.at(key));
  kept_.erase(key);
  return source;
}

surface::Patches patches_of(const scene::KernelRequest& request, const mesh::Mesh& mesh) {
  if (request.body.contact.empty()) return {};  // a scene without [contact]: no candidates
  return surface::make_patches(
      mesh, request.body.contact,
      {.direction = request.direction, .along = request.along, .spacing = request.spacing});
}

namespace {

/// The data of a surface that pairing needs.
kernels::Surface surface_alone(kernels::WholeSurface from) {
  kernels::Surface to;
  to.node = std::move(from.node);
  to.centroid = std::move(from.centroid);
  to.bulge = std::move(from.bulge);
  to.normal = std::move(from.normal);
  to.area = std::move(from.area);
  to.element_corners = from.element_corners;
  to.element = std::move(from.element);
  to.element_normal = std::move(from.element_normal);
  return to;
}

/// The candidates of a body from its mesh, on rank 0. Collective.
kernels::Surface surface_of_mesh(const scene::KernelRequest& request, OpenedMeshes& meshes, MPI_Comm comm,
                                 console::Console& console) {
  const mesh::GmshSession gmsh;
  console.begin(request.body.name + ": surface");
  const auto surface_of = [&](const mesh::Mesh& mesh) {
    return surface_alone(kernels::whole_surface(patches_of(request, mesh).geometry));
  };
  const Source& source = meshes.look(request);
  kernels::Surface surface;
  if (source.files)
    surface = surface_of(mesh::read_msh(*source.files, request.body, comm, MPI_COMM_SELF));
  else
    parallel::on_first_rank(
        comm, [&] { surface = surface_of(mesh::distribute(mesh::GlobalMesh(source.whole), MPI_COMM_SELF)); });
  console.end(fmt::format("{} candidates", surface.area.size()));
  return surface;
}

/// The candidates of a body from one of its kernel files; no value if none can be read.
std::optional<kernels::Surface> surface_of_kernel(const std::vector<store::KernelFile>& files) {
  for (const store::KernelFile& file : files) try {
      return surface_alone(kernels::whole_surface(kernels::read(file.path).surface));
    } catch (const InputError&) {
      // Another file may be readable. If none is, the mesh is read.
    }
  return std::nullopt;
}

}  // namespace

std::vector<Need> needs_of(const scene::Scene& scene, const std::vector<scene::KernelRequest>& requests,
                           const std::filesystem::path& folder, OpenedMeshes& meshes, MPI_Comm comm,
                           console::Console& console) {
  std::vector<Need> needs(requests.size());
  if (scene.contact.pairs.empty()) return needs;  // kernels alone
  if (std::ranges::none_of(scene.bodies, [&](const auto& body) { return store::is_limited(scene, body); }) &&
      std::ranges::none_of(requests, scene::may_be_normal))
    return needs;
  std::vector<kernels::Kernel> surfaces;  // only with the data that pairing needs
  for (const scene::KernelRequest& request : requests) {
    const auto alike = static_cast<std::size_t>(
        std::ranges::find(requests, request.hash, &scene::KernelRequest::hash) - requests.begin());
    if (alike < surfaces.size()) {
      surfaces.push_back(kernels::Kernel(surfaces[alike]));
      continue;
    }
    std::optional<kernels::Surface> known;
    if (parallel::rank_of(comm) == 0) known = surface_of_kernel(store::kernel_files(folder, request));
    surfaces.emplace_back().surface = parallel::of_rank(comm, 0, known.has_value())
                                          ? known.value_or(kernels::Surface{})
                                          : surface_of_mesh(request, meshes, comm, console);
  }
  std::vector<store::Points> points(requests.size());
  std::vector<std::int64_t> normals(requests.size());
  parallel::on_first_rank(comm, [&] {
    store::KernelPointers pointers;
    for (const kernels::Kernel& kernel : surfaces) pointers.push_back(&kernel);
    const contact::Placement placement =
        store::in_file(scene.file, [&] { return store::place(scene, pointers); });
    points = store::points_within_reach(scene, placement);
    std::ranges::copy(store::normals_suffice(placement), normals.begin());
  });
  parallel::broadcast(comm, normals);
  for (std::size_t k = 0; k < needs.size(); ++k) {
    needs[k].normals = normals[k] != 0 && scene::may_be_normal(requests[k]);
    if (!parallel::of_rank(comm, 0, points[k].has_value())) continue;
    if (!points[k]) points[k].emplace();
    parallel::broadcast(comm, *points[k]);
    needs[k].points = std::move(points[k]);
  }
  return needs;
}

scene::KernelRequest limited_to(scene::KernelRequest request, const Need& need) {
  request.points = need.points;
  request.within_reach = need.points.has_value();
  request.normal_residual = need.normals;
  scene::seal(request);
  return request;
}

Need worth_computing(const std::vector<scene::KernelRequest>& requests, const std::vector<Need>& needs,
                     std::size_t k) {
  Need out = needs[k];
  for (std::size_t later = k + 1; later < requests.size(); ++later) {
    if (!scene::similarity(requests[k], requests[later])) continue;
    out.normals = out.normals && needs[later].normals;
    if (!out.points || !needs[later].points) {
      out.points.reset();
      continue;
    }
    std::vector<std::int64_t> both;
    std::ranges::set_union(*out.points, *needs[later].points, std::back_inserter(both));
    out.points = std::move(both);
  }
  return out;
}

}  // namespace ricochet::kernel
