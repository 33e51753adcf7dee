// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/curved.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/straighten.hpp"

namespace ricochet::mesh {

namespace {

/// Most elements for which the optimiser is called. The other optimiser of gmsh takes minutes for some meshes
/// of a few thousand elements.
constexpr std::size_t most_optimised = 200'000;

/// Takes the positions of gmsh's optimiser if fewer elements are then inverted.
void bend(GlobalMesh& mesh, std::int64_t inverted, const std::unordered_map<std::size_t, std::int64_t>& index,
          double scale) {
  const std::vector<double> before = mesh.position;
  try {
    gmsh::model::mesh::optimize("HighOrderElastic");
  } catch (...) {
    GmshSession::keep_broken_model();
    return;
  }
  std::vector<std::size_t> tags;
  std::vector<double> position, parametric;
  gmsh::model::mesh::getNodes(tags, position, parametric);
  for (std::size_t i = 0; i < tags.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.position[3 * static_cast<std::size_t>(index.at(tags[i])) + k] = position[3 * i + k] * scale;
  if (count_inverted(mesh) >= inverted) mesh.position = before;
}

}  // namespace

void repair_curved(GlobalMesh& mesh, const std::string& file,
                   const std::unordered_map<std::size_t, std::int64_t>& index, double scale) {
  if (mesh.order == 1) return;
  const std::int64_t inverted = count_inverted(mesh);
  if (inverted == 0) return;
  std::size_t elements = 0;
  for (const Block& block : mesh.blocks) elements += block.size();
  if (elements <= most_optimised) bend(mesh, inverted, index, scale);
  if (const Straightened done = straighten_inverted(mesh); done.elements > 0)
    mesh.warnings.push_back(fmt::format(
        "{}: {} curved elements were inverted, and {} were straightened to repair them: nodes are up to "
        "{:.2g} m from the surface; a smaller size_factor brings them closer",
        file, inverted, done.elements, done.distance));
}

}  // namespace ricochet::mesh
