// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/obstacle_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace ricochet::contact {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

constexpr double share_of_gap = 1e-2;  // of an element: difference of distances that does not count

using Points = Eigen::Map<const Matrix3Xd>;

Points points(const std::vector<double>& values) {
  return {values.data(), 3, static_cast<Eigen::Index>(values.size() / 3)};
}

}  // namespace

ObstacleCheck::ObstacleCheck(const Model& model) : model_(model), passages_(model) {
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    const Bodies::Block& body = model.bodies[pair.a];
    if (!pair.is_half_space() || pair.points == 0 || body.kernel->outline.empty()) continue;
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
    sides_.push_back(std::move(side));
  }
}

void ObstacleCheck::observe(const std::vector<RigidMotion>& motions, double time) {
  passages_.observe(motions, time);
  for (Side& side : sides_) {
    const Model::PairBlock& pair = model_.pairs[side.pair];
    const RigidMotion& motion = motions[pair.a];
    // The height of x + linear + turn (x − centre)
    const Vector3d turn = motion.turn.transpose() * side.normal, slope = side.normal + turn;
    const double rise = side.normal.dot(motion.linear - side.on) - turn.dot(motion.centre);
    Eigen::Index lowest = 0;
    const double height = (slope.transpose() * side.outline).minCoeff(&lowest) + rise;
    if (-height <= side.least + side.deepest) continue;
    const double points = (slope.transpose() * side.point).minCoeff() + rise;
    if (-height <= side.least - times_approach * std::min(0.0, points)) continue;
    side.deepest = -height - side.least;
    side.time = time;
    side.at = side.outline.col(lowest);
  }
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
