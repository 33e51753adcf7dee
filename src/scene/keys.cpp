// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/keys.hpp"

#include <fmt/format.h>

namespace ricochet::scene {

const Key* Section::find(std::string_view name) const {
  const auto found = std::ranges::find(keys, name, &Key::name);
  return found == keys.end() ? nullptr : &*found;
}

void Section::read_into(const Table& table, void* settings) const {
  for (const Key& key : keys) {
    if (!key.access.read || key.access.read(table, key, settings)) continue;
    if (key.fallback != "–") continue;
    if (key.type == Type::number)
      table.complain(key.name, "is missing: give a number" +
                                   (key.unit.empty() || key.unit == "1" ? "" : " in " + key.unit));
    if (!key.remedy.empty()) table.complain(key.name, "is missing: " + key.remedy);
  }
  for (const Key& key : keys)
    if (key.access.applies && table.has(key.name) && !key.access.applies(settings))
      table.complain(key.name,
                     fmt::format("belongs to {}: add it, or leave this key out", key.access.condition));
}

std::string Section::text_of(const void* settings, const std::filesystem::path& folder,
                             bool in_braces) const {
  std::string text;
  for (const Key& key : keys) {
    const AnyAccess& access = key.access;
    const auto holds = [&](const auto& condition) { return !condition || condition(settings); };
    if (!access.write || !holds(access.is_written) || !holds(access.applies)) continue;
    const std::string value = access.write(settings, folder);
    if (value.empty()) continue;
    if (in_braces) text += text.empty() ? " " : ", ";
    text += fmt::format("{} = {}{}", key.name, value, in_braces ? "" : "\n");
  }
  if (!in_braces) return text;
  return text.empty() ? "{}" : '{' + text + " }";
}

std::vector<const Section*> all_sections() {
  return {&scene_keys,    &body_keys,  &refine_keys,   &material_keys, &about_keys,    &damping_keys,
          &obstacle_keys, &modes_keys, &contact_keys,  &pair_keys,     &friction_keys, &rigid_motion_keys,
          &time_keys,     &loads_keys, &traction_keys, &point_keys,    &motion_keys,   &output_keys,
          &receiver_keys, &gauge_keys, &sound_keys,    &strike_keys};
}

}  // namespace ricochet::scene
