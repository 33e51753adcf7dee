// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/near_miss.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "base/similar.hpp"

namespace ricochet::scene {

namespace {

/// The word without its trailing units, "velocity" for "velocity_m_per_s".
std::string without_unit(std::string word) {
  static const std::set<std::string, std::less<>> units = {
      "hz",  "khz", "mhz", "ghz",  "s",   "ms",  "us",  "ns",  "sec", "seconds", "m",  "mm",
      "cm",  "um",  "km",  "kg",   "g",   "pa",  "kpa", "mpa", "gpa", "n",       "kn", "degrees",
      "deg", "rad", "in",  "kgm3", "ms2", "mps", "per", "m2",  "m3",  "si"};
  for (std::size_t bar; (bar = word.rfind('_')) != std::string::npos && bar > 0; word.resize(bar))
    if (!units.contains(base::plain(word.substr(bar)))) break;
  return word;
}

/// The singular of a plural, in plain letters.
std::string singular(std::string word) {
  if (word.ends_with("ies")) return word.replace(word.size() - 3, 3, "y");
  if (word.ends_with('s')) word.pop_back();
  return word;
}

/// Words of the field, of formulas and of other programs, each with the key that has its meaning here.
constexpr std::array<std::pair<std::string_view, std::string_view>, 53> synonyms{
    {{"e", "young"},
     {"elasticity", "young"},
     {"elasticmodulus", "young"},
     {"modulus", "young"},
     {"strength", "yield"},
     {"yieldstrength", "yield"},
     {"yieldstress", "yield"},
     {"rho", "density"},
     {"nu", "poisson"},
     {"zeta", "ratio"},
     {"eta", "loss_factor"},
     {"file", "mesh"},
     {"position", "translate"},
     {"position", "at"},
     {"location", "at"},
     {"coordinates", "at"},
     {"offset", "translate"},
     {"rotation", "rotate_deg"},
     {"orientation", "rotate_deg"},
     {"speed", "velocity"},
     {"v0", "velocity"},
     {"spin", "angular_velocity"},
     {"omega", "angular_velocity"},
     {"fixed", "support"},
     {"clamp", "support"},
     {"clamped", "support"},
     {"constraints", "support"},
     {"surface", "contact"},
     {"surfaces", "contact"},
     {"nmodes", "count"},
     {"number", "count"},
     {"fmax", "up_to_hz"},
     {"band", "up_to_hz"},
     {"frequency", "up_to_hz"},
     {"cutoff", "up_to_hz"},
     {"dt", "rate_hz"},
     {"step", "rate_hz"},
     {"timestep", "rate_hz"},
     {"samplerate", "rate_hz"},
     {"fs", "rate_hz"},
     {"end", "duration"},
     {"tend", "duration"},
     {"distance", "gap"},
     {"g", "gravity"},
     {"force", "vector"},
     {"pressure", "vector"},
     {"mu", "friction"},
     {"mu", "static"},
     {"mus", "static"},
     {"muk", "dynamic"},
     {"mud", "dynamic"},
     {"kinetic", "dynamic"},
     {"sliding", "dynamic"}}};

/// The key that `word` stands for, or null: the same letters, another number or unit, or a synonym.
const Key* same_meaning(const Section& section, const std::string& word) {
  for (const Key& key : section.keys)
    if (singular(base::plain(key.name)) == singular(base::plain(word)) ||
        base::plain(without_unit(key.name)) == base::plain(without_unit(word)))
      return &key;
  for (const auto& [synonym, name] : synonyms)
    if (synonym == base::plain(word) || synonym == base::plain(without_unit(word)))
      if (const Key* key = section.find(name)) return key;
  return nullptr;
}

/// The key of the section for which the word is a misspelt synonym, or null. Short synonyms resemble too many
/// words.
const Key* similar_meaning(const Section& section, const std::string& word) {
  constexpr std::size_t least_letters = 5;
  std::vector<std::string> known;
  for (const auto& [synonym, name] : synonyms)
    if (synonym.size() >= least_letters && section.find(name) != nullptr) known.emplace_back(synonym);
  const std::string similar = base::most_similar(word, known);
  return similar.empty() ? nullptr : same_meaning(section, similar);
}

/// The only name that begins with the same two letters as the word; empty if there is none.
std::string same_beginning(const std::string& word, const std::vector<std::string>& names) {
  const std::string beginning = base::plain(word).substr(0, 2);
  const auto alike = [&](const std::string& name) {
    return beginning.size() == 2 && name.starts_with(beginning);
  };
  return std::ranges::count_if(names, alike) == 1 ? *std::ranges::find_if(names, alike) : "";
}

/// The titles of the sections that have this key, "[time]" or "[[loads.point]] or [[loads.motion]]".
std::string sections_with(const std::string& name, bool is_table) {
  std::vector<std::string> titles;
  for (const Section* section : all_sections()) {
    const Key* key = section->find(name);
    const bool takes_table =
        key != nullptr && (key->type == Type::table || key->type == Type::strings ||
                           key->type == Type::number_or_table || key->type == Type::text_or_table);
    if (key == nullptr || (is_table && !takes_table)) continue;
    const bool top = section->title.front() != '[';
    if (key->type == Type::table && top)
      titles.push_back(fmt::format("[{}]", name));
    else if (key->type == Type::tables)
      titles.push_back(
          top ? fmt::format("[[{}]]", name)
              : fmt::format("[[{}.{}]]", section->title.substr(1, section->title.size() - 2), name));
    else
      titles.push_back(top ? "the top of the file, before all tables" : section->title);
  }
  return fmt::format("{}", fmt::join(titles, " or "));
}

}  // namespace

std::string unknown_key(const Section& section, const std::string& key, bool is_table) {
  const auto meant = [&](const Key& similar) {
    const bool names_unit = without_unit(key) != key && !similar.unit.empty() && similar.unit != "1";
    return fmt::format("unknown key. Did you mean \"{}\"{}?", similar.name,
                       names_unit ? ", in " + similar.unit : "");
  };
  if (const Key* same = same_meaning(section, key)) return meant(*same);
  const std::string elsewhere = sections_with(key, is_table);
  if (!elsewhere.empty()) return "unknown key here: it belongs to " + elsewhere;
  std::vector<std::string> names;
  for (const Key& known : section.keys) names.push_back(known.name);
  std::ranges::sort(names);
  const std::string similar = base::most_similar(without_unit(key), names);
  if (!similar.empty()) return meant(*section.find(similar));
  if (const Key* key_meant = similar_meaning(section, without_unit(key))) return meant(*key_meant);
  const std::string possible = same_beginning(key, names);
  return fmt::format("unknown key. {}The keys here are {}.",
                     possible.empty() ? "" : fmt::format("Did you mean \"{}\"? ", possible),
                     fmt::join(names, ", "));
}

std::string existing_names(const std::string& name, const std::vector<std::string>& existing) {
  if (const std::string similar = base::most_similar(name, existing); !similar.empty())
    return ". Did you mean \"" + similar + "\"?";
  if (existing.empty()) return "";
  return fmt::format(": {} \"{}\"", existing.size() == 1 ? "there is only" : "there are",
                     fmt::join(existing, "\", \""));
}

void check_exists(const Table& table, const std::string& key, const std::string& kind,
                  const std::string& name, const std::vector<std::string>& names) {
  if (std::ranges::count(names, name) == 0)
    table.complain(key, "there is no " + kind + " \"" + name + '"' + existing_names(name, names));
}

}  // namespace ricochet::scene
