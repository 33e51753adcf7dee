// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: loads with histories, moving supports and receivers.
#pragma once

#include <string>

#include "src/scene/request.hpp"

namespace ricochet::scene {

class Table;

/// [loads], once the scene's bodies are known.
void read_loads(Table& root, Scene& scene);

/// [[output.receiver]], likewise.
std::vector<Receiver> read_receivers(Table& output, const Scene& scene);

/// Items of `all` that belong to request.body, as its kernel depends on them.
void take_sources(const Scene& all, const Body& placed, KernelRequest& request);

/// What take_sources took as TOML; empty when it is nothing.
std::string toml_sources(const KernelRequest& request);

}  // namespace ricochet::scene
