// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/motion_source.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

/// About the centre of mass, world axes [kg m²].
Eigen::Matrix3d inertia_of(const Bodies::Block& block, const Pose& pose) {
  const Eigen::Matrix3d A = pose.attitude.toRotationMatrix();
  return A * block.own_inertia() * A.transpose();
}

}  // namespace

MotionSource::MotionSource(const Model& model)
    : places_(&model), gap_(&model.gap), area_(&model.area), rigid_(model) {
  for (std::size_t k = 0; k < model.bodies.size(); ++k)
    bodies_.push_back({model.bodies[k].name, model.bodies[k].mass, rigid_->modes(static_cast<int>(k)) > 0});
  for (const Model::PairBlock& pair : model.pairs)
    pairs_.push_back({pair.a, pair.b, pair.first_point, pair.points,
                      model.normal.middleRows(pair.first_point, pair.points),
                      bodies_[static_cast<std::size_t>(pair.a)].name,
                      pair.b < 0 ? pair.obstacle : bodies_[static_cast<std::size_t>(pair.b)].name,
                      pair.driven, pair.solid ? pair.solid->point : Vector3d(Vector3d::Zero())});
}

MotionSource::MotionSource(const Table& table, const Model* places)
    : places_(places), table_(&table), gap_(&table.gap), area_(&table.area) {
  for (const FreeBody& body : table.bodies) bodies_.push_back({body.name, body.mass, true});
  for (Index i = 0; i < gap_->size(); ++i) {
    std::vector<int> pushed;
    for (std::size_t k = 0; k < table.bodies.size(); ++k)
      if (!table.bodies[k].push.row(i).isZero(0)) pushed.push_back(static_cast<int>(k));
    if (pushed.empty()) continue;
    const int a = pushed.front(), b = pushed.size() > 1 ? pushed[1] : -1;
    auto pair = std::ranges::find_if(pairs_, [&](const Pair& known) { return known.a == a && known.b == b; });
    if (pair == pairs_.end())
      pair = pairs_.insert(pair, {a, b, 0, gap_->size(), Matrix::Zero(gap_->size(), 3),
                                  bodies_[static_cast<std::size_t>(a)].name,
                                  b < 0 ? "" : bodies_[static_cast<std::size_t>(b)].name});
    pair->normal.row(i) = -table.bodies[static_cast<std::size_t>(a)].push.row(i);
  }
}

Vector MotionSource::initial_state() const {
  if (const Model* const model = modes()) return model->initial_rates();
  Vector out(3 * std::ssize(bodies_));
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    out.segment<3>(3 * static_cast<Index>(k)) = table_->bodies[k].velocity;
  return out;
}

Eigen::Map<const Vector> MotionSource::state(const Stepper& stepper) const {
  if (modes()) return {stepper.modal()->v.data(), stepper.modal()->v.size()};
  return {stepper.body_velocities()->data(), stepper.body_velocities()->size()};
}

Vector3d MotionSource::momentum(int body, const Vector& state, double time) const {
  if (const Model* const model = modes()) return model->momentum(body, state, time);
  return bodies_[static_cast<std::size_t>(body)].mass * velocity(body, state);
}

Vector3d MotionSource::relative_velocity(const Pair& pair, const Vector& state, double time,
                                         const Vector3d& place) const {
  Vector3d out = velocity(pair.a, state);
  if (pair.b >= 0) out -= velocity(pair.b, state);
  return pair.driven ? Vector3d(out - pair.driven->velocity(time, place - pair.origin)) : out;
}

Vector3d MotionSource::velocity(int body, const Vector& state) const {
  return rigid_ ? rigid_->of(body, state).linear : Vector3d(state.segment<3>(3 * body));
}

std::optional<Vector3d> MotionSource::spin(int body, const Vector& state) const {
  constexpr Index of_solid = 6;
  if (!rigid_ || rigid_->modes(body) != of_solid) return std::nullopt;
  const Bodies::Block& block = places_->bodies[static_cast<std::size_t>(body)];
  return std::sqrt(block.inertia.trace() / (2 * block.mass)) * rigid_->of(body, state).rotation;
}

double MotionSource::rigid_energy(const Stepper& stepper) const {
  double sum = 0;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Block& block = places_->bodies[k];
    if (stepper.poses().empty()) {
      const auto rates = stepper.modal()->v.segment(block.first_mode, rigid_->modes(static_cast<int>(k)));
      sum += rates.squaredNorm() / 2;
    } else {
      const Pose& pose = stepper.poses()[k];
      sum +=
          (block.mass * pose.velocity.squaredNorm() + pose.spin.dot(inertia_of(block, pose) * pose.spin)) / 2;
    }
  }
  return sum;
}

Vector3d MotionSource::angular_momentum(int body, const Vector& state, double time,
                                        std::span<const Pose> poses) const {
  const Bodies::Block& block = places_->bodies[static_cast<std::size_t>(body)];
  if (poses.empty() || block.supported) return places_->angular_momentum(body, state, time);
  const Pose& pose = poses[static_cast<std::size_t>(body)];
  return inertia_of(block, pose) * pose.spin + block.mass * pose.position.cross(pose.velocity);
}

}  // namespace ricochet::contact
