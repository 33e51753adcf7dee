// SPDX-License-Identifier: BSD-2-Clause
// States the memory of an impact before it is allocated, and refuses an impact that does not fit, because
// the system would kill the process without a message.
#pragma once

#include <string>

#include "src/store/stored_kernels.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::store {

/// Throws InputError if `needed` [bytes] beside what this process has exceeds 0.9 of the memory that is
/// available to it (base/memory.hpp).
/// @param purpose  what needs it
/// @param remedy  settings that need less
void check_memory(const scene::Scene& scene, const std::string& purpose, double needed,
                  const std::string& remedy);

/// Memory of the kernel [bytes].
double bytes_of(const kernels::Kernel& kernel);

/// Memory that this process has and that the impact of a scene will need beside it [bytes], with its model,
/// its steps, its result and, with an accuracy, the runs that choose its settings.
/// @param kernels  of the scene, which are read already
struct Need {
  double now = 0, more = 0;
  double mib() const;
};
Need need_of(const scene::Scene& scene, const KernelPointers& kernels, const contact::Placement& placement);

/// Throws InputError if the impact does not fit into memory. Returns "… MiB needed of …".
std::string check_impact(const scene::Scene& scene, const KernelPointers& kernels,
                         const contact::Placement& placement);

}  // namespace ricochet::store
