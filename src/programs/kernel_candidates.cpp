// SPDX-License-Identifier: BSD-2-Clause
#include "src/programs/kernel_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "kernels/read.hpp"
#include "src/mesh/body_file.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/parts.hpp"
#include "src/mesh/read.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/parts.hpp"

namespace ricochet {

Source open_source(const scene::Body& body, const mesh::RequestedGroups& asked, MPI_Comm comm,
                   const parallel::Progress& progress) {
  Source source;
  parallel::on_first_rank(comm, [&] {
    source.in_parts = !scene::part_files(body.mesh).empty();
    if (source.in_parts) return;
    if (body.imported()) {
      source.whole = mesh::read_body_file(body, asked);
      return;
    }
    source.whole = mesh::read_mesh(body, progress, asked);
    mesh::forget_meshes();
  });
  source.in_parts = parallel::of_rank(comm, 0, source.in_parts);
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
  to.normal = std::move(from.normal);
  to.area = std::move(from.area);
  to.element_corners = from.element_corners;
  to.element = std::move(from.element);
  return to;
}

/// The candidates of a body from its mesh, on rank 0. The mesh is freed afterwards. Collective.
kernels::Surface surface_of_mesh(const scene::KernelRequest& request, MPI_Comm comm,
                                 console::Console& console) {
  const scene::Body& body = request.body;
  const mesh::GmshSession gmsh;
  console.begin(body.name + ": surface");
  Source source = open_source(body, {}, comm, {});
  const auto surface_of = [&](const mesh::Mesh& mesh) {
    return surface_alone(kernels::whole_surface(patches_of(request, mesh).geometry));
  };
  kernels::Surface surface;
  if (source.in_parts)
    surface = surface_of(mesh::read_parts(body, comm));
  else
    parallel::on_first_rank(
        comm, [&] { surface = surface_of(mesh::distribute(std::move(source.whole), MPI_COMM_SELF)); });
  console.end(fmt::format("{} candidates", surface.area.size()));
  return surface;
}

/// The candidates of a body from one of its kernel files; no value if none can be read.
std::optional<kernels::Surface> surface_of_kernel(const std::vector<programs::KernelFile>& files) {
  for (const programs::KernelFile& file : files) try {
      return surface_alone(kernels::whole_surface(kernels::read(file.path).surface));
    } catch (const InputError&) {
      // Another file may be readable. If none is, the mesh is read.
    }
  return std::nullopt;
}

}  // namespace

std::vector<Points> needed_points(const scene::Scene& scene,
                                  const std::vector<scene::KernelRequest>& requests,
                                  const std::filesystem::path& folder, MPI_Comm comm,
                                  console::Console& console) {
  std::vector<Points> points(requests.size());
  if (std::ranges::none_of(scene.bodies, [&](const auto& body) { return programs::is_limited(scene, body); }))
    return points;
  std::vector<kernels::Kernel> surfaces;  // only with the data that pairing needs
  for (const scene::KernelRequest& request : requests) {
    const auto alike = static_cast<std::size_t>(
        std::ranges::find(requests, request.hash, &scene::KernelRequest::hash) - requests.begin());
    if (alike < surfaces.size()) {
      surfaces.push_back(kernels::Kernel(surfaces[alike]));
      continue;
    }
    std::optional<kernels::Surface> known;
    if (parallel::rank_of(comm) == 0) known = surface_of_kernel(programs::kernel_files(folder, request));
    surfaces.emplace_back().surface = parallel::of_rank(comm, 0, known.has_value())
                                          ? known.value_or(kernels::Surface{})
                                          : surface_of_mesh(request, comm, console);
  }
  parallel::on_first_rank(comm, [&] {
    programs::KernelPointers pointers;
    for (const kernels::Kernel& kernel : surfaces) pointers.push_back(&kernel);
    points = programs::points_within_reach(
        scene, programs::in_scene(scene, [&] { return programs::place(scene, pointers); }));
  });
  for (Points& of_body : points) {
    if (!parallel::of_rank(comm, 0, of_body.has_value())) continue;
    if (!of_body) of_body.emplace();
    parallel::broadcast(comm, *of_body);
  }
  return points;
}

scene::KernelRequest with_points(scene::KernelRequest request, const Points& points) {
  request.points = points;
  request.within_reach = points.has_value();
  scene::seal(request);
  return request;
}

Points worth_computing(const std::vector<scene::KernelRequest>& requests, const std::vector<Points>& points,
                       std::size_t k) {
  Points out = points[k];
  for (std::size_t later = k + 1; later < requests.size() && out; ++later) {
    if (!scene::similarity(requests[k], requests[later])) continue;
    if (!points[later]) return std::nullopt;
    std::vector<std::int64_t> both;
    std::ranges::set_union(*out, *points[later], std::back_inserter(both));
    out = std::move(both);
  }
  return out;
}

}  // namespace ricochet
