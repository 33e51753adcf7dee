// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: loads with histories, moving supports and receivers.
#pragma once

#include <string>

#include "src/scene/request.hpp"

namespace ricochet::scene {

class Table;

/// Reads [loads] of `root`. The bodies of `scene` must be known. Throws InputError.
void read_loads(Table& root, Scene& scene);

/// Reads [[output.receiver]]. The bodies of `scene` must be known. Throws InputError.
std::vector<Receiver> read_receivers(Table& output, const Scene& scene);

/// Copies the items of `all` that belong to the body into the request, in the form in which its kernel
/// depends on them.
void take_sources(const Scene& all, const Body& placed, KernelRequest& request);

/// The items of take_sources as TOML; empty if there are none.
std::string toml_sources(const KernelRequest& request);

}  // namespace ricochet::scene
