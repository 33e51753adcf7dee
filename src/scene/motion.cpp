// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/motion.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "src/scene/keys.hpp"
#include "src/scene/loads.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::scene {

const SectionOf<Motion> rigid_motion_keys{
    "[motion]",
    "How free bodies move as a whole.",
    {{"rotation", choice<Motion>(&Motion::rotation, {"linear", "finite"}).if_changed(), "", initial, any(),
      "`\"linear\"`: rotations are small, and the points of a body move along their initial tangents. "
      "`\"finite\"`: bodies turn by any angle and [hit each other and obstacles with any part of their "
      "surface](scene.md#bodies-that-turn)"},
     {"second_run", Access(&Motion::second_run).if_changed(), "", initial, any(),
      "with finite rotation: whether a second run at the same time, with speeds larger by half a per cent "
      "and another step, finds out [when motions separate](scene.md#bodies-that-turn). Sweeps make none"}}};

namespace {

[[noreturn]] void refuse(const Table& table, const std::string& key, const std::string& what) {
  table.complain(key, what + ", or set motion.rotation = \"linear\"");
}

/// Refuses the keys of a table of pairs that fix which points may touch.
void refuse_choice_of_points(const Table& table) {
  for (const char* key : {"reach", "zone", "along"})
    if (table.has(key)) refuse(table, key, "a body that turns may touch with any candidate: leave it out");
}

void check_contact(const Table& root, const Scene& scene) {
  const Contact& contact = scene.contact;
  if (contact.kernel != ContactKernel::modes)
    refuse(root, "contact.kernel", "finite rotation needs \"modes\": set it");
  if (contact.scheme != Scheme::compliant)
    refuse(root, "contact.scheme", "finite rotation needs \"compliant\": set it");
  const auto table = root.table("contact", contact_keys);
  if (!table) return;  // kernels alone
  refuse_choice_of_points(*table);
  for (const Table& entry : table->array("pair", pair_keys)) refuse_choice_of_points(entry);
}

/// With linear rotations, pairs are those of surfaces that face each other at the start.
void refuse_all_pairs(const Table& root) {
  const auto table = root.table("contact", contact_keys);
  Pair shared;
  if (table) pair_keys.read(*table, shared);
  if (shared.meets_all)
    table->complain("between", "needs [motion] rotation = \"finite\": add it, or list the pairs");
}

/// With linear rotations, no load turns.
void refuse_axes(const Table& root) {
  const auto loads = root.table("loads", loads_keys);
  if (!loads) return;
  for (const LoadKind& kind : load_kinds)
    for (const Table& entry : loads->array(kind.name, kind.keys))
      if (entry.has("axes"))
        entry.complain("axes", "needs [motion] rotation = \"finite\": add it, or leave axes out");
}

/// Refuses single precision, and loads on a body whose free flight leads it to the first touch, which
/// accuracy serves.
void check_settings(const Table& root, const Scene& scene) {
  const Loads& loads = scene.loads;
  if (scene.accuracy && !(loads.tractions.empty() && loads.points.empty() && loads.motions.empty()))
    refuse(root, "loads",
           "with finite rotation, accuracy allows gravity only: leave the other loads out, or give "
           "modes.up_to_hz or modes.count and accuracy = \"off\"");
  if (scene.time.precision == Precision::float32)
    refuse(root, "time.precision", "finite rotation needs \"double\": leave it out");
}

}  // namespace

void read_motion(const Table& root, Scene& scene) {
  if (const auto table = root.table("motion", rigid_motion_keys))
    rigid_motion_keys.read(*table, scene.motion);
  if (!scene.motion.is_finite()) {
    refuse_all_pairs(root);
    refuse_axes(root);
    return;
  }
  check_contact(root, scene);
  if (root.has("strikes")) refuse(root, "strikes", "with finite rotation, there are none: leave it out");
  check_settings(root, scene);
  scene.time.precision_by_accuracy = false;
}

}  // namespace ricochet::scene
