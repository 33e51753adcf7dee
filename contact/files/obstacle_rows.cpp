// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/obstacle_rows.hpp"

#include "base/format.hpp"

namespace ricochet::contact {
namespace {

std::span<const double> numbers(const auto& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// Calls `each` with the obstacles that a result shows, and with their groups.
void for_each_shown(std::span<const ObstacleSurface> obstacles, const auto& each) {
  int number = 0;
  for (const ObstacleSurface& one : obstacles)
    if (!one.is_half_space || one.driven) each(one, base::format("/obstacles/{}", ++number));
}

}  // namespace

void write_obstacles(base::hdf5::Writer& file, std::span<const ObstacleSurface> obstacles) {
  for_each_shown(obstacles, [&](const ObstacleSurface& one, const std::string& group) {
    file.group(group);
    file.attribute(group, "name", one.name);
    const Matrix rotation = one.start.attitude.toRotationMatrix();
    file.attribute(group, "rotation", numbers(rotation));
    file.attribute(group, "translation", numbers(one.start.position));
    if (one.is_half_space) return;
    file.write<double>(group + "/node", numbers(one.node), {static_cast<std::size_t>(one.node.rows()), 3},
                       "m");
    file.write<std::int64_t>(group + "/element", one.element, {one.element.size() / 3, 3}, "1");
  });
}

ObstacleRows::ObstacleRows(base::hdf5::Writer& file, std::span<const ObstacleSurface> obstacles,
                           const std::string& below) {
  for_each_shown(obstacles, [&](const ObstacleSurface& one, const std::string& group) {
    if (one.driven) moving_.push_back({one.start, one.driven, PoseRows(file, group + below)});
  });
}

void ObstacleRows::append(double time) const {
  for (const Moving& one : moving_) one.rows.append(driven_pose(*one.driven, one.start, time));
}

}  // namespace ricochet::contact
