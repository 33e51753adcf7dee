// SPDX-License-Identifier: BSD-2-Clause
// Suggestions for words that a scene misspells: names of keys, bodies, obstacles and supports.
#pragma once

#include <string>
#include <vector>

#include "src/scene/keys.hpp"

namespace ricochet::scene {

/// The complaint about a key that `section` does not have, with what to write: the similar key of this
/// section and, if the unknown key states a unit, its unit; otherwise the section that has such a key;
/// otherwise all keys of this section, with the one that begins alike.
/// @param is_table  whether the value of the key is a table: then only tables of other sections are meant
std::string unknown_key(const Section& section, const std::string& key, bool is_table);

/// Ends a sentence on a name that does not exist: `. Did you mean "floor"?`, or the names that exist.
std::string existing_names(const std::string& name, const std::vector<std::string>& existing);

/// The names of bodies, obstacles or receivers.
std::vector<std::string> names_of(const auto& all) {
  std::vector<std::string> names;
  for (const auto& one : all) names.push_back(one.name);
  return names;
}

/// Throws InputError if `name`, the value of `key`, is not one of the names. `kind`: "body".
void check_exists(const Table& table, const std::string& key, const std::string& kind,
                  const std::string& name, const std::vector<std::string>& names);

}  // namespace ricochet::scene
