// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: loads with histories, moving supports and receivers.
#pragma once

#include <string>

#include "src/scene/data/output.hpp"
#include "src/scene/request.hpp"

namespace ricochet::scene {

class Table;

/// Reads [loads] of `root`. `scene` must already contain its bodies. Throws InputError.
void read_loads(Table& root, Scene& scene);

/// Reads [[output.receiver]]. `scene` must already contain its bodies. Throws InputError.
std::vector<Receiver> read_receivers(Table& output, const Scene& scene);

/// Reads [output.sound], a sound of these receivers. Throws InputError.
std::optional<Sound> read_sound(Table& output, const std::vector<Receiver>& receivers);

/// Rounds to 1e-12, so that hashes do not depend on round-off.
Vector3 rounded(Vector3 vector);

/// Copies the loads, motions and receivers of `all` that belong to the body into the request, reduced to the
/// data on which its kernel depends.
void take_sources(const Scene& all, const Body& placed, KernelRequest& request);

/// The loads, motions and receivers of a request as TOML; empty if there are none.
std::string toml_sources(const KernelRequest& request);

/// Reads [loads] and the receivers in `output`, as toml_sources writes them. Throws InputError.
void read_sources(Table& root, Table& output, KernelRequest& request);

/// Whether both requests have the same loads, motions and receivers, in the same order.
bool same_sources(const KernelRequest& a, const KernelRequest& b);

}  // namespace ricochet::scene
