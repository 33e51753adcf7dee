// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/strikes.hpp"

#include <algorithm>
#include <cmath>

#include "src/scene/keys.hpp"
#include "src/scene/near_miss.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

const SectionOf<Strike> strike_keys{
    "[[strikes]]",
    "A blow by a mallet: a free body, which need not be given again for each blow. It is at its place at the "
    "time of the strike, and flies freely before and after it; `gap` and `reach` of its pairs hold for each "
    "strike. Mallets do not touch each other. Not with `accuracy`, sampled responses or bodies at rest.",
    {{"mallet", &Strike::mallet, "", required("name the body that strikes"), any(),
      "name of a body without supports, receivers, gauges and loads"},
     {"time", &Strike::time, "s", required(), at_least("0"),
      "time at which the mallet is at its place; it touches when it has crossed the rest of its gap"},
     {"speed", &Strike::speed, "m/s", "that of the mallet's `velocity`", above("0"),
      "its speed at this time"},
     {"direction", direction<Strike>(&Strike::direction), "", "that of the mallet's `velocity`", any(),
      "direction of its velocity, in world axes"},
     {"translate", &Strike::translate, "m", "that of the mallet", any(), "its place, as for bodies"},
     {"rotate_deg", &Strike::rotate_deg, "degrees", "that of the mallet", any(),
      "its orientation, as for bodies"}}};

namespace {

/// Throws InputError if a scene of this kind has no strikes.
void check_scene(const Table& table, const Scene& scene) {
  if (scene.contact.scheme == Scheme::at_rest)
    table.complain("", "bodies at rest strike nothing: leave it out, or choose another contact.scheme");
  if (scene.contact.kernel == ContactKernel::table)
    table.complain("", "sampled responses know no strikes: leave it out, or set contact.kernel = \"modes\"");
  if (scene.accuracy)
    table.complain("",
                   "errors of several strikes are not estimated: leave it out, or give [modes] and set "
                   "accuracy = \"off\"");
}

/// Throws InputError if the body cannot be a mallet.
void check_mallet(const Table& table, const Body& body, const Scene& scene) {
  if (!body.support.empty())
    table.complain("mallet",
                   fmt::format("bodies.{} has a support, so it cannot fly: name a free body", body.name));
  if (body.angular_velocity != Vector3{})
    table.complain(
        "mallet",
        fmt::format("bodies.{}.angular_velocity would turn it before the strike: leave it out", body.name));
  const auto on_mallet = [&](const auto& all) {
    return std::ranges::any_of(all, [&](const auto& one) { return one.body == body.name; });
  };
  if (on_mallet(scene.output.receivers) || on_mallet(scene.output.gauges) ||
      on_mallet(scene.loads.tractions) || on_mallet(scene.loads.points))
    table.complain(
        "mallet",
        fmt::format("bodies.{} has a receiver, a gauge or a load, which a mallet cannot have: leave "
                    "it out",
                    body.name));
  for (const Pair& pair : scene.contact.pairs)
    if (pair.b == body.name && pair.gap)
      table.complain(
          "mallet",
          fmt::format("its gap would move \"{}\", the first name in contact.between: name the mallet "
                      "first",
                      pair.a));
}

/// Gives the strike the values of the mallet in place of keys that are missing.
void complete(const Table& table, const Body& mallet, Strike& strike) {
  const Vector3& v = mallet.velocity;
  const double own_speed = std::hypot(v[0], v[1], v[2]);
  for (const char* key : {"speed", "direction"})
    if (!table.has(key) && !(own_speed > 0))
      table.complain(key, fmt::format("is missing: give it, or bodies.{}.velocity", mallet.name));
  if (!table.has("speed")) strike.speed = own_speed;
  if (!table.has("direction")) strike.direction = {v[0] / own_speed, v[1] / own_speed, v[2] / own_speed};
  if (!table.has("translate")) strike.translate = mallet.translate;
  if (!table.has("rotate_deg")) strike.rotate_deg = mallet.rotate_deg;
}

void set_strike(Body& body, const Strike& strike) {
  body.arrival = strike.time;
  body.translate = strike.translate;
  body.rotate_deg = strike.rotate_deg;
  for (std::size_t k = 0; k < 3; ++k) body.velocity[k] = strike.speed * strike.direction[k];
}

/// Adds a copy of the mallet, named after the number of its strike, with copies of its pairs.
void add_copy(Scene& scene, const Body& mallet, const Strike& strike, std::size_t number) {
  Body copy = mallet;
  copy.copy_of = mallet.name;
  copy.name += fmt::format(".{}", number);
  set_strike(copy, strike);
  std::vector<Pair> pairs;
  for (Pair pair : scene.contact.pairs) {
    if (!pair.names(mallet.name)) continue;
    (pair.a == mallet.name ? pair.a : pair.b) = copy.name;
    pairs.push_back(pair);
  }
  scene.contact.pairs.insert(scene.contact.pairs.end(), pairs.begin(), pairs.end());
  scene.bodies.push_back(std::move(copy));
}

}  // namespace

void read_strikes(const Table& root, Scene& scene) {
  const std::vector<Body> mallets = scene.bodies;
  for (const Table& table : root.array("strikes", strike_keys)) {
    check_scene(table, scene);
    Strike strike;
    strike_keys.read(table, strike);
    const std::string& name = strike.mallet;
    check_exists(table, "mallet", "body", name, names_of(mallets));
    const auto mallet = std::ranges::find(mallets, name, &Body::name);
    check_mallet(table, *mallet, scene);
    complete(table, *mallet, strike);
    if (scene.time.duration > 0 && !(strike.time < scene.time.duration))
      table.complain("time",
                     fmt::format("is not before the end, {} = {:g}: lengthen the run, or leave this strike "
                                 "out",
                                 scene.time.key_of_duration(), scene.time.duration));
    const auto before = std::ranges::count(scene.strikes, name, &Strike::mallet);
    if (before > 0)
      add_copy(scene, *mallet, strike, static_cast<std::size_t>(before) + 1);
    else
      set_strike(scene.bodies[static_cast<std::size_t>(mallet - mallets.begin())], strike);
    scene.strikes.push_back(strike);
  }
}

}  // namespace ricochet::scene
