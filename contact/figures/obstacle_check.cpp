// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/obstacle_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/motion/driven_pose.hpp"

namespace ricochet::contact {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/// Closest points that are searched for a side, at most: a few seconds of work.
constexpr std::int64_t most_searches = 1'000'000;

/// Beyond an edge of a surface, the closest point is not opposite.
constexpr double opposite_share = 0.9;  // least cosine

constexpr double share_of_gap = 1e-2;  // of an element: difference of distances that does not count

/// Whether bodies are within a closed surface: its triangles then face inwards.
bool is_hollow(const WorldSurface& surface) {
  double volume = 0;
  for (const WorldSurface::Element& one : surface.element) {
    const auto at = [&](std::size_t j) { return surface.node[static_cast<std::size_t>(one.corner[j])]; };
    volume += at(0).dot(at(1).cross(at(2)));
  }
  return volume < 0;
}

using Points = Eigen::Map<const Matrix3Xd>;

Points points(const std::vector<double>& values) {
  return {values.data(), 3, static_cast<Eigen::Index>(values.size() / 3)};
}

}  // namespace

ObstacleCheck::ObstacleCheck(const Model& model) : model_(model), passages_(model) {
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    const Bodies::Block& body = model.bodies[pair.a];
    if (pair.b >= 0 || pair.points == 0 || body.kernel->outline.empty()) continue;
    Side side;
    side.pair = static_cast<int>(p);
    side.normal = -model.normal.row(pair.first_point).transpose();
    side.on = model.point_b.row(pair.first_point).transpose();
    const auto in_world = [&](const Points& own) -> Matrix3Xd {
      return (body.rotation * own).colwise() + body.translation;
    };
    const Points outline = points(body.kernel->outline);
    const kernels::Surface& surface = body.kernel->surface;
    const Points nodes = points(surface.whole ? surface.whole->node : surface.node);
    side.outline.resize(3, outline.cols() + nodes.cols());
    side.outline << in_world(outline), in_world(nodes);
    side.point = model.point_a.middleRows(pair.first_point, pair.points).transpose();
    const double size = pair.apart ? pair.apart->element
                                   : (outline.rowwise().maxCoeff() - outline.rowwise().minCoeff()).norm();
    side.least =
        share_of_element * size + times_bulge * model.bulge.segment(pair.first_point, pair.points).maxCoeff();
    if (pair.solid) {
      side.surface.emplace(*pair.solid->surface);
      for (const Vector3d& x : pair.solid->surface->node) side.box.extend(x);
      side.holds = is_hollow(*pair.solid->surface);
      side.place = {.position = pair.solid->point, .attitude = Eigen::Quaterniond(pair.solid->rotation)};
    }
    sides_.push_back(std::move(side));
  }
}

void ObstacleCheck::observe(const std::vector<RigidMotion>& motions, double time) {
  passages_.observe(motions, time);
  for (Side& side : sides_) {
    const RigidMotion& motion = motions[static_cast<std::size_t>(model_.pairs[side.pair].a)];
    side.surface ? observe_surface(side, motion, time) : observe_plane(side, motion, time);
  }
}

void ObstacleCheck::observe_plane(Side& side, const RigidMotion& motion, double time) {
  const Model::PairBlock& pair = model_.pairs[side.pair];
  // The height of x + linear + turn (x − centre)
  const Vector3d turn = motion.turn.transpose() * side.normal, slope = side.normal + turn,
                 on = pair.driven ? Vector3d(side.on + pair.driven->shift(time)) : side.on;
  const double rise = side.normal.dot(motion.linear - on) - turn.dot(motion.centre);
  Eigen::Index lowest = 0;
  const double height = (slope.transpose() * side.outline).minCoeff(&lowest) + rise;
  if (-height <= side.least + side.deepest) return;
  const double points = (slope.transpose() * side.point).minCoeff() + rise;
  if (-height <= side.least - times_approach * std::min(0.0, points)) return;
  side.deepest = -height - side.least;
  side.time = time;
  side.at = side.outline.col(lowest);
}

