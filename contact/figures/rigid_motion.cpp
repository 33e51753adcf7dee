// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/rigid_motion.hpp"

#include <Eigen/Eigenvalues>

namespace ricochet::contact {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Matrix3d pseudo_inverse(const Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(inertia);
  Vector3d inverse = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    if (eigen.eigenvalues()(k) > 1e-9 * eigen.eigenvalues()(2)) inverse(k) = 1 / eigen.eigenvalues()(k);
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

Vector3d relative_at(const std::vector<RigidMotion>& motion, const Model::PairBlock& pair, Eigen::Index i,
                     const RowFrames& frames) {
  Vector3d out = motion[static_cast<std::size_t>(pair.a)].at(frames.point_a.row(i).transpose());
  if (pair.b >= 0) out -= motion[static_cast<std::size_t>(pair.b)].at(frames.point_b.row(i).transpose());
  return out;
}

RigidMotions::RigidMotions(const Model& model) : model_(model) {
  for (const Bodies::Block& body : model.bodies)
    bodies_.push_back({(model.omega.segment(body.first_mode, body.modes).array() == 0).count(),
                       pseudo_inverse(body.inertia)});
}

std::vector<RigidMotion> RigidMotions::of(const Vector& state) const {
  std::vector<RigidMotion> out;
  for (std::size_t k = 0; k < bodies_.size(); ++k) out.push_back(of(static_cast<int>(k), state));
  return out;
}

/// v = p/m and ω = I⁻¹ (L − c × p), with the momentum p and the angular momentum L about the world's origin.
RigidMotion RigidMotions::of(int number, const Vector& state) const {
  const auto& [rigid, inverse_inertia] = bodies_[static_cast<std::size_t>(number)];
  const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
  RigidMotion out;
  out.centre = body.centre;
  if (rigid == 0) return out;
  const auto modal = state.segment(body.first_mode, rigid);
  const Vector3d linear = body.momentum.leftCols(rigid) * modal,
                 angular = body.angular_momentum.leftCols(rigid) * modal;
  out.linear = linear / body.mass;
  out.rotation = inverse_inertia * (angular - body.centre.cross(linear));
  out.turn = cross_matrix(out.rotation);
  return out;
}

/// The matrix that turns the initial place of a body, from its centre, to the present one.
Matrix3d RigidMotions::turn(int number, const Pose& pose) const {
  return pose.attitude * model_.bodies[static_cast<std::size_t>(number)].rotation.transpose();
}

std::vector<RigidMotion> RigidMotions::displacement(const Stepper& stepper) const {
  const std::span<const Pose> poses = stepper.poses();
  if (poses.empty()) return of(stepper.modal()->q);
  std::vector<RigidMotion> out;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Vector3d& centre = model_.bodies[k].centre;
    out.push_back({.linear = poses[k].position - centre,
                   .centre = centre,
                   .turn = turn(static_cast<int>(k), poses[k]) - Matrix3d::Identity()});
  }
  return out;
}

Pose RigidMotions::pose(int number, const Stepper& stepper) const {
  if (!stepper.poses().empty()) return stepper.poses()[static_cast<std::size_t>(number)];
  const RigidMotion moved = of(number, stepper.modal()->q), rate = of(number, stepper.modal()->v);
  const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
  const double angle = moved.rotation.norm();
  const Vector3d axis = angle > 0 ? Vector3d(moved.rotation / angle) : Vector3d::UnitX();
  return {body.centre + moved.linear,
          Eigen::Quaterniond(Matrix3d(Eigen::AngleAxisd(angle, axis) * body.rotation)), rate.linear,
          rate.rotation};
}

std::vector<RigidMotion> RigidMotions::rates(const Vector& state, const Stepper& stepper) const {
  std::vector<RigidMotion> out = of(state);
  const std::span<const Pose> poses = stepper.poses();
  for (std::size_t k = 0; k < poses.size(); ++k) out[k].centre = poses[k].position;
  return out;
}

}  // namespace ricochet::contact
