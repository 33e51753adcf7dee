// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: the tables [bodies.NAME].
#pragma once

#include <utility>

#include "src/scene/data/body.hpp"

namespace ricochet::scene {

class Table;

/// Damping laws with a single parameter, by key.
inline constexpr std::pair<const char*, Damping::Law> damping_laws[] = {
    {"ratio", Damping::Law::ratio},
    {"loss_factor", Damping::Law::loss_factor},
    {"viscosity", Damping::Law::viscosity}};

/// Reads the body `name` from its table and resolves its mesh against `folder`. `names`: all bodies of the
/// scene. Throws InputError.
Body read_body(const std::string& name, Table& table, const std::vector<std::string>& names,
               const std::filesystem::path& folder);

/// Reads the keys of a body that its kernel depends on, except its mesh. Throws InputError.
void read_body_matter(Table& table, Body& body);

}  // namespace ricochet::scene
