// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/loads.hpp"

#include <algorithm>
#include <cmath>

#include "ricochet/kernel.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

Declared<Forcing> name_of_source(const char* fallback) {
  return {"name",
          &Forcing::name,
          "",
          fallback,
          any(),
          "a name that no other load or motion of the body has; at most 100 bytes, no `/`, and not "
          "`body_force`, `body_force_residual` or `rotation`"};
}

Declared<Forcing> vector_of_source(const std::string& unit, const char* meaning) {
  return {"vector", &Forcing::vector, unit, required("[x, y, z] in " + unit + ", world axes"),
          any(),    meaning};
}

/// An obstacle may turn without being displaced.
Declared<Forcing> vector_of_motion() {
  Access<Forcing> vector(&Forcing::vector);
  vector.is_written = [](const void* motion) {
    const Forcing& of = *static_cast<const Forcing*>(motion);
    return of.turn_deg == Vector3{} || of.vector != Vector3{};
  };
  return {"vector", vector,
          "m",      "– without `turn_deg`",
          any(),    "displacement, in world axes, along components that the support holds"};
}

/// A traction has either a vector or a pressure.
Declared<Forcing> vector_of_traction() {
  Access<Forcing> vector(&Forcing::vector);
  vector.is_written = [](const void* traction) {
    return !static_cast<const Forcing*>(traction)->pressure.has_value();
  };
  return {"vector", vector, "Pa", "– without `pressure`", any(), "traction, in world axes at t = 0"};
}

Declared<Forcing> axes_of_source(const char* fallback) {
  return {"axes",
          choice<Forcing>(&Forcing::axes, {"world", "body"}),
          "",
          fallback,
          any(),
          "whether `vector` keeps its direction in the world, or turns with the body. Needs `rotation = "
          "\"finite\"`"};
}

Declared<Forcing> history_of_source() {
  return {
      "history",
      &Forcing::history,
      "",
      none,
      any(),
      "CSV file of times [s] and factors that multiply `vector` or `pressure`. Without a file, the factor is "
      "always 1: a dead load, under which bodies start at rest"};
}

}  // namespace

const SectionOf<Loads> loads_keys{
    "[loads]",
    "",
    {{"gravity", &Loads::gravity, "m/s²", initial, any(), "acceleration of gravity, in world axes",
      "[0, 0, -9.81]"},
     {"traction", Type::tables, "", none, any(), "`[[loads.traction]]`, forces distributed over surfaces"},
     {"point", Type::tables, "", none, any(), "`[[loads.point]]`, point forces"},
     {"motion", Type::tables, "", none, any(), "`[[loads.motion]]`, moving supports"}}};

const SectionOf<Forcing> traction_keys{
    "[[loads.traction]]",
    "A force distributed over a surface.",
    {name_of_source("the group"),
     body_key<Forcing>(),
     {"group", Access(&Forcing::group).if_changed(), "", required("name a physical surface"), any(),
      "physical surface on the outside of the body (for a rod: an end). It may also be a contact surface"},
     vector_of_traction(),
     {"pressure", &Forcing::pressure, "Pa", "– without `vector`", any(),
      "pressure: it acts against the outward normal at each point, also while the body turns. A negative one "
      "pulls"},
     axes_of_source("`\"body\"`"),
     history_of_source()}};

const SectionOf<Forcing> point_keys{
    "[[loads.point]]",
    "A force at a point.",
    {name_of_source("point 1, point 2, …"), body_key<Forcing>(), at_key<Forcing>("point of application"),
     at_body_key<Forcing>(), vector_of_source("N", "force, in world axes at t = 0"),
     axes_of_source("`\"world\"`"), history_of_source()}};

const SectionOf<Forcing> motion_keys{
    "[[loads.motion]]",
    "The displacement of a support, or [the motion of an obstacle](scene.md#obstacles-that-move). Motions of "
    "an obstacle and its `velocity` and `angular_velocity` add up.",
    {name_of_source("the group, or the obstacle"),
     {"obstacle", Access(&Forcing::obstacle).if_changed(), "", none, any(),
      "name of an obstacle, in place of `body` and `group`. Its motion needs a `history`"},
     {"body", Access<Forcing>(&Forcing::body).if_changed(), "", "– without `obstacle`", any(),
      "name of a body"},
     {"group", Access(&Forcing::group).if_changed(), "", "– without `obstacle`", any(),
      "one of the body's supports"},
     vector_of_motion(),
     {"turn_deg", Access(&Forcing::turn_deg).if_changed(), "degrees", none, any(),
      "turn of an obstacle about the line through its `point` along this vector, by its length, "
      "anticlockwise; not of a half-space. All turns of an obstacle have the same axis"},
     history_of_source()}};

