// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/contact.hpp"

#include <algorithm>

#include "src/scene/keys.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

bool read_between(const Table& table, const Key& key, Pair& pair) {
  std::vector<std::string> names;
  if (!table.read(key, names)) return false;
  pair.meets_all = names == std::vector<std::string>{"all"};
  if (pair.meets_all) return true;
  if (names.size() != 2)
    table.complain(
        "between",
        "must name two bodies, or a body and an obstacle, as in [\"ball\", \"floor\"], or be \"all\"");
  pair.a = names[0];
  pair.b = names[1];
  return true;
}

std::string between_of(const Pair& pair) { return toml_value(std::vector{pair.a, pair.b}); }

/// Reads [contact.friction] or [contact.pair.friction].
Friction read_coefficients(const Table& table) {
  Friction friction;
  friction_keys.read(table, friction);
  const bool has_dynamic = table.has("dynamic"), has_speed = table.has("stribeck_velocity");
  if (!has_dynamic) friction.dynamic_coefficient = friction.static_coefficient;
  if (has_speed && !has_dynamic)
    table.complain("dynamic",
                   "is missing: stribeck_velocity leads from static to dynamic: give it, or leave both out");
  if (!has_speed && friction.dynamic_coefficient != friction.static_coefficient)
    table.complain("stribeck_velocity",
                   fmt::format("is missing: give the sliding speed in m/s at which friction passes from "
                               "static = {:g} to dynamic = {:g}",
                               friction.static_coefficient, friction.dynamic_coefficient));
  return friction;
}

bool read_friction(const Table& table, const Key& key, Pair& pair) {
  Friction friction;
  if (table.has_table(key.name))
    friction = read_coefficients(*table.table(key.name, friction_keys));
  else if (double both = 0; table.read(key, both))
    friction = {both, both, 0};
  else
    return false;
  pair.friction = friction;
  if (friction.static_coefficient == 0 && friction.dynamic_coefficient == 0) pair.friction.reset();
  return true;
}

std::string friction_of(const Pair& pair) {
  if (!pair.friction) return "";
  const Friction& friction = *pair.friction;
  return friction.static_coefficient == friction.dynamic_coefficient && friction.stribeck_velocity == 0
             ? toml_number(friction.static_coefficient)
             : friction_keys.inline_table(friction);
}

template <Scheme scheme>
bool has(const Contact& contact) {
  return contact.scheme == scheme;
}

bool is_sampled(const Contact& contact) { return contact.kernel == ContactKernel::table; }

}  // namespace

const SectionOf<Pair> pair_keys{
    "[[contact.pair]]",
    "One table for each of several pairs. Keys that a pair does not give are taken from `[contact]`.",
    {{"between", Access(Type::texts, read_between, between_of), "", required(), any(),
      "names of two bodies, or of a body and an obstacle. \"Body a\" below is the first body. In "
      "`[contact]`, "
      "`\"all\"`: every body may meet every other one and every obstacle; needs [finite "
      "rotation](scene.md#bodies-that-turn)"},
     {"touch", Access(&Pair::touch).if_changed(), "", initial, any(),
      "false: the pair is an exception to `between = \"all\"`, and its surfaces pass through each other"},
     {"direction", direction<Pair>(&Pair::direction), "", none, any(),
      "the normal of every contact point: out of the first name in `between`, in world axes. Without it each "
      "point has the mutual normal (n_a − n_b)/|n_a − n_b|. Against an obstacle it must lie along the "
      "obstacle's normal and point towards the second name"},
     {"along", direction<Pair>(&Pair::along), "", none, any(),
      "merges all nodes of the contact surface on a line in this direction (world axes) into one candidate. "
      "Each line should meet the surface on one side of the body only"},
     {"spacing", &Pair::spacing, "m", none, above("0"),
      "smallest distance between candidates. Without it, every node of the contact surface is one"},
     {"gap", &Pair::gap, "m", none, at_least("0"),
      "moves body a along `direction` (or the mean normal) until the closest pair of contact points has this "
      "distance"},
     {"reach", &Pair::reach, "m", none, above("0"),
      "drops the pairs of points whose initial gap, after `gap`, is not below this distance. Kernels leave "
      "out the candidates that no pair needs"},
     {"zone", &Pair::zone, "m", std::string(none) + ", or chosen by `accuracy`", above("0"),
      "drops the pairs of points whose initial gap exceeds that of the closest pair by this distance or "
      "more, as `reach` does, wherever the bodies start"},
     {"friction", Access(Type::number_or_table, read_friction, friction_of), "1", none,
      from_to("0", "10", ": most dry surfaces have 0.1 to 1"),
      "Coulomb friction: its coefficient, or `[contact.friction]` with its parts. 0: frictionless. Needs "
      "`scheme = \"compliant\"` or `\"static\"` and `kernel = \"modes\"`. Not on rods, which move along "
      "their axis alone",
      "{ static = 0.4, dynamic = 0.3, stribeck_velocity = 0.01 }"}}};

