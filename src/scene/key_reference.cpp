// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/key_reference.hpp"

#include <fmt/format.h>

#include <array>

#include "src/scene/keys.hpp"

namespace ricochet::scene {

namespace {

/// Name of each Type, in the order of its members.
constexpr std::array names{"number",
                           "whole number",
                           "whole numbers",
                           "list of numbers",
                           "list of pairs",
                           "true or false",
                           "string",
                           "string or list of them",
                           "two numbers",
                           "three numbers",
                           "number or three numbers",
                           "two of [x, y, z]",
                           "[x, y, z]",
                           "[x, y, z]",
                           "table",
                           "number or table",
                           "string or table",
                           "array of tables",
                           "table of numbers",
                           "table of strings"};
static_assert(names.size() == static_cast<std::size_t>(Type::strings) + 1);

std::string range_of(const Key& key) {
  if (key.type == Type::direction) return "any length but 0";
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
      text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.name,
                          names[static_cast<std::size_t>(key.type)], key.unit, key.fallback,
                          cell(range_of(key)), cell(key.meaning));
  }
  text.pop_back();
  return text;
}

}  // namespace ricochet::scene
