// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/key_reference.hpp"

#include <fmt/format.h>

#include "src/scene/keys.hpp"

namespace ricochet::scene {

namespace {

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

/// Escapes text for a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

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
