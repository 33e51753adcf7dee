// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/loads.hpp"

#include <algorithm>
#include <cmath>

#include "ricochet/kernel.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/table.hpp"
#include "src/scene/write.hpp"

namespace ricochet::scene {

namespace {

std::string read_body(Table& table, const Scene& scene) {
  const std::string name = table.required("body", table.text("body"), "name the body");
  if (scene.find_body(name) == nullptr) {
    std::vector<std::string> names;
    for (const Body& body : scene.bodies) names.push_back(body.name);
    table.complain("body", "there is no body \"" + name + '"' + existing_names(name, names));
  }
  return name;
}

/// Checks a name that kernels will contain.
void check_name(const Table& table, const std::string& key, const std::string& name) {
  if (!kernels::is_free_name(name))
    table.complain(key,
                   "\"" + name +
                       "\" is not a valid name: use 1 to 100 bytes without \"/\" and control characters, but "
                       "not body_force, body_force_residual or rotation");
}

/// Checks that the motion of a support acts only along components that the support holds.
void check_motion(Table& table, const Body& body, const Forcing& motion) {
  const auto support = body.support.find(motion.group);
  if (support == body.support.end()) {
    std::string all;
    for (const auto& [group, components] : body.support) all += (all.empty() ? "\"" : ", \"") + group + "\"";
    table.complain("group", all.empty()
                                ? "bodies." + body.name + " has no support: give it one, support = { … }"
                                : "is not a support of bodies." + body.name + ": those are " + all);
  }
  check_name(table, "group", motion.group);
  const Vector3 own = in_body(body, motion.vector);
  const double length = std::hypot(own[0], own[1], own[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const char component = "xyz"[k];
    if (std::abs(own[k]) > 1e-9 * length && support->second.find(component) == std::string::npos)
      table.complain(
          "vector",
          fmt::format("moves \"{}\" along the body's {}, which it does not hold (it holds "
                      "\"{}\"): add it to bodies.{}.support, or move along a component that is fixed",
                      motion.group, component, support->second, body.name));
  }
}

/// Reads the names of `motion`, the motion of an obstacle, and checks that it is along its surface.
void read_obstacle(Table& table, const Scene& scene, Forcing& motion) {
  const Obstacle* obstacle = scene.find_obstacle(motion.obstacle);
  if (obstacle == nullptr) {
    std::vector<std::string> names;
    for (const Obstacle& one : scene.obstacles) names.push_back(one.name);
    table.complain("obstacle", "there is no obstacle \"" + motion.obstacle + '"' +
                                   existing_names(motion.obstacle, names));
  }
  for (const char* key : {"body", "group"})
    if (table.raw().contains(key))
      table.complain(key, "belongs to the motion of a support: leave it out, or leave obstacle out");
  motion.name = table.text("name").value_or(motion.obstacle);
  motion.vector = table.required("vector", table.vector("vector"), "[x, y, z] in m, world axes");
  if (const double along = along_normal(*obstacle, motion.vector); along != 0)
    table.complain("vector", fmt::format("has the component {:.6g} m along the normal of obstacles.{}: an "
                                         "obstacle moves along its surface; leave this component out",
                                         along, motion.obstacle));
  if (!table.raw().contains("history"))
    table.complain("history",
                   "is missing: without it the obstacle does not move: give a CSV of times [s] "
                   "and factors, or obstacles." +
                       motion.obstacle + ".velocity");
}

enum class Kind { traction, point, motion };

/// Reads body, place, name and vector of a load or of the motion of a support.
void read_source(Table& table, Kind kind, std::size_t number, const Scene& scene, Forcing& driven) {
  driven.body = read_body(table, scene);
  if (kind == Kind::point)
    driven.at = table.required("at", table.vector("at"), "where the force acts, [x, y, z] in world axes");
  else
    driven.group = table.required("group", table.text("group"),
                                  kind == Kind::traction ? "name a physical surface" : "name a support");
  driven.name =
      table.text("name").value_or(kind == Kind::point ? fmt::format("point {}", number + 1) : driven.group);
  check_name(table, "name", driven.name);
  driven.vector = table.required("vector", table.vector("vector"),
                                 kind == Kind::traction ? "[x, y, z] in Pa, world axes"
                                 : kind == Kind::point  ? "[x, y, z] in N, world axes"
                                                        : "[x, y, z] in m, world axes");
  if (kind == Kind::motion) check_motion(table, *scene.find_body(driven.body), driven);
}

Forcing read_driven(Table& table, Kind kind, std::size_t number, const Scene& scene) {
  Forcing driven;
  if (kind == Kind::motion) driven.obstacle = table.text("obstacle").value_or("");
  if (kind == Kind::motion && table.raw().contains("obstacle"))
    read_obstacle(table, scene, driven);
  else
    read_source(table, kind, number, scene, driven);
  if (const auto history = table.text("history")) {
    driven.history = (scene.file.parent_path() / *history).lexically_normal();
    if (!std::filesystem::is_regular_file(driven.history))
      table.complain("history", "no such file: give a CSV of times [s] and factors, or leave it out");
  }
  table.refuse_unread();
  return driven;
}

void refuse_second(const Table& table, const std::vector<Forcing>& before, const Forcing& driven) {
  for (const Forcing& other : before)
    if (other.body == driven.body && other.obstacle == driven.obstacle && other.name == driven.name)
      table.complain("name", fmt::format("{} has a load or motion \"{}\" already: give each its own name",
                                         driven.obstacle.empty() ? "bodies." + driven.body
                                                                 : "obstacles." + driven.obstacle,
                                         driven.name));
}

void move_to_frame(const Body& body, Vector3& at) {
  for (std::size_t k = 0; k < 3; ++k) at[k] -= body.translate[k];
  at = rounded(in_body(body, at));
}

}  // namespace

void read_loads(Table& root, Scene& scene) {
  auto table = root.table("loads", loads_keys);
  if (!table) return;
  Loads& loads = scene.loads;
  loads.gravity = table->vector("gravity").value_or(Vector3{});
  std::vector<Forcing> all;
  for (const auto& [key, keys, kind, target] :
       {std::tuple{"traction", &traction_keys, Kind::traction, &loads.tractions},
        std::tuple{"point", &point_keys, Kind::point, &loads.points},
        std::tuple{"motion", &motion_keys, Kind::motion, &loads.motions}})
    for (Table& entry : table->array(key, *keys)) {
      target->push_back(read_driven(entry, kind, target->size(), scene));
      refuse_second(entry, all, target->back());
      all.push_back(target->back());
    }
  table->refuse_unread();
}

std::vector<Receiver> read_receivers(Table& output, const Scene& scene) {
  std::vector<Receiver> receivers;
  for (Table& entry : output.array("receiver", receiver_keys)) {
    Receiver receiver;
    receiver.name = entry.required("name", entry.text("name"), "it names the receiver's histories");
    check_name(entry, "name", receiver.name);
    receiver.body = read_body(entry, scene);
    receiver.at = entry.required("at", entry.vector("at"), "the point of the body, [x, y, z] in world axes");
    entry.refuse_unread();
    if (std::ranges::count(receivers, receiver.name, &Receiver::name) > 0)
      entry.complain("name", "another receiver has this name: give each its own");
    receivers.push_back(receiver);
  }
  return receivers;
}

Vector3 rounded(Vector3 vector) {
  for (double& x : vector) x = std::round(x * 1e12) / 1e12;
  return vector;
}

std::optional<Sound> read_sound(Table& output, const std::vector<Receiver>& receivers) {
  auto table = output.table("sound", sound_keys);
  if (!table) return std::nullopt;
  Sound sound;
  sound.receivers = table->texts("receivers");
  if (sound.receivers.empty())
    table->complain("receivers", "is missing: name one receiver (mono) or two (left and right)");
  if (sound.receivers.size() > 2) table->complain("receivers", "must name one receiver or two");
  std::vector<std::string> names;
  for (const Receiver& receiver : receivers) names.push_back(receiver.name);
  for (const std::string& name : sound.receivers)
    if (std::ranges::count(names, name) == 0)
      table->complain("receivers", "there is no receiver \"" + name + '"' + existing_names(name, names));
  sound.direction = table->required("direction", table->direction("direction"),
                                    "the component that is heard, for example the normal of the wall");
  sound.high_pass_hz = table->number("high_pass_hz").value_or(sound.high_pass_hz);
  sound.fade = table->number("fade").value_or(sound.fade);
  if (const auto format = table->text("format"))
    sound.format = static_cast<SampleFormat>(std::ranges::find(sample_format_names, *format) -
                                             sample_format_names.begin());
  table->refuse_unread();
  return sound;
}

void take_sources(const Scene& all, const Body& placed, KernelRequest& request) {
  for (const auto& [from, to] :
       {std::pair{&all.loads.tractions, &request.tractions},
        std::pair{&all.loads.points, &request.point_forces}, std::pair{&all.loads.motions, &request.motions}})
    for (Forcing driven : *from) {
      if (driven.body != placed.name) continue;
      driven.vector = {};
      driven.history.clear();
      if (from == &all.loads.points) move_to_frame(placed, driven.at);
      // All motions of a support share one dataset of the kernel, whatever their histories.
      if (from == &all.loads.motions) driven.name = driven.group;
      if (std::ranges::count(*to, driven.name, &Forcing::name) == 0) to->push_back(driven);
    }
  for (Receiver receiver : all.output.receivers) {
    if (receiver.body != placed.name) continue;
    move_to_frame(placed, receiver.at);
    request.receivers.push_back(receiver);
  }
}

std::string toml_sources(const KernelRequest& request) {
  std::string text;
  for (const auto& [table, list] :
       {std::pair{"traction", &request.tractions}, std::pair{"point", &request.point_forces},
        std::pair{"motion", &request.motions}})
    for (const Forcing& driven : *list)
      text += fmt::format("[[loads.{}]]\nname = {}\n{}\n", table, toml_string(driven.name),
                          list == &request.point_forces ? "at = " + toml_vector(driven.at)
                                                        : "group = " + toml_string(driven.group));
  for (const Receiver& receiver : request.receivers)
    text += fmt::format("[[output.receiver]]\nname = {}\nat = {}\n", toml_string(receiver.name),
                        toml_vector(receiver.at));
  return text;
}

void read_sources(Table& root, Table& output, KernelRequest& request) {
  const char* remedy = "compute the kernel again with ricochet-kernel";
  if (auto loads = root.table("loads", loads_keys)) {
    for (const auto& [key, keys, target] : {std::tuple{"traction", &traction_keys, &request.tractions},
                                            std::tuple{"point", &point_keys, &request.point_forces},
                                            std::tuple{"motion", &motion_keys, &request.motions}})
      for (Table& entry : loads->array(key, *keys)) {
        Forcing& driven = target->emplace_back();
        driven.name = entry.required("name", entry.text("name"), remedy);
        if (target == &request.point_forces)
          driven.at = entry.required("at", entry.vector("at"), remedy);
        else
          driven.group = entry.required("group", entry.text("group"), remedy);
        entry.refuse_unread();
      }
    loads->refuse_unread();
  }
  for (Table& entry : output.array("receiver", receiver_keys)) {
    Receiver& receiver = request.receivers.emplace_back();
    receiver.name = entry.required("name", entry.text("name"), remedy);
    receiver.at = entry.required("at", entry.vector("at"), remedy);
    entry.refuse_unread();
  }
}

bool same_sources(const KernelRequest& a, const KernelRequest& b) {
  const auto same = [](const auto& x, const auto& y) {
    if constexpr (requires { x.group; })
      if (x.group != y.group) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(x.at[k] - y.at[k]) > 2e-12) return false;  // two roundings
    return x.name == y.name;
  };
  return std::ranges::equal(a.tractions, b.tractions, same) &&
         std::ranges::equal(a.point_forces, b.point_forces, same) &&
         std::ranges::equal(a.motions, b.motions, same) && std::ranges::equal(a.receivers, b.receivers, same);
}

}  // namespace ricochet::scene