const SectionOf<Friction> friction_keys{
    "[contact.friction]",
    "Friction that changes with the sliding speed v of a point: dynamic + (static − dynamic) · exp(−(v / "
    "stribeck_velocity)²). In a `[[contact.pair]]`: `friction = { static = …, dynamic = …, stribeck_velocity "
    "= … }`.",
    {{"static", &Friction::static_coefficient, "1", required(),
      from_to("0", "10", ": most dry surfaces have 0.1 to 1"), "coefficient of points that stick"},
     {"dynamic", &Friction::dynamic_coefficient, "1", "that of `static`",
      from_to("0", "10", ": most dry surfaces have 0.1 to 1"), "coefficient of points that slide fast"},
     {"stribeck_velocity", Access(&Friction::stribeck_velocity).if_changed(), "m/s", none, above("0"),
      "sliding speed of the transition; required if `dynamic` differs from `static`, otherwise unused"}}};

const SectionOf<Contact> contact_keys = SectionOf<Contact>{
    "[contact]",
    "",
    {{"kernel", choice<Contact>(&Contact::kernel, {"modes", "table"}), "", initial, any(),
      "`\"table\"`: unit-impulse responses are sampled at each step and convolved with forces"},
     {"table", Access(&Contact::table).only(is_sampled, "kernel = \"table\""), "", none, any(),
      "file of sampled responses, for `kernel = \"table\"` only. It replaces bodies, modes, pairs and loads, "
      "which must not be given"},
     {"scheme", choice<Contact>(&Contact::scheme, {"compliant", "impulse", "static"}), "", initial, any(),
      "contact law. `\"compliant\"`: forces with which no point penetrates at the end of a step. "
      "`\"impulse\"`: impulses on the points that touch. `\"static\"`: equilibrium under gravity, without "
      "time"},
     {"solver",
      choice<Contact>(&Contact::solver, {"exact", "uzawa"}).only(has<Scheme::at_rest>, "scheme = \"static\""),
      "", initial, any(),
      "`static` only. `uzawa`: iteration on the pressures, for comparison; without friction"},
     {"integration",
      choice<Contact>(&Contact::integration, {"conserving", "backward-euler"})
          .only(has<Scheme::compliant>, "scheme = \"compliant\""),
      "", initial, any(),
      "`compliant` only. `\"conserving\"`: the modes are driven by a mean of the forces at the last "
      "instants, with an error of second order. `\"backward-euler\"`: by the force at the end of the step; "
      "each change of force costs energy"},
     {"admittance",
      choice<Contact>(&Contact::admittance, {"jump", "difference"})
          .only(has<Scheme::impulse>, "scheme = \"impulse\""),
      "", initial, any(),
      "`impulse` only: velocity jump, or difference quotient over a step. `difference` needs ω_max · step < "
      "π"},
     {"instant",
      choice<Contact>(&Contact::instant, {"step", "exact"})
          .only(has<Scheme::impulse>, "scheme = \"impulse\""),
      "", initial, any(),
      "`impulse` only: contact at the end of the step, or (event location) at the instant at which a point "
      "closes"},
     {"restitution",
      Access<Contact>(&Contact::restitution).only(has<Scheme::impulse>, "scheme = \"impulse\""), "1", initial,
      from_to("0", "1"), "`impulse` only: coefficient of restitution"},
     {"max_pivots", Access<Contact>(&Contact::max_pivots).if_changed(), "", none, from_to("1", "1e9"),
      "bounds the work of a step, for real time: the number of changes of the active set. A step that is cut "
      "short may let points penetrate; the summary counts such steps"},
     {"increments",
      Access(&Contact::increments).if_changed().only(has<Scheme::at_rest>, "scheme = \"static\""), "",
      initial, from_to("1", "1e6"),
      "`static` with `friction` only: parts of the preload and of each stage from one time of a history to "
      "the next. Slip depends on the path, so more parts are more accurate"},
     {"pair", Type::tables, "", none, any(),
      "`[[contact.pair]]`, several pairs"}}}.with_keys_of(pair_keys);