void check_name(const Table& table, const std::string& key, const std::string& name) {
  if (!kernels::is_free_name(name))
    table.complain(key,
                   "\"" + name +
                       "\" is not a valid name: use 1 to 100 bytes without \"/\" and control characters, but "
                       "not body_force, body_force_residual or rotation");
}

void check_place(const Table& table, const std::string& what) {
  if (table.has("at") && table.has("at_body"))
    table.complain("at_body", "is the place that `at` gives in world axes: leave one of them out");
  if (!table.has("at") && !table.has("at_body"))
    table.complain(
        "at", "is missing: give " + what + ", [x, y, z] in world axes, or at_body, in the axes of the mesh");
}

namespace {

/// Checks that a traction has a vector or a pressure.
void check_traction(const Table& table) {
  const bool pressed = table.has("pressure");
  if (!pressed && !table.has("vector"))
    table.complain("vector", "is missing: give [x, y, z] in Pa, world axes, or a pressure in Pa");
  for (const char* key : {"vector", "axes"})
    if (pressed && table.has(key))
      table.complain(key, "has no effect on a pressure, which acts along the normal: leave one of them out");
}

/// Checks that the motion of a support acts only along components that the support holds.
void check_motion(const Table& table, const Body& body, const Forcing& motion) {
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

/// Checks the motion of an obstacle.
void check_slide(const Table& table, const Scene& scene, const Forcing& motion) {
  check_exists(table, "obstacle", "obstacle", motion.obstacle, names_of(scene.obstacles));
  for (const char* key : {"body", "group"})
    if (table.has(key))
      table.complain(key, "belongs to the motion of a support: leave it out, or leave obstacle out");
  const Obstacle& obstacle = *scene.find_obstacle(motion.obstacle);
  if (obstacle.is_half_space() && table.has("turn_deg"))
    table.complain("turn_deg",
                   "turns a half-space, which only moves as it is: give a box, or leave this key out");
  if (!table.has("history"))
    table.complain("history",
                   "is missing: without it the obstacle does not move: give a CSV of times [s] "
                   "and factors, or obstacles." +
                       motion.obstacle + ".velocity");
}

/// @param number  of earlier loads of this kind
Forcing read_driven(const Table& table, const LoadKind& kind, std::size_t number, const Scene& scene) {
  Forcing driven;
  kind.keys.read(table, driven);
  const bool is_motion = &kind.keys == &motion_keys, is_slide = table.has("obstacle"),
             is_point = &kind.keys == &point_keys;
  if (is_point) check_place(table, "the point where the force acts");
  if (&kind.keys == &traction_keys) check_traction(table);
  if (is_motion && !table.has("vector") && !(is_slide && table.has("turn_deg")))
    table.complain("vector", "is missing: [x, y, z] in m, world axes");
  if (is_slide) {
    check_slide(table, scene, driven);
  } else {
    if (is_motion && !table.has("body")) table.complain("body", "is missing: name the body");
    if (table.has("turn_deg"))
      table.complain("turn_deg", "belongs to the motion of an obstacle: leave it out");
    check_exists(table, "body", "body", driven.body, names_of(scene.bodies));
    if (is_motion && !table.has("group")) table.complain("group", "is missing: name a support");
  }
  if (!table.has("name"))
    driven.name = is_slide ? driven.obstacle : is_point ? fmt::format("point {}", number + 1) : driven.group;
  if (!is_slide) check_name(table, "name", driven.name);
  if (is_motion && !is_slide) check_motion(table, *scene.find_body(driven.body), driven);
  if (table.has("history") && !std::filesystem::is_regular_file(driven.history))
    table.complain("history", "no such file: give a CSV of times [s] and factors, or leave it out");
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

}  // namespace

void read_loads(const Table& root, Scene& scene) {
  const auto table = root.table("loads", loads_keys);
  if (!table) return;
  loads_keys.read(*table, scene.loads);
  std::vector<Forcing> all;
  for (const LoadKind& kind : load_kinds)
    for (const Table& entry : table->array(kind.name, kind.keys)) {
      std::vector<Forcing>& list = scene.loads.*kind.list;
      list.push_back(read_driven(entry, kind, list.size(), scene));
      refuse_second(entry, all, list.back());
      all.push_back(list.back());
    }
}

}  // namespace ricochet::scene
