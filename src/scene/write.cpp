// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "src/scene/keys.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

std::string toml_number(double value) {
  if (value == 0) value = 0;  // not "-0"
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(const std::string& text) {
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 32 || c == 127) {
      quoted += fmt::format("\\u{:04X}", static_cast<int>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_path(const std::filesystem::path& path, const std::filesystem::path& folder) {
  if (path.empty()) return "";
  const auto relative = path.lexically_relative(folder.empty() ? "." : folder);
  return toml_string((relative.empty() ? path : relative).string());
}

namespace {

std::string motion_of(const Scene& scene) {
  const Motion& motion = scene.motion;
  // Bodies at rest, sampled responses, impulses and kernels alone have no choice.
  const bool has_choice =
      motion.is_finite() || (scene.contact.has_contact_rate() && !scene.contact.pairs.empty());
  const std::string keys =
      (has_choice ? rigid_motion_keys : rigid_motion_keys.without({"rotation"})).write(motion);
  return keys.empty() ? "" : "\n[motion]\n" + keys;
}

std::string time_of(const Scene& scene) {
  if (!(scene.time.duration > 0)) return "";
  std::set<std::string_view> open;
  if (scene.time.samples_by_accuracy || (scene.time.rate_by_accuracy && !scene.contact.has_contact_rate()))
    open.insert("rate_hz");
  if (scene.time.precision_by_accuracy || (!scene.accuracy && scene.time.precision == Time{}.precision))
    open.insert("precision");
  return "\n[time]\n" + time_keys.without(open).write(scene.time);
}

std::string loads_of(const Loads& loads, const std::filesystem::path& folder) {
  std::string text = "\n[loads]\n" + loads_keys.write(loads);
  for (const LoadKind& kind : load_kinds)
    for (const Forcing& driven : loads.*kind.list)
      text += fmt::format("\n[[loads.{}]]\n{}", kind.name, kind.keys.write(driven, folder));
  return text;
}

std::string output_of(const Output& output, const SectionOf<Output>& keys) {
  std::string text = "\n[output]\n" + keys.write(output);
  for (const Receiver& receiver : output.receivers)
    text += "\n[[output.receiver]]\n" + receiver_keys.write(receiver);
  for (const Gauge& gauge : output.gauges) text += "\n[[output.gauge]]\n" + gauge_keys.write(gauge);
  if (output.sound) text += "\n[output.sound]\n" + sound_keys.write(*output.sound);
  return text;
}

}  // namespace

std::string to_toml(const Scene& scene) {
  const std::filesystem::path folder = scene.file.parent_path();
  const bool tabular = !scene.contact.table.empty();
  const auto copied = [&](const std::string& name) {
    const Body* const body = scene.find_body(name);
    return body != nullptr && !body->copy_of.empty();
  };
  std::string text = scene_keys.write(scene);
  for (const Body& body : scene.bodies)
    if (body.copy_of.empty())
      text += fmt::format("\n[bodies.{}]\n{}", body.name, body_keys.write(body, folder));
  for (const Strike& strike : scene.strikes) text += "\n[[strikes]]\n" + strike_keys.write(strike);
  for (const Obstacle& obstacle : scene.obstacles)
    text += fmt::format("\n[obstacles.{}]\n{}", toml_string(obstacle.name), obstacle_keys.write(obstacle));
  if (!tabular) text += "\n[modes]\n" + modes_keys.write(scene.modes);
  if (tabular || !scene.contact.pairs.empty())
    text += "\n[contact]\n" + contact_keys.write(scene.contact, folder);
  for (const Pair& pair : scene.contact.pairs)
    if (!copied(pair.a) && !copied(pair.b)) text += "\n[[contact.pair]]\n" + pair_keys.write(pair);
  text += motion_of(scene) + time_of(scene);
  if (!tabular) text += loads_of(scene.loads, folder);
  return text + output_of(scene.output,
                          tabular ? output_keys.without({"snapshot_every", "vtk_every"}) : output_keys);
}

std::string about_rotation(const Scene& scene) {
  const Motion& motion = scene.motion;
  if (motion.rotation_open)
    return "# motion.rotation is \"linear\", or \"finite\" if the run finds that a body turns by more than 1 "
           "degree.\n";
  if (motion.reason.empty()) return "";
  return fmt::format("# motion.rotation is \"{}\": {}.\n", motion.is_finite() ? "finite" : "linear",
                     motion.reason);
}

namespace {

/// Adds the lines of `to` that `from` does not have, as overrides of keys below a table.
void add_differences(const std::string& table, const std::string& from, const std::string& to,
                     std::vector<std::string>& out) {
  std::set<std::string> known;
  std::istringstream before(from), after(to);
  for (std::string line; std::getline(before, line);) known.insert(line);
  for (std::string line; std::getline(after, line);)
    if (const auto equals = line.find(" = "); equals != std::string::npos && !known.contains(line))
      out.push_back(table + line.replace(equals, 3, "="));
}

}  // namespace

std::vector<std::string> differences(const Scene& from, const Scene& to) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < to.bodies.size(); ++k)
    if (to.bodies[k].copy_of.empty())
      add_differences(fmt::format("bodies.{}.", to.bodies[k].name), body_keys.write(from.bodies[k]),
                      body_keys.write(to.bodies[k]), out);
  add_differences("modes.", "", modes_keys.write(to.modes), out);  // defaults depend on what is open
  // Keys of [contact] are those of every pair that does not have them.
  for (std::size_t k = 0; k < to.contact.pairs.size(); ++k)
    add_differences("contact.", pair_keys.write(from.contact.pairs[k]), pair_keys.write(to.contact.pairs[k]),
                    out);
  add_differences("motion.", motion_of(from), motion_of(to), out);
  const std::string open = time_of(from), closed = time_of(to);
  add_differences("time.", open, closed, out);
  std::ranges::sort(out);
  out.erase(std::ranges::unique(out).begin(), out.end());
  return out;
}

}  // namespace ricochet::scene
