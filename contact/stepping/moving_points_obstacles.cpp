// SPDX-License-Identifier: BSD-2-Clause
// The obstacles that points meet, and how they move.
#include <algorithm>

#include "contact/motion/driven_pose.hpp"
#include "contact/stepping/moving_points.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

/// Pairs with the same obstacle share its surface.
void MovingPoints::add_solids(const MovingPoints* earlier) {
  for (const Model::PairBlock& pair : pairs_) {
    if (!pair.solid || solid_of(pair) >= 0) continue;
    const Obstacle& solid = *pair.solid;
    std::shared_ptr<const BodySurface> surface;
    for (const MovingPoints* known : {static_cast<const MovingPoints*>(this), earlier}) {
      if (known == nullptr) continue;
      for (const Solid& one : known->solids_)
        if (one.obstacle->surface == solid.surface) surface = one.surface;
    }
    if (!surface) surface = std::make_shared<const BodySurface>(*solid.surface);
    const Pose start{.position = solid.point, .attitude = Eigen::Quaterniond(solid.rotation)};
    solids_.push_back(
        {pair.solid, std::move(surface), FloatingBody(start), pair.driven, start, start, start});
    for (const Vector3d& x : solids_.back().surface->surface().node)
      solids_.back().radius = std::max(solids_.back().radius, x.norm());
    solids_.back().radius += solids_.back().surface->camber();
  }
}

void MovingPoints::Solid::move_to(const Pose& pose) noexcept {
  state.position = pose.position;
  state.attitude = pose.attitude;
  state.axes = pose.attitude.toRotationMatrix();
}

Vector3d MovingPoints::Solid::moved(const Vector3d& place) const noexcept {
  if (!motion) return Vector3d::Zero();
  const Vector3d own = state.axes.transpose() * (place - state.position);
  return to.at(own) - from.at(own);
}

void MovingPoints::move_obstacles(double time) noexcept {
  for (Solid& solid : solids_)
    if (solid.motion) solid.move_to(driven_pose(*solid.motion, solid.start, time));
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (const Model::PairBlock& pair = pairs_[k]; pair.driven && pair.is_half_space())
      drives_[k].raise =
          points_[static_cast<std::size_t>(pair.first_point)].row.row(0).dot(pair.driven->shift(time));
}

void MovingPoints::drive_obstacles(double from, double to) noexcept {
  move_obstacles(0.5 * (from + to));
  for (Solid& solid : solids_) {
    if (!solid.motion) continue;
    solid.from = driven_pose(*solid.motion, solid.start, from);
    solid.to = driven_pose(*solid.motion, solid.start, to);
  }
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Model::PairBlock& pair = pairs_[k];
    if (!pair.driven) continue;
    drives_[k].farthest = (to - from) * obstacle_speed(k, from, to);
    if (pair.is_half_space())
      drives_[k].rises = points_[static_cast<std::size_t>(pair.first_point)].row.row(0).dot(
          pair.driven->shift(to) - pair.driven->shift(from));
  }
}

bool MovingPoints::obstacles_move(double from, double to) const noexcept {
  return std::ranges::any_of(
      pairs_, [&](const Model::PairBlock& pair) { return pair.driven && pair.driven->moves(from, to); });
}

double MovingPoints::obstacle_speed(std::size_t pair, double from, double to) const noexcept {
  const Model::PairBlock& of = pairs_[pair];
  if (!of.driven) return 0;
  const int solid = solid_of(of);
  return of.driven->speed(from, to, solid < 0 ? 0 : solids_[static_cast<std::size_t>(solid)].radius);
}

void MovingPoints::set_obstacle_travels(double from, double to) noexcept {
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    drives_[k].travel = (to - from) * obstacle_speed(k, from, to);
}

int MovingPoints::solid_of(const Model::PairBlock& pair) const noexcept {
  if (!pair.solid) return -1;
  const auto found = std::ranges::find(
      solids_, pair.solid->name, [](const Solid& one) -> const std::string& { return one.obstacle->name; });
  return found == solids_.end() ? -1 : static_cast<int>(found - solids_.begin());
}

}  // namespace ricochet::contact
