// SPDX-License-Identifier: BSD-2-Clause
// Elements of the bodies, round by round of the accuracy loop: levels everywhere, and balls near contact.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "src/accuracy/settings.hpp"

namespace ricochet::accuracy {

/// Elements of the bodies at a level of refinement, from 0 on. A body whose order is open rises from order 2
/// to 4; if its size is open too, it does so on elements of twice their size, which then shrink. A body of a
/// given order has the next lower order at level 0. Bodies without further levels keep their last one.
std::map<std::string, MeshSettings> meshes_at(const scene::Scene& scene, int level);

/// The scene with the sizes of its geometries, which remain as they are at all levels.
scene::Scene with_own_sizes(scene::Scene scene);

/// Whether some body has finer elements at the next level.
bool has_finer(const scene::Scene& scene, int level);

/// The level at which a scene has these elements; no value if there is none.
std::optional<int> level_of(const scene::Scene& scene, const KernelSettings& settings);

/// Settings with the elements of a level and the same balls.
KernelSettings at_level(KernelSettings settings, const scene::Scene& scene, int level);

/// Which elements differ between two settings.
struct MeshChange {
  bool near_contact = false, elsewhere = false;
  bool operator==(const MeshChange&) const = default;
};

inline constexpr MeshChange only_near_contact{true, false};

MeshChange change_between(const KernelSettings& coarser, const KernelSettings& finer);

/// The last change of the elements.
MeshChange last_change(const Settings& settings);

}  // namespace ricochet::accuracy
