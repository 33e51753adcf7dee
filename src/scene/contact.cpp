// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/contact.hpp"

#include <algorithm>

#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) names.push_back(body.name);
  for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  return names;
}

/// Reads [contact.friction] or [contact.pair.friction].
Friction read_coefficients(Table& table) {
  Friction friction;
  friction.static_coefficient = table.required_number("static");
  const auto dynamic = table.number("dynamic"), stribeck = table.number("stribeck_velocity");
  friction.dynamic_coefficient = dynamic.value_or(friction.static_coefficient);
  if (stribeck && !dynamic)
    table.complain("dynamic",
                   "is missing: stribeck_velocity leads from static to dynamic: give it, or leave both out");
  if (!stribeck && friction.dynamic_coefficient != friction.static_coefficient)
    table.complain("stribeck_velocity",
                   fmt::format("is missing: give the sliding speed in m/s at which friction passes from "
                               "static = {:g} to dynamic = {:g}",
                               friction.static_coefficient, friction.dynamic_coefficient));
  friction.stribeck_velocity = stribeck.value_or(0);
  table.refuse_unread();
  return friction;
}

/// Reads `friction` of one pair; if it is missing, `pair` keeps its own.
/// @param contact  with scheme, solver and kernel
void read_friction(Table& table, const Contact& contact, Pair& pair) {
  const toml::node* given = table.raw().get("friction");
  if (given == nullptr) return;
  if (given->is_table()) {
    auto inner = table.table("friction", friction_keys);
    pair.friction = read_coefficients(*inner);
  } else if (const auto both = table.number("friction")) {
    pair.friction = {*both, *both, 0};
  }
  if (pair.friction->static_coefficient == 0 && pair.friction->dynamic_coefficient == 0)
    pair.friction.reset();
  if (!pair.friction) return;
  const auto refuse = [&](const char* with, const char* instead) {
    table.complain("friction",
                   fmt::format("is not possible with {}: set {}, or leave friction out", with, instead));
  };
  if (contact.scheme == Scheme::impulse) refuse("scheme = \"impulse\"", "scheme = \"compliant\"");
  if (contact.kernel == ContactKernel::table) refuse("kernel = \"table\"", "kernel = \"modes\"");
  if (contact.solver == Solver::uzawa) refuse("solver = \"uzawa\"", "solver = \"exact\"");
}

/// Reads the keys of one pair; missing keys keep their values in `pair`.
void read_pair(Table& table, const Scene& scene, const Contact& contact, Pair& pair) {
  const auto names = table.texts("between");
  if (!names.empty()) {
    if (names.size() != 2)
      table.complain("between",
                     "must name two bodies, or a body and an obstacle, as in [\"ball\", \"floor\"]");
    pair.a = names[0];
    pair.b = names[1];
  }
  for (const auto& [key, target] : {std::pair{"direction", &pair.direction}, std::pair{"along", &pair.along}})
    if (const auto given = table.direction(key)) *target = given;
  for (const auto& [key, target] : {std::pair{"spacing", &pair.spacing}, std::pair{"reach", &pair.reach},
                                    std::pair{"zone", &pair.zone}, std::pair{"gap", &pair.gap}})
    if (const auto given = table.number(key)) *target = given;
  read_friction(table, contact, pair);
  if (names.empty()) return;
  if (pair.a == pair.b) table.complain("between", "must name two different bodies");
  for (const std::string& name : names)
    if (scene.find_body(name) == nullptr && scene.find_obstacle(name) == nullptr)
      table.complain("between",
                     "there is no body or obstacle \"" + name + '"' + existing_names(name, names_of(scene)));
  if (scene.find_body(pair.a) == nullptr && scene.find_body(pair.b) == nullptr)
    table.complain("between", "one of the two must be a body");
}

/// Swaps the members of a pair whose first member is an obstacle. Must be called after all keys are read,
/// because a direction in [contact] points out of the first name that the pair gives.
Pair body_first(const Scene& scene, Pair pair) {
  if (scene.find_body(pair.a) != nullptr) return pair;
  std::swap(pair.a, pair.b);
  if (pair.direction)
    for (double& x : *pair.direction) x = x == 0 ? 0 : -x;
  return pair;
}

