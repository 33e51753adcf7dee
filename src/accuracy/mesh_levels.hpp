// SPDX-License-Identifier: BSD-2-Clause
// Elements of the bodies, round by round of the search: finer ones everywhere, and balls near contact.
#pragma once

#include <map>
#include <set>
#include <string>

#include "src/accuracy/settings.hpp"

namespace ricochet::accuracy {

/// Elements of bodies, by name.
using Meshes = std::map<std::string, MeshSettings>;

/// The elements with which a search starts. A body whose order is open has order 2; if its size is open too,
/// it has elements of twice their size.
Meshes coarsest_meshes(const scene::Scene& scene);

/// The next finer elements of each body, with the same balls. An open order rises to 4; then elements of open
/// size shrink, and the others get order 5 (rods: 8). Bodies without finer elements keep theirs.
/// @param fixed  bodies whose geometry fixes the number of elements, so that only their order can be finer
Meshes finer_meshes(const scene::Scene& scene, Meshes meshes, const std::set<std::string>& fixed = {});

/// Whether some body has finer elements.
bool has_finer(const scene::Scene& scene, const Meshes& meshes, const std::set<std::string>& fixed = {});

/// The coarsest elements after `level` refinements.
Meshes meshes_at(const scene::Scene& scene, int level);

/// The scene with the sizes of its geometries, which remain as they are.
scene::Scene with_own_sizes(scene::Scene scene);

/// Whether other elements than those in balls differ.
bool differs_elsewhere(const KernelSettings& one, const KernelSettings& other);

}  // namespace ricochet::accuracy
