// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "src/scene/keys.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

namespace {

bool is_decided(const Motion& motion) { return !motion.rotation_open; }

Access<Motion> rotation_access() {
  Access<Motion> out = choice<Motion>(&Motion::rotation, {"linear", "finite"});
  out.is_written = [](const void* motion) { return is_decided(*static_cast<const Motion*>(motion)); };
  return out;
}

}  // namespace

const SectionOf<Motion> rigid_motion_keys{
    "[motion]",
    "How free bodies move as a whole.",
    {{"rotation", rotation_access(), "", "[by the angle](scene.md#which-rotation) by which bodies turn",
      any(),
      "`\"linear\"`: rotations are small, and the points of a body move along their initial tangents. "
      "`\"finite\"`: bodies turn by any angle and [hit each other and obstacles with any part of their "
      "surface](scene.md#bodies-that-turn)"},
     {"second_run", Access(&Motion::second_run).if_changed(), "", initial, any(),
      "with finite rotation: whether a second run at the same time, with speeds larger by half a per cent "
      "and another step, finds out [when motions separate](scene.md#bodies-that-turn). Sweeps make none"}}};

namespace {

/// A key of the scene, and what to say about it.
struct Remark {
  std::string key, text;
};

/// The first key that fixes which points may touch, in [contact] or in a pair.
std::optional<std::string> choice_of_points(const Table& root) {
  const auto table = root.table("contact", contact_keys);
  if (!table) return std::nullopt;  // kernels alone
  const auto chosen = [](const Table& pair) -> const char* {
    for (const char* key : {"reach", "zone", "along"})
      if (pair.has(key)) return key;
    return nullptr;
  };
  if (const char* key = chosen(*table)) return fmt::format("contact.{}", key);
  const auto pairs = table->array("pair", pair_keys);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (const char* key = chosen(pairs[k])) return fmt::format("contact.pair[{}].{}", k, key);
  return std::nullopt;
}

/// The key that excludes finite rotations, and what to do about it; no value if there is none.
std::optional<Remark> exclusion(const Table& root, const Scene& scene) {
  if (scene.contact.kernel != ContactKernel::modes)
    return Remark{"contact.kernel", "finite rotation needs \"modes\": set it"};
  if (scene.contact.scheme != Scheme::compliant)
    return Remark{"contact.scheme", "finite rotation needs \"compliant\": set it"};
  if (const auto key = choice_of_points(root))
    return Remark{*key, "a body that turns may touch with any candidate: leave it out"};
  if (root.has("strikes")) return Remark{"strikes", "with finite rotation, there are none: leave it out"};
  for (const Obstacle& obstacle : scene.obstacles)
    if (scene.accuracy && leaves_its_surface(scene, obstacle))
      return Remark{"obstacles." + obstacle.name,
                    "with finite rotation, accuracy takes obstacles at rest: let it rest, or give "
                    "modes.up_to_hz or modes.count and accuracy = \"off\""};
  if (scene.time.precision == Precision::float32)
    return Remark{"time.precision", "finite rotation needs \"double\": leave it out"};
  return std::nullopt;
}

/// The key that linear rotations do not serve, and what to do without finite ones; no value if there is none.
std::optional<Remark> demand(const Table& root, const Scene& scene) {
  if (const auto table = root.table("contact", contact_keys)) {
    Pair shared;
    pair_keys.read(*table, shared);
    // With linear rotations, pairs are those of surfaces that face each other at the start.
    if (shared.meets_all) return Remark{"contact.between", "list the pairs"};
  }
  for (const Obstacle& obstacle : scene.obstacles)  // with linear rotations, points keep their pairs
    if (obstacle.angular_velocity != Vector3{})
      return Remark{fmt::format("obstacles.{}.angular_velocity", obstacle.name),
                    "leave angular_velocity out"};
  for (std::size_t k = 0; k < scene.loads.motions.size(); ++k) {
    const auto& [x, y, z] = scene.loads.motions[k].turn_deg;
    if (std::hypot(x, y, z) * std::numbers::pi / 180 > most_linear_turn)
      return Remark{fmt::format("loads.motion[{}].turn_deg", k), "turn the obstacle by at most 1 degree"};
  }
  if (const auto loads = root.table("loads", loads_keys))
    for (const LoadKind& kind : load_kinds) {
      const auto entries = loads->array(kind.name, kind.keys);
      for (std::size_t k = 0; k < entries.size(); ++k)
        if (entries[k].has("axes"))  // with linear rotations, no load turns
          return Remark{fmt::format("loads.{}[{}].axes", kind.name, k), "leave axes out"};
    }
  return std::nullopt;
}

/// Why only the mesh or the kernel of a body tells whether finite rotations move it; empty: they do.
std::string doubt(const Body& body) {
  if (body.imported()) return fmt::format("bodies.{} is imported", body.name);
  if (std::ranges::any_of(body.materials, [](const Material& material) { return material.area > 0; }))
    return fmt::format("bodies.{} is a rod", body.name);
  const bool clamped =
      std::ranges::any_of(body.support, [](const auto& support) { return support.second == "xyz"; });
  if (!body.support.empty() && !clamped) return fmt::format("bodies.{}.support may let it move", body.name);
  if (body.support.empty() && body.damping.law == Damping::Law::rayleigh && body.damping.first > 0)
    return fmt::format("bodies.{}.damping damps its motion as a whole", body.name);
  return "";
}

/// What the scene says against finite rotations; empty: nothing.
std::string against(const std::optional<Remark>& excluded, const Scene& scene) {
  if (excluded) return excluded->key + " excludes \"finite\"";
  for (const Body& body : scene.bodies)
    if (std::string doubted = doubt(body); !doubted.empty()) return doubted;
  return "";
}

/// A free body whose spin at the start turns it too far for linear rotations; empty: there is none. Without a
/// duration, as in a scene for kernels alone, any spin may.
std::string spinning(const Scene& scene) {
  for (const Body& body : scene.bodies) {
    const auto& [x, y, z] = body.angular_velocity;
    const double spin = std::hypot(x, y, z), turn = spin * scene.time.duration;
    if (!body.support.empty() || spin == 0) continue;
    if (scene.time.duration == 0) return fmt::format("bodies.{} spins", body.name);
    if (turn > most_linear_turn)
      return fmt::format("bodies.{} spins by {:.3g} degrees", body.name, turn * 180 / std::numbers::pi);
  }
  return "";
}

/// An obstacle with a surface that is displaced, over which points do not stay; empty: there is none.
std::string shifting(const Scene& scene) {
  for (const Obstacle& obstacle : scene.obstacles)
    if (!obstacle.is_half_space() && moves(scene, obstacle))
      return fmt::format("obstacles.{} moves", obstacle.name);
  return "";
}

bool may_turn(const Scene& scene) {
  const auto is_free = [](const Body& body) { return body.support.empty(); };
  return !scene.contact.pairs.empty() && std::ranges::any_of(scene.bodies, is_free);
}

}  // namespace

