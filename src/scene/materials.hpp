// SPDX-License-Identifier: BSD-2-Clause
// Materials by name, from src/scene/materials.toml, which is part of the library.
#pragma once

#include <string>

namespace ricochet::scene {

struct Material;
class Table;

/// The file of materials, with their ranges and sources.
const std::string& materials_toml();

/// The material of this name, in any spelling of its case, hyphens and blanks; `group` is empty.
/// @param key  of the table, which gives the name; a dotted name for a nested key
/// Throws InputError, with the nearest names, if there is none.
Material named_material(const Table& table, const std::string& key, const std::string& name);

}  // namespace ricochet::scene
