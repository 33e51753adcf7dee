// SPDX-License-Identifier: BSD-2-Clause
// The candidates that the kernels of a scene must contain, chosen before any modes are computed.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/console/console.hpp"
#include "src/mesh/mesh.hpp"
#include "src/mesh/msh_files.hpp"
#include "src/scene/request.hpp"
#include "src/store/placing.hpp"
#include "src/surface/patches.hpp"

namespace ricochet::kernel {

/// A mesh in files, which all ranks read later, or another mesh, on rank 0.
struct Source {
  std::optional<mesh::MshFiles> files;
  mesh::GlobalMesh whole;
};

/// The meshes of a run. gmsh takes seconds to mesh a geometry, so small meshes are kept until they are taken.
/// Needs a GmshSession. Collective; throws InputError as read_mesh does, on every rank.
class OpenedMeshes {
 public:
  OpenedMeshes(MPI_Comm comm, console::Console& console) : comm_(comm), console_(console) {}
  /// Returns the mesh of a body, which may be needed again.
  const Source& look(const scene::KernelRequest& request);
  /// Returns the mesh of a body and forgets it.
  Source take(const scene::KernelRequest& request);

 private:
  Source open(const scene::KernelRequest& request);
  void forget_large_ones(const std::string& but);

  MPI_Comm comm_;
  console::Console& console_;
  std::map<std::string, Source> kept_;  ///< by the hash of the request for all candidates
};

/// All candidates of the body. Needs a GmshSession.
surface::Patches patches_of(const scene::KernelRequest& request, const mesh::Mesh& mesh);

/// What the kernel of a body must contain for its scene.
struct Need {
  store::Points points;  ///< candidates
  bool normals = false;  ///< whether the static correction along the normals suffices
};

/// What each kernel must contain: all candidates if a pair of its body has neither reach nor zone. Surfaces
/// are read from kernels in the folder or from meshes, one mesh at a time; only the surfaces stay in memory.
/// The result is the same on every rank. Collective. Throws InputError in the same cases as read_mesh and
/// contact::place.
std::vector<Need> needs_of(const scene::Scene& scene, const std::vector<scene::KernelRequest>& requests,
                           const std::filesystem::path& folder, OpenedMeshes& meshes, MPI_Comm comm,
                           console::Console& console);

/// What to compute for body k. It includes the needs of later bodies whose kernels can be derived from its
/// kernel.
Need worth_computing(const std::vector<scene::KernelRequest>& requests, const std::vector<Need>& needs,
                     std::size_t k);

/// Limits a request for all candidates and components to those that are needed.
scene::KernelRequest limited_to(scene::KernelRequest request, const Need& need);

}  // namespace ricochet::kernel
