// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/expected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "src/scene/write.hpp"

namespace ricochet::scene {

std::string printed(const toml::node& node) {
  if (const auto* text = node.as_string()) return toml_string(text->get());
  if (const auto* number = node.as_floating_point()) return toml_number(number->get());
  if (node.is_table()) return "{…}";
  std::ostringstream text;
  if (const auto* list = node.as_array()) {
    for (const toml::node& entry : *list) text << (text.tellp() > 0 ? ", " : "") << printed(entry);
    return fmt::format("[{}]", text.str());
  }
  node.visit([&](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>) text << value;
  });
  return text.str();
}

namespace {

/// The text of a string, otherwise an empty text.
std::string text_of(const toml::node& node) {
  const auto* text = node.as_string();
  return text == nullptr ? "" : text->get();
}

/// The only entry of a list, otherwise null.
const toml::node* only_entry(const toml::node& node) {
  const auto* list = node.as_array();
  return list != nullptr && list->size() == 1 ? list->get(0) : nullptr;
}

std::string number(const Key& key, const toml::node& given) {
  const std::string text = text_of(given);
  const std::string must =
      key.unit.empty() || key.unit == "1" ? "must be a number" : "must be a number in " + key.unit;
  char* end = nullptr;
  if (!text.empty() && std::isfinite(std::strtod(text.c_str(), &end)) && end != text.c_str())
    return must + (*end == '\0' ? ", without quotes" : ", without quotes and without unit");
  const toml::node* entry = only_entry(given);
  if (entry != nullptr && entry->is_number()) return must + ": write " + printed(*entry);
  return must + (key.range.choices.empty() ? "" : ", or " + Range{.choices = key.range.choices}.text());
}

std::string whole_number(const toml::node& given) {
  const char* must = "must be a whole number";
  const auto* real = given.as_floating_point();
  if (real != nullptr && std::abs(real->get()) < 1e15 && std::nearbyint(real->get()) == real->get())
    return fmt::format("{}: write {}", must, static_cast<std::int64_t>(real->get()));
  const std::string text = text_of(given);
  return must + std::string(!text.empty() && text.find_first_not_of("0123456789") == std::string::npos
                                ? ", without quotes"
                                : "");
}

std::string truth(const toml::node& given) {
  const std::string text = text_of(given);
  return std::string("must be true or false") + (text == "true" || text == "false" ? ", without quotes" : "");
}

std::string text(const Key& key, const toml::node& given) {
  if (!key.range.choices.empty()) return "must be " + key.range.text();
  const toml::node* entry = only_entry(given);
  if (entry != nullptr && entry->is_string()) return "must be one string: write " + printed(*entry);
  return given.is_array() || given.is_table() ? "must be a string"
                                              : fmt::format("must be a string, in quotes");
}

std::string texts(const toml::node& given) {
  return std::string("must be a string or a list of strings") + (given.is_table() ? "" : ", in quotes");
}

/// The unit vector of an axis, "[0, 0, -1]" for "-z"; empty for other texts.
std::string axis(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t k = text.size() == 1 ? std::string_view("xyzXYZ").find(text[0]) : std::string_view::npos;
  if (k == std::string_view::npos) return "";
  const char* one = negative ? "-1" : "1";
  return fmt::format("[{}, {}, {}]", k % 3 == 0 ? one : "0", k % 3 == 1 ? one : "0", k % 3 == 2 ? one : "0");
}

std::string vector(const Key& key, const toml::node& given) {
  const char* must = "must be three numbers, [x, y, z]";
  if (key.type == Type::direction)
    if (const std::string along = axis(text_of(given)); !along.empty())
      return fmt::format("{}: write {}", must, along);
  if (!given.is_number()) return must;
  return fmt::format(
      "{}: write {}", must,
      key.example.empty() ? "[0, 0, " + printed(given) + "] if it points along z" : key.example);
}

/// Whether TOML allows the name as a key without quotes.
bool is_bare(const std::string& name) {
  return std::ranges::all_of(name,
                             [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

std::string table(const Key& key, const std::string& dotted, const toml::node& given) {
  if (key.type == Type::table && !key.example.starts_with('{')) {  // a section of the file
    if (given.is_array_of_tables()) return fmt::format("must be one table: write {}", key.example);
    return "must be a table: write " + key.example;
  }
  std::string inside = key.example;
  const std::string text = text_of(given);
  // The first name of the example, or the text of the user in place of a name that the user chooses.
  const std::string name = inside.substr(2, inside.find(' ', 2) - 2);
  if (key.type == Type::strings && !text.empty() && text.find_first_not_of("xyzXYZ") != std::string::npos)
    inside = fmt::format("{{ {} = \"xyz\" }}", is_bare(text) ? text : toml_string(text));
  else if (given.is_number() && key.name != "material")
    inside = fmt::format("{{ {} = {} }}", name, printed(given));
  return fmt::format("must be a table: write {} = {}", dotted.substr(dotted.rfind('.') + 1), inside);
}

std::string text_or_table(const Key& key, const std::string& dotted) {
  const std::string name = dotted.substr(dotted.rfind('.') + 1);
  return fmt::format("must be a name, in quotes, or a table: write {0} = \"…\" or {0} = {1}", name,
                     key.example);
}

std::string number_or_table(const Key& key, const std::string& dotted, const toml::node& given) {
  const std::string must = number(key, given);
  if (must != "must be a number") return must;
  return fmt::format("{} or a table: write {} = {}", must, dotted.substr(dotted.rfind('.') + 1), key.example);
}

}  // namespace

std::string expected(const Key& key, const std::string& dotted, const toml::node& given) {
  switch (key.type) {
    case Type::number:
      return number(key, given);
    case Type::integer:
      return whole_number(given);
    case Type::integers:
      return "must be a list of whole numbers";
    case Type::list:
    case Type::pairs:
      return fmt::format("must be a list of {}: write {} = {}",
                         key.type == Type::list ? "numbers" : "pairs of numbers", key.name, key.example);
    case Type::boolean:
      return truth(given);
    case Type::text:
      return text(key, given);
    case Type::texts:
      return texts(given);
    case Type::three:
      return "must be three numbers, " + key.example;
    case Type::number_or_three:
      return number(key, given) +
             (given.is_array() && only_entry(given) == nullptr ? ", or three, " + key.example : "");
    case Type::axes:
      return "must be two directions, " + key.example;
    case Type::pair:
      return "must be two numbers, " + key.example;
    case Type::vector:
    case Type::direction:
      return vector(key, given);
    case Type::table:
    case Type::numbers:
    case Type::strings:
      return table(key, dotted, given);
    case Type::number_or_table:
      return number_or_table(key, dotted, given);
    case Type::text_or_table:
      return text_or_table(key, dotted);
    case Type::tables:
      return fmt::format("must be an array of tables, [[{}]]{}", dotted,
                         given.is_table() ? ", with two brackets" : "");
  }
  return "";
}

std::string expected_table(const Section& entries, const std::string& name, const std::string& dotted) {
  if (entries.find(name) != nullptr)
    return fmt::format("must be a table: \"{}\" belongs to {}", name, entries.title);
  return fmt::format("must be a table, [{}]", dotted);
}

}  // namespace ricochet::scene
