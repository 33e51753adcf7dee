// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/contact.hpp"

#include "src/scene/near_miss.hpp"
#include "src/scene/table.hpp"

namespace ricochet::scene {

namespace {

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) names.push_back(body.name);
  for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  return names;
}

/// Reads the keys of one pair; missing keys keep their values in `pair`.
void read_pair(Table& table, const Scene& scene, Pair& pair) {
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
  if (file->empty()) table.complain("table", "must name a file of sampled kernels");
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
    table.refuse_unread();
    return contact;
  }
  Pair shared;
  read_pair(table, scene, shared);
  for (Table& entry : table.array("pair", pair_keys)) {
    Pair pair = shared;
    read_pair(entry, scene, pair);
    entry.refuse_unread();
    if (pair.a.empty()) entry.complain("between", "is missing: name the two that may touch");
    contact.pairs.push_back(body_first(scene, pair));
  }
  table.refuse_unread();
  if (contact.pairs.empty()) {
    if (shared.a.empty()) table.complain("between", "is missing: name the two that may touch");
    contact.pairs.push_back(body_first(scene, shared));
  }
  return contact;
}

}  // namespace ricochet::scene