/// Looks as often as the body has moved by the depth that does not count.
void ObstacleCheck::observe_surface(Side& side, const RigidMotion& motion, double time) {
  const Model::PairBlock& pair = model_.pairs[side.pair];
  const Pose pose = pair.driven ? driven_pose(*pair.driven, side.place, time) : side.place;
  const Eigen::Matrix3d axes = pose.attitude.toRotationMatrix();
  const auto in_axes = [&](const Matrix3Xd& x) -> Matrix3Xd {
    return axes.transpose() *
           ((x + motion.turn * (x.colwise() - motion.centre)).colwise() + (motion.linear - pose.position));
  };
  const Eigen::AlignedBox3d around(side.outline.rowwise().minCoeff(), side.outline.rowwise().maxCoeff());
  Matrix3Xd corners(3, 8);
  for (int k = 0; k < 8; ++k) corners.col(k) = around.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
  corners = in_axes(corners);
  if (side.looked_at.size() > 0 && (corners - side.looked_at).colwise().norm().maxCoeff() < side.least)
    return;
  side.looked_at = corners;
  const auto depth = [&](const Vector3d& x) {
    if ((!side.holds && !side.box.contains(x)) || side.searches == most_searches) return 0.0;
    ++side.searches;
    const auto y = side.surface->closest(x);
    if (!y) return 0.0;
    const double below = y->normal.dot(y->point - x);
    return below > opposite_share * (x - y->point).norm() ? below : 0.0;
  };
  double deepest = side.least + side.deepest, points = 0;
  Eigen::Index at = -1;
  const Matrix3Xd outline = in_axes(side.outline);
  for (Eigen::Index k = 0; k < outline.cols(); ++k)
    if (const double here = depth(outline.col(k)); here > deepest) {
      deepest = here;
      at = k;
    }
  if (at < 0) return;
  const Matrix3Xd touching = in_axes(side.point);
  for (Eigen::Index k = 0; k < touching.cols(); ++k) points = std::max(points, depth(touching.col(k)));
  if (deepest <= side.least + times_approach * points) return;
  side.deepest = deepest - side.least;
  side.time = time;
  side.at = side.outline.col(at);
}

std::vector<std::string> ObstacleCheck::warnings() const {
  std::vector<std::string> out;
  for (const Model::PairBlock& pair : model_.pairs) {
    if (!pair.apart || pair.points == 0 || pair.summits > 0) continue;  // curved surfaces touch between nodes
    const double late = pair.initial_gap - pair.apart->distance;
    if (late <= share_of_gap * pair.apart->element) continue;
    const std::string& a = model_.bodies[pair.a].name;
    const std::string& b = pair.b < 0 ? pair.obstacle : model_.bodies[pair.b].name;
    out.push_back(fmt::format(
        "{} and {} start {:.3g} m apart, but their closest contact points {:.3g} m, so they touch late by "
        "{:.2g} of "
        "an element ({:.3g} m). Use smaller elements where they meet (bodies.{}.geometry, contact.spacing)",
        a, b, pair.apart->distance, pair.initial_gap, late / pair.apart->element, late, a));
  }
  for (const Side& side : sides_) {
    if (side.deepest == 0) continue;
    const Model::PairBlock& pair = model_.pairs[side.pair];
    const std::string& body = model_.bodies[pair.a].name;
    out.push_back(
        fmt::format("{} passes {:.3g} m through {} at t = {:.4g} s, with a part that has no contact points: "
                    "its point that "
                    "starts at [{:.4g}, {:.4g}, {:.4g}]. Name the surface there in bodies.{}.contact",
                    body, side.deepest + side.least, pair.obstacle, side.time, side.at.x(), side.at.y(),
                    side.at.z(), body));
  }
  for (std::string& warning : passages_.warnings()) out.push_back(std::move(warning));
  return out;
}

}  // namespace ricochet::contact
