// SPDX-License-Identifier: BSD-2-Clause
// Ranges of keys, and the reference of all of them.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "src/scene/keys.hpp"

namespace ricochet::scene {

namespace {

double value_of(const std::string& bound) { return std::strtod(bound.c_str(), nullptr); }

/// "a, b or c".
std::string either(const std::vector<std::string>& choices) {
  std::string text;
  for (std::size_t k = 0; k < choices.size(); ++k)
    text += fmt::format("{}\"{}\"", k == 0 ? "" : k + 1 < choices.size() ? ", " : " or ", choices[k]);
  return text;
}

const char* name_of(Type type) {
  switch (type) {
    case Type::number:
      return "number";
    case Type::integer:
      return "whole number";
    case Type::integers:
      return "whole numbers";
    case Type::boolean:
      return "true or false";
    case Type::text:
      return "string";
    case Type::texts:
      return "string or list of them";
    case Type::pair:
      return "two numbers";
    case Type::vector:
      return "[x, y, z]";
    case Type::direction:
      return "[x, y, z]";
    case Type::table:
      return "table";
    case Type::tables:
      return "array of tables";
    case Type::numbers:
      return "table of numbers";
    case Type::strings:
      return "table of strings";
  }
  return "";
}

std::string range_of(const Key& key) {
  if (key.type == Type::direction) return "any length but 0";
  if (key.type == Type::pair) return "at least 0";
  return key.range.text();
}

/// As a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

bool Range::holds(double value) const {
  if (or_zero && value == 0) return true;
  if (!low.empty() && (low_open ? value <= value_of(low) : value < value_of(low))) return false;
  return high.empty() || (high_open ? value < value_of(high) : value <= value_of(high));
}

std::string Range::text() const {
  if (!choices.empty()) return either(choices);
  std::string text = or_zero ? "0 or " : "";
  if (low_open && high_open) return text + fmt::format("above {} and below {}", low, high);
  if (!low.empty() && !high.empty()) return text + fmt::format("from {} to {}", low, high);
  if (!low.empty()) return text + (low_open ? "above " : "at least ") + low;
  return "";
}

const Key* Section::find(std::string_view name) const {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

std::string key_reference() {
  std::string text =
      "# Keys of a scene\n\n"
      "This reference is generated from the code that reads scenes: `ricochet-contact --keys` prints it.\nA "
      "key whose default is \"–\" is required. Numbers must be 0 or have a magnitude between 1e-30 and 1e30; "
      "directions may have any length but 0.\n[The scene](scene.md) explains how keys work together, with "
      "examples.\n";
  for (const Section* section : all_sections()) {
    const bool table = section->title.front() == '[';
    text += fmt::format("\n## {0}{1}{0}\n\n", table ? "`" : "", section->title);
    if (!section->meaning.empty()) text += section->meaning + "\n\n";
    text += "| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
    for (const Key& key : section->keys)
      text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.name, name_of(key.type), key.unit,
                          key.fallback, cell(range_of(key)), cell(key.meaning));
  }
  text.pop_back();
  return text;
}

}  // namespace ricochet::scene
