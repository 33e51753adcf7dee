// SPDX-License-Identifier: BSD-2-Clause
#include "contact/output/obstacle_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/output/linearity_check.hpp"

namespace ricochet::contact {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

constexpr double share_of_size = 1e-3;  // of the largest distance in the outline: meshes of curved surfaces
constexpr double times_approach = 2;    // that of the candidates

using Points = Eigen::Map<const Matrix3Xd>;

Points points(const std::vector<double>& values) {
  return {values.data(), 3, static_cast<Eigen::Index>(values.size() / 3)};
}

}  // namespace

ObstacleCheck::ObstacleCheck(const Model& model) : model_(model) {
  for (const Model::BodyBlock& body : model.bodies) inverse_inertia_.push_back(pseudo_inverse(body.inertia));
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    const Model::BodyBlock& body = model.bodies[pair.a];
    if (pair.b >= 0 || pair.points == 0 || body.kernel->outline.empty()) continue;
    Side side;
    side.pair = static_cast<int>(p);
    side.normal = -model.normal.row(pair.first_point).transpose();
    side.on = model.point_b.row(pair.first_point).transpose();
    const auto in_world = [&](const Points& own) -> Matrix3Xd {
      return (body.rotation * own).colwise() + body.translation;
    };
    const Points outline = points(body.kernel->outline);
    side.outline = in_world(outline);
    const kernels::Surface& surface = body.kernel->surface;
    side.candidate = in_world(points(surface.whole ? surface.whole->node : surface.node));
    side.least = share_of_size * (outline.rowwise().maxCoeff() - outline.rowwise().minCoeff()).norm();
    sides_.push_back(std::move(side));
  }
}

void ObstacleCheck::observe(const Vector& q, double time) {
  for (Side& side : sides_) {
    const Model::PairBlock& pair = model_.pairs[side.pair];
    const RigidMotion motion = rigid_motion(model_.bodies[pair.a], inverse_inertia_[pair.a], q);
    // The height of x + linear + rotation × (x − centre): n·(rotation × x) = (n × rotation)·x
    const Vector3d turn = side.normal.cross(motion.rotation), slope = side.normal + turn;
    const double rise = side.normal.dot(motion.linear - side.on) - turn.dot(motion.centre);
    Eigen::Index lowest = 0;
    const double height = (slope.transpose() * side.outline).minCoeff(&lowest) + rise;
    if (-height <= side.least + side.deepest) continue;
    const double candidates = (slope.transpose() * side.candidate).minCoeff() + rise;
    if (-height <= side.least - times_approach * std::min(0.0, candidates)) continue;
    side.deepest = -height - side.least;
    side.time = time;
    side.at = side.outline.col(lowest);
  }
}

std::vector<std::string> ObstacleCheck::warnings() const {
  std::vector<std::string> out;
  for (const Side& side : sides_) {
    if (side.deepest == 0) continue;
    const Model::PairBlock& pair = model_.pairs[side.pair];
    const std::string& body = model_.bodies[pair.a].name;
    out.push_back(fmt::format(
        "{} passes {:.3g} m through {} at t = {:.4g} s, with a part that has no candidates: its point that "
        "starts at [{:.4g}, {:.4g}, {:.4g}]. Name the surface there in bodies.{}.contact",
        body, side.deepest + side.least, pair.obstacle, side.time, side.at.x(), side.at.y(), side.at.z(),
        body));
  }
  return out;
}

}  // namespace ricochet::contact
