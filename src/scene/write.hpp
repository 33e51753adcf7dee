// SPDX-License-Identifier: BSD-2-Clause
// The resolved scene as TOML, whole and in parts.
#pragma once

#include <array>
#include <concepts>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::scene {

struct Scene;

/// The resolved scene as TOML, with every default. Reading it gives the same scene.
std::string to_toml(const Scene& scene);

/// A comment on how its bodies turn, a line of TOML; empty if the scene gives it and nothing more is to be
/// said.
std::string about_rotation(const Scene& scene);

/// All keys of modes, and those of bodies, pairs and time in which `to` differs from `from`, the same scene
/// with some keys open, as overrides `KEY=VALUE`.
std::vector<std::string> differences(const Scene& from, const Scene& to);

std::string toml_number(double value);  ///< shortest text that gives the same number; always a float
std::string toml_string(const std::string& text);
/// The path relative to the folder; empty if the path is empty.
std::string toml_path(const std::filesystem::path& path, const std::filesystem::path& folder);

/// A value as TOML; empty if it is an optional without value.
inline std::string toml_value(double value) { return toml_number(value); }
inline std::string toml_value(Hertz value) { return toml_number(value.value); }
inline std::string toml_value(const std::string& text) { return toml_string(text); }
inline std::string toml_value(const std::filesystem::path& path) { return toml_path(path, {}); }
std::string toml_value(std::same_as<bool> auto on) { return on ? "true" : "false"; }
std::string toml_value(std::integral auto number) requires(!std::same_as<decltype(number), bool>) {
  return std::to_string(number);
}

/// A list, or a vector.
template <class List>
requires requires(const List& list) {
  list.front();
} &&(!std::same_as<List, std::string>)std::string toml_value(const List& list) {
  std::string text;
  for (const auto& entry : list) text += (text.empty() ? "" : ", ") + toml_value(entry);
  return '[' + text + ']';
}

template <class T>
std::string toml_value(const std::optional<T>& value) {
  return value ? toml_value(*value) : "";
}

template <class T>
std::string toml_value(const std::map<std::string, T>& table) {
  std::string text;
  for (const auto& [name, value] : table)
    text += (text.empty() ? " " : ", ") + toml_string(name) + " = " + toml_value(value);
  return '{' + text + " }";
}

}  // namespace ricochet::scene
