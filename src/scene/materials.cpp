// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/materials.hpp"

#include <map>
#include <vector>

#include "base/similar.hpp"
#include "materials_toml.hpp"  // made by CMake from materials.toml
#include "src/scene/data/body.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

/// Names of one material: its own one, and others that it also has.
struct Entry {
  std::string name;
  std::vector<std::string> names;  ///< all of them
  Material material;
};

std::vector<Entry> read_materials() {
  std::vector<Entry> out;
  for (auto&& [key, node] : toml::parse(materials_toml())) {
    const toml::table& table = *node.as_table();
    const auto number = [&](const char* name) { return table[name].value_or(0.0); };
    const auto three = [&](const char* name) {
      Vector3 numbers{};
      for (std::size_t k = 0; k < 3; ++k) numbers[k] = table[name][k].value_or(0.0);
      return numbers;
    };
    Entry& entry = out.emplace_back();
    entry.name = std::string(key.str());
    entry.names = {entry.name};
    if (const toml::array* also = table["also"].as_array())
      for (const toml::node& other : *also) entry.names.push_back(other.value_or(std::string()));
    entry.material = {.group = "",
                      .density = number("density"),
                      .young = number("young"),
                      .poisson = number("poisson"),
                      .yield = number("yield")};
    if (table["young"].is_array())
      entry.material.orthotropy = {
          .young = three("young"), .shear = three("shear"), .poisson = three("poisson")};
  }
  return out;
}

/// Names that resemble the word, as a question; empty if none does.
std::string nearest(const std::string& word, const std::vector<Entry>& all) {
  std::vector<std::string> names;
  for (const Entry& entry : all) names.insert(names.end(), entry.names.begin(), entry.names.end());
  const std::string similar = base::most_similar(word, names);
  if (similar.empty()) return "";
  std::vector<std::string> meant{similar};
  for (const Entry& entry : all)  // "stainless steel" beside "steel"
    if (entry.name != similar && entry.name.find(similar) != std::string::npos) meant.push_back(entry.name);
  std::string text = "Did you mean ";
  for (std::size_t k = 0; k < meant.size(); ++k)
    text += fmt::format("{}\"{}\"", k == 0 ? "" : k + 1 == meant.size() ? " or " : ", ", meant[k]);
  return text + "? ";
}

}  // namespace

const std::string& materials_toml() {
  static const std::string text = materials_file;
  return text;
}

Material named_material(const Table& table, const std::string& key, const std::string& name) {
  static const std::vector<Entry> all = read_materials();
  for (const Entry& entry : all)
    for (const std::string& own : entry.names)
      if (base::plain(own) == base::plain(name)) return entry.material;
  table.complain(
      key, fmt::format("there is no such material. {}\"ricochet materials\" lists those that have a name",
                       nearest(name, all)));
}

}  // namespace ricochet::scene
