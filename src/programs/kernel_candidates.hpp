// Which candidates the kernels of a scene have to hold, before any modes are computed.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <vector>

#include "src/console/console.hpp"
#include "src/mesh/mesh.hpp"
#include "src/programs/placing.hpp"
#include "src/scene/request.hpp"
#include "src/surface/patches.hpp"

namespace ricochet {

using programs::Points;

/// A mesh that is one file, read on rank 0, or nothing of one that comes in parts. Collective.
struct Source {
  bool in_parts = false;
  mesh::GlobalMesh whole;
};

Source open_source(const scene::Body& body, const mesh::RequestedGroups& asked, MPI_Comm comm,
                   const parallel::Progress& progress);

/// All candidates of the body. Needs a GmshSession.
surface::Patches patches_of(const scene::KernelRequest& request, const mesh::Mesh& mesh);

/// What the kernels have to hold, by the bodies' surfaces: all where no pair has a reach. Surfaces come from
/// kernels in the folder, or from meshes one after the other, of which nothing else stays in memory. The same
/// on every rank. Collective. Throws InputError like read_mesh and contact::pair.
std::vector<Points> needed_points(const scene::Scene& scene,
                                  const std::vector<scene::KernelRequest>& requests,
                                  const std::filesystem::path& folder, MPI_Comm comm,
                                  console::Console& console);

/// What to compute for body k: also the candidates that later bodies need whose kernels then follow from it.
Points worth_computing(const std::vector<scene::KernelRequest>& requests, const std::vector<Points>& points,
                       std::size_t k);

/// A request for all candidates, as one for these.
scene::KernelRequest with_points(scene::KernelRequest request, const Points& points);

}  // namespace ricochet
