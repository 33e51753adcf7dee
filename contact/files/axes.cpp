// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/axes.hpp"

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace ricochet::contact {
namespace {

using Scales = std::vector<std::string>;

/// A reader of netCDF finds the scales of a group in the group itself and in those above it. Scales without
/// values that several groups share are therefore in the root.
namespace shared {
constexpr const char *component = "/component", *candidate = "/candidate", *snapshot = "/snapshot",
                     *quaternion = "/quaternion";
}  // namespace shared

/// The parts of the path "/a/b/c".
std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> out;
  for (std::size_t from = 1, to = 0; to != std::string::npos; from = to + 1)
    out.push_back(path.substr(from, (to = path.find('/', from)) == std::string::npos ? to : to - from));
  return out;
}

/// Of /contact. Its rows have other times than those of the state, of which only the power of contact has one
/// here; a second dimension named time would hide the first.
Scales of_contact(const std::string& name, bool turns) {
  const std::string time = "/contact/time", entry = "/contact/entry";
  const auto is = [&](std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
  };
  if (is({"time", "first"})) return {time};
  if (is({"persistency"})) return {"/contact/sample"};
  if (is({"initial_gap", "area", "pair"})) return {shared::candidate};
  if (is({"point_a", "point_b", "normal"})) return {shared::candidate, shared::component};
  if (is({"side_a", "side_b"})) return {"/contact/number_of_pair"};
  Scales out = turns ? Scales{entry} : Scales{time, shared::candidate};
  if (is({"place", "normal_now", "tangential_force", "tangential_displacement"}))
    out.push_back(shared::component);
  return out;
}

/// Of a pose, by the scale of its times.
Scales of_pose(const std::string& time, const std::string& name) {
  return {time, name == "attitude" ? shared::quaternion : shared::component};
}

/// Of /obstacles/NUMBER: a surface, and poses at the times of rows and of snapshots.
Scales of_obstacle(const std::vector<std::string>& parts) {
  const std::string group = "/obstacles/" + parts[1], &name = parts.back();
  if (name == "node") return {group + "/vertex", shared::component};
  if (name == "element") return {group + "/triangle", group + "/corner"};
  return of_pose(parts[2] == "pose" ? shared::snapshot : "/time", name);
}

/// Of /static/BODY, forces and loads at the times of snapshots.
Scales of_static(const std::string& group, const std::string& name) {
  const std::string entry = group + "/entry";
  if (name == "force") return {entry, group + "/row"};
  if (name == "load") return {shared::snapshot, group + "/applied", shared::component};
  if (name == "motion") return {shared::snapshot, group + "/support", shared::component};
  return {entry};
}

Scales scales_of(const std::string& dataset, bool turns) {
  const std::vector<std::string> parts = parts_of(dataset);
  const std::string &group = parts.front(), &last = parts.back();
  if (last == "time" && parts.size() <= 2) return {dataset};
  if (group == "energy") return {"/time"};
  if (group == "contact") return of_contact(last, turns);
  if (group == "bodies") return of_pose("/time", last);
  if (group == "receivers") return {"/receivers/time", shared::component};
  if (group == "gauges")
    return last == "stress" ? Scales{"/gauges/time", "/stress_component"} : Scales{"/gauges/time"};
  if (group == "snapshots") return {"/snapshots/time", "/mode_" + last};
  if (group == "pose") return of_pose(shared::snapshot, last);
  if (group == "static") return of_static("/static/" + parts[1], last);
  if (group == "obstacles") return of_obstacle(parts);
  return {"/node_" + parts[1]};  // /stress/BODY
}

/// Of a motion, by the surface of a body, an obstacle or a pair, KIND/NAME.
Scales scales_of_motion(const std::string& dataset) {
  const std::vector<std::string> parts = parts_of(dataset);
  if (parts.size() == 1) return {dataset};  // time
  const std::string group = "/" + parts[0] + "/" + parts[1], &quantity = parts[2];
  if (quantity == "element") return {group + "/facet", group + "/corner"};
  const std::string node = group + (parts[0] == "contact" ? "/candidate" : "/node");
  const auto vectors = {"position", "deformation", "velocity", "push"};
  return std::ranges::find(vectors, quantity) != vectors.end() ? Scales{node, shared::component}
                                                               : Scales{node};
}

void name(base::hdf5::Writer& file, const std::function<Scales(const std::string&)>& scales) {
  const auto datasets = file.datasets();  // a copy: scales are added
  for (const auto& dataset : datasets) file.name_dimensions(dataset, scales(dataset.name));
}

}  // namespace

void name_axes(base::hdf5::Writer& file, bool turns) {
  name(file, [turns](const std::string& dataset) { return scales_of(dataset, turns); });
}

void name_axes_of_motion(base::hdf5::Writer& file) { name(file, scales_of_motion); }

}  // namespace ricochet::contact