void read_motion(const Table& root, Scene& scene) {
  const auto table = root.table("motion", rigid_motion_keys);
  if (table) rigid_motion_keys.read(*table, scene.motion);
  const bool given = table && table->has("rotation");
  const auto excluded = exclusion(root, scene), demanded = demand(root, scene);
  if (excluded && given && scene.motion.is_finite())
    root.complain(excluded->key, excluded->text + ", or set motion.rotation = \"linear\"");
  if (demanded && given && !scene.motion.is_finite())
    root.complain(demanded->key,
                  fmt::format("needs motion.rotation = \"finite\": set it, or {}", demanded->text));
  if (demanded && excluded)
    root.complain(excluded->key, fmt::format("{}, or {}", excluded->text, demanded->text));

  const std::string linear = against(excluded, scene), shifts = shifting(scene),
                    finite = demanded         ? demanded->key + " needs it"
                             : shifts.empty() ? spinning(scene)
                                              : shifts;
  if (scene.motion.is_finite() || demanded || (!given && linear.empty() && !finite.empty())) {
    scene = with_finite_rotation(std::move(scene), finite);
  } else {
    scene.motion.reason = linear;
    scene.motion.rotation_open = !given && linear.empty() && may_turn(scene);
  }
}

}  // namespace ricochet::scene
