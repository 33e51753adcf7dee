// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/scene: what to write in place of a value of another type.
#pragma once

#include <toml++/toml.h>
#include <string>

#include "src/scene/keys.hpp"

namespace ricochet::scene {

/// A value as the user may have written it: 0.3, not 0.29999999999999999.
std::string printed(const toml::node& node);

/// The complaint about a value of another type than `key` has: "must be three numbers, [x, y, z]: write
/// [0, 0, -1]". It proposes what the value most likely means: a number in quotes, a scalar for a vector, an
/// axis for a direction, a name for a table.
/// @param dotted  the whole name of the key, "contact.pair"
std::string expected(const Key& key, const std::string& dotted, const toml::node& given);

/// The complaint about an entry of a table of tables, such as [bodies], that is not a table.
/// @param dotted  the whole name of the entry, "bodies.mesh"
std::string expected_table(const Section& entries, const std::string& name, const std::string& dotted);

}  // namespace ricochet::scene
