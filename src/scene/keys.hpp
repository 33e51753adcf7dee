// SPDX-License-Identifier: BSD-2-Clause
// The keys of a scene: type, unit, default, range and meaning of each. A Table (src/scene/table.hpp) accepts
// only the keys described here and enforces the ranges printed in the reference.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "src/scene/range.hpp"

namespace ricochet::scene {

enum class Type {
  number,
  integer,
  integers,
  list,   ///< numbers, at least one
  pairs,  ///< pairs of numbers, at least one
  boolean,
  text,
  texts,      ///< a string or a list of strings
  pair,       ///< two numbers, neither negative
  vector,     ///< three numbers
  direction,  ///< three numbers, not all 0
  table,
  number_or_table,
  tables,   ///< an array of tables
  numbers,  ///< numbers under names that the user chooses
  strings,  ///< strings under names that the user chooses
};

struct Key {
  std::string name;
  Type type;
  std::string unit;
  std::string fallback;  ///< as in the reference: a value in backticks, "none", or "–" for a required key
  Range range;
  std::string meaning;
  /// A table or a vector as a scene would give it; errors show it. Sections of the file: their title and
  /// keys.
  std::string example = {};
};

/// A table of the scene.
struct Section {
  std::string title;    ///< as in the scene: "[bodies.NAME]"
  std::string meaning;  ///< a sentence
  std::vector<Key> keys;

  /// Returns null if the table has no such key.
  const Key* find(std::string_view name) const;
};

extern const Section scene_keys, body_keys, refine_keys, material_keys, damping_keys, obstacle_keys,
    modes_keys, contact_keys, pair_keys, friction_keys, time_keys, loads_keys, traction_keys, point_keys,
    motion_keys, output_keys, receiver_keys, sound_keys, strike_keys;

/// All sections, in the order of the reference.
std::vector<const Section*> all_sections();

}  // namespace ricochet::scene