void read_kernel(Table& table, const std::filesystem::path& folder, Contact& contact) {
  const std::string kernel = table.text("kernel").value_or("modes");
  contact.kernel = kernel == "table" ? ContactKernel::table : ContactKernel::modes;
  const auto file = table.text("table");
  if (!file) return;
  if (contact.kernel != ContactKernel::table)
    table.complain("table", "belongs to kernel = \"table\": add it, or leave the table out");
  if (file->empty()) table.complain("table", "must name a file of sampled responses");
  contact.table = (folder / *file).lexically_normal();
}

void read_scheme(Table& table, Contact& contact) {
  const std::string scheme = table.text("scheme").value_or("compliant");
  contact.scheme = scheme == "compliant" ? Scheme::compliant
                   : scheme == "impulse" ? Scheme::impulse
                                         : Scheme::at_rest;
  const auto integration = table.text("integration");
  if (integration && contact.scheme != Scheme::compliant)
    table.complain("integration", "belongs to scheme = \"compliant\": add it, or leave this key out");
  if (integration == "backward-euler") contact.integration = ContactStep::backward_euler;
  const auto admittance = table.text("admittance");
  const auto instant = table.text("instant");
  const auto restitution = table.number("restitution");
  if (contact.scheme != Scheme::impulse && (admittance || instant || restitution))
    table.complain(admittance ? "admittance"
                   : instant  ? "instant"
                              : "restitution",
                   "belongs to scheme = \"impulse\": add it, or leave this key out");
  contact.admittance = admittance.value_or("jump") == "jump" ? Admittance::jump : Admittance::difference;
  contact.instant = instant.value_or("step") == "step" ? Instant::step : Instant::exact;
  contact.restitution = restitution.value_or(contact.restitution);
  if (const auto pivots = table.integer("max_pivots")) contact.max_pivots = static_cast<int>(*pivots);
  const auto solver = table.text("solver");
  if (solver && contact.scheme != Scheme::at_rest)
    table.complain("solver", "belongs to scheme = \"static\": add it, or leave this key out");
  contact.solver = solver.value_or("exact") == "exact" ? Solver::exact : Solver::uzawa;
}

/// @param has_friction  whether a pair gives its friction
void read_increments(Table& table, bool has_friction, Contact& contact) {
  const auto increments = table.integer("increments");
  if (!increments) return;
  if (contact.scheme != Scheme::at_rest)
    table.complain("increments", "belongs to scheme = \"static\": add it, or leave this key out");
  if (!has_friction)
    table.complain("increments", "needs friction: add it, as in friction = 0.3, or leave this key out");
  contact.increments = static_cast<int>(*increments);
}

}  // namespace

Contact read_contact(Table& root, const Scene& scene) {
  Contact contact;
  Table table =
      root.required("contact", root.table("contact", contact_keys), "give between = [\"body\", \"body\"]");
  read_kernel(table, scene.file.parent_path(), contact);
  read_scheme(table, contact);
  if (!contact.table.empty()) {
    for (const Key& key : pair_keys.keys)
      if (table.raw().contains(key.name))
        table.complain(key.name, "is replaced by contact.table: leave one of them out");
    read_increments(table, false, contact);
    table.refuse_unread();
    return contact;
  }
  Pair shared;
  read_pair(table, scene, contact, shared);
  bool has_friction = table.raw().contains("friction");
  for (Table& entry : table.array("pair", pair_keys)) {
    Pair pair = shared;
    read_pair(entry, scene, contact, pair);
    has_friction = has_friction || entry.raw().contains("friction");
    entry.refuse_unread();
    if (pair.a.empty()) entry.complain("between", "is missing: name the two that may touch");
    contact.pairs.push_back(body_first(scene, pair));
  }
  if (contact.pairs.empty()) {
    if (shared.a.empty()) table.complain("between", "is missing: name the two that may touch");
    contact.pairs.push_back(body_first(scene, shared));
  }
  read_increments(table, has_friction, contact);
  table.refuse_unread();
  return contact;
}

}  // namespace ricochet::scene