namespace {

/// @param contact  with scheme, solver and kernel
void check_friction(const Table& table, const Contact& contact, const Pair& pair) {
  if (!pair.friction || !table.has("friction")) return;
  const auto refuse = [&](const char* with, const char* instead) {
    table.complain("friction",
                   fmt::format("is not possible with {}: set {}, or leave friction out", with, instead));
  };
  if (contact.scheme == Scheme::impulse) refuse("scheme = \"impulse\"", "scheme = \"compliant\"");
  if (contact.kernel == ContactKernel::table) refuse("kernel = \"table\"", "kernel = \"modes\"");
  if (contact.solver == Solver::uzawa) refuse("solver = \"uzawa\"", "solver = \"exact\"");
}

/// Reads the keys of one pair; missing keys keep their values in `pair`.
void read_pair(const Table& table, const Scene& scene, const Contact& contact, Pair& pair) {
  pair_keys.read(table, pair);
  check_friction(table, contact, pair);
  if (pair.a.empty()) return;
  if (pair.a == pair.b) table.complain("between", "must name two different bodies");
  std::vector<std::string> names = names_of(scene.bodies);
  for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  for (const std::string& name : {pair.a, pair.b})
    check_exists(table, "between", "body or obstacle", name, names);
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

/// Refuses the keys of pairs in a scene of sampled responses.
void refuse_pairs(const Table& table) {
  for (const Key& key : pair_keys.keys)
    if (table.has(key.name)) table.complain(key.name, replaced_by_table);
  if (table.has("pair")) table.complain("pair", replaced_by_table);
}

/// Adds each pair of bodies, and of a body and an obstacle, that is not listed, and removes the exceptions.
void add_all_pairs(const Scene& scene, const Pair& shared, std::vector<Pair>& pairs) {
  const std::vector<Pair> listed = pairs;
  const auto add = [&](const std::string& a, const std::string& b) {
    if (std::ranges::any_of(listed, [&](const Pair& pair) { return pair.names(a) && pair.names(b); })) return;
    Pair& pair = pairs.emplace_back(shared);
    pair.meets_all = false;
    pair.a = a;
    pair.b = b;
  };
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    for (std::size_t j = k + 1; j < scene.bodies.size(); ++j) add(scene.bodies[k].name, scene.bodies[j].name);
    for (const Obstacle& obstacle : scene.obstacles) add(scene.bodies[k].name, obstacle.name);
  }
  std::erase_if(pairs, [](const Pair& pair) { return !pair.touch; });
}

/// Reads the pairs. Returns whether one of them gives its friction.
bool read_pairs(const Table& table, const Scene& scene, Contact& contact) {
  Pair shared;
  read_pair(table, scene, contact, shared);
  if (!shared.touch) table.complain("touch", "belongs to a [[contact.pair]]: move it there");
  bool has_friction = table.has("friction");
  const bool all = shared.meets_all;
  for (const Table& entry : table.array("pair", pair_keys)) {
    Pair pair = shared;
    pair.meets_all = false;
    read_pair(entry, scene, contact, pair);
    has_friction = has_friction || entry.has("friction");
    if (pair.meets_all) entry.complain("between", "belongs to [contact]: name the two that may touch");
    if (pair.a.empty()) entry.complain("between", "is missing: name the two that may touch");
    if (!pair.touch && !all)
      entry.complain("touch", "is an exception to [contact] between = \"all\": remove the pair instead");
    contact.pairs.push_back(body_first(scene, pair));
  }
  if (all) {
    add_all_pairs(scene, shared, contact.pairs);
  } else if (contact.pairs.empty()) {
    if (shared.a.empty()) table.complain("between", "is missing: name the two that may touch");
    contact.pairs.push_back(body_first(scene, shared));
  }
  return has_friction;
}

}  // namespace

Contact read_contact(const Table& root, const Scene& scene) {
  Contact contact;
  const auto table = root.table("contact", contact_keys);
  if (!table) root.complain("contact", "is missing: give between = [\"body\", \"body\"]");
  contact_keys.read(*table, contact);
  const bool by_table = table->has("table");
  if (by_table && !contact.table.has_filename())
    table->complain("table", "must name a file of sampled responses");
  if (by_table) refuse_pairs(*table);
  const bool has_friction = !by_table && read_pairs(*table, scene, contact);
  if (table->has("increments") && !has_friction)
    table->complain("increments", "needs friction: add it, as in friction = 0.3, or leave this key out");
  return contact;
}

}  // namespace ricochet::scene
