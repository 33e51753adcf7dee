// SPDX-License-Identifier: BSD-2-Clause
#include "contact/motion/floating_body.hpp"

#include <cmath>
#include <utility>

#include "base/format.hpp"
#include "contact/motion/turning.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Largest angles of a step of the free rotation [rad]: within a contact step, where the step itself is
// shorter, and in flight, where the attitude errs by about 1e-7 of the turn.
constexpr double of_contact = 0.25, of_flight = 0.1;

void check(const Model& model, const Bodies::Block& block) {
  const auto own = model.omega.segment(block.first_mode, block.modes);
  const Eigen::Index rigid = (own.array() == 0).count();
  if (block.supported && rigid > 0)
    throw InputError(
        base::format("bodies.{}: its supports leave it {} rigid motions, but motion.rotation = \"finite\" "
                     "moves bodies that "
                     "are free or held in all ways. Add supports, leave them out, or set \"linear\".",
                     block.name, rigid));
  if (const std::size_t pieces = block.kernel->piece_elements.size(); pieces > 1)
    throw InputError(
        base::format("bodies.{}: it consists of {} {}, which have {} rigid modes, but motion.rotation = "
                     "\"finite\" moves a body as a whole. Join them at common faces, make each a body of its "
                     "own, or set \"linear\".",
                     block.name, pieces,
                     std::cmp_equal(block.kernel->parts, pieces) ? "parts that are not joined"
                                                                 : "pieces that are not joined at faces",
                     rigid));
  if (rigid != block.frame_modes())
    throw InputError(
        base::format("bodies.{}: its kernel has {} rigid modes, but motion.rotation = \"finite\" needs the "
                     "six of a solid. Give a solid mesh, or set \"linear\".",
                     block.name, rigid));
  const auto decay = model.decay.segment(block.first_mode, rigid);
  if (!decay.isZero(0))
    throw InputError(
        base::format("bodies.{}.damping: damps the motion of the body as a whole, which motion.rotation = "
                     "\"finite\" does not "
                     "have. Leave rayleigh's alpha out, or set \"linear\".",
                     block.name));
}

/// A compensated sum (Kahan).
void add(const Vector3d& x, Vector3d& sum, Vector3d& carry) {
  const Vector3d y = x - carry, next = sum + y;
  carry = (next - sum) - y;
  sum = next;
}

}  // namespace

FloatingBody::FloatingBody(const Pose& pose) : inertia(Inertia::infinite()) { move_to(pose); }

FloatingBody::FloatingBody(const Model& model, const Bodies::Block& block)
    : first_mode(block.first_mode),
      modes(block.modes),
      frame_modes(block.frame_modes()),
      mass(block.mass),
      inverse_mass(block.supported ? 0 : 1 / block.mass),
      centre(block.own_centre()),
      gravity(block.supported ? Vector3d::Zero() : model.gravity),
      inertia(block.supported ? Inertia::infinite() : Inertia::of(block.own_inertia())),
      start(block.centre),
      position(start),
      attitude(block.rotation),
      axes(attitude.toRotationMatrix()) {
  check(model, block);
  const auto momentum_of = block.momentum.leftCols(frame_modes);
  Eigen::Matrix<double, 3, Eigen::Dynamic> about = block.angular_momentum.leftCols(frame_modes);
  for (int n = 0; n < frame_modes; ++n) about.col(n) -= block.centre.cross(Vector3d(momentum_of.col(n)));
  linear = momentum_of.transpose();
  spin = about.transpose();
  const auto own = model.v0.segment(first_mode, frame_modes);
  velocity = momentum_of * own / mass;
  momentum = about * own;
}

double FloatingBody::kinetic() const {
  const Vector3d own = axes.transpose() * momentum;
  return 0.5 * mass * velocity.squaredNorm() + 0.5 * own.dot(inertia.inverse * own);
}

void FloatingBody::move_to(const Pose& pose) noexcept {
  start = position = pose.position;
  attitude = pose.attitude;
  axes = attitude.toRotationMatrix();
  velocity = pose.velocity;
  momentum = axes * (inertia.tensor * (axes.transpose() * pose.spin));
}

void FloatingBody::leave() noexcept {
  present = false;
  inverse_mass = 0;
  for (Vector3d* x : {&gravity, &velocity, &momentum, &push, &torque, &load, &load_torque, &lag,
                      &position_carry, &velocity_carry})
    x->setZero();
}

Vector3d FloatingBody::drift(double time) noexcept {
  add(time * velocity, position, position_carry);
  const Vector3d turned = turn_freely(attitude, momentum, inertia, time, of_contact);
  axes = attitude.toRotationMatrix();
  return turned;
}

Vector3d FloatingBody::fly(double time) noexcept {
  add(time * velocity + 0.5 * time * time * acceleration(), position, position_carry);
  add(time * acceleration(), velocity, velocity_carry);
  const Vector3d turned = fly_freely(attitude, momentum, inertia, time, of_flight);
  axes = attitude.toRotationMatrix();
  return turned;
}

FloatingBody::FreeMotion FloatingBody::free_motion(double step) const {
  const Vector3d centre_moves = step * velocity + 0.5 * step * step * acceleration() + lag;
  return {axes.transpose() * centre_moves, step * own_spin(momentum + 0.5 * step * (torque + load_torque))};
}

double FloatingBody::farthest(double radius, double step) const {
  return step * (velocity.norm() + 0.5 * step * acceleration().norm() +
                 (momentum + 0.5 * step * (torque + load_torque)).norm() * inertia.largest_inverse * radius) +
         lag.norm();
}

double FloatingBody::pull() const {
  return std::sqrt(mass * (gravity + inverse_mass * push).squaredNorm() +
                   torque.squaredNorm() * inertia.largest_inverse);
}

/// The centre moves by Δ (v + v⁺)/2 and the lag, over which gravity and contact work as well.
double FloatingBody::kick(const Vector3d& contact, const Vector3d& moment, double step) noexcept {
  const Vector3d velocity_before = velocity, momentum_before = momentum, pressed = axes * contact;
  if (inverse_mass == 0) return 0;
  add(step * (acceleration() + pressed * inverse_mass), velocity, velocity_carry);
  add(lag, position, position_carry);
  const Vector3d force = push + load, turning = torque + load_torque;
  momentum += step * (turning + axes * moment);
  if (force.isZero(0) && turning.isZero(0) && lag.isZero(0)) return 0;
  return 0.5 * step *
             (force.dot(velocity_before + velocity) +
              turning.dot(axes * own_spin(momentum_before + momentum))) -
         lag.dot(mass * gravity + pressed);
}

void FloatingBody::write_rates(Vector& rates) const noexcept {
  rates.segment(first_mode, frame_modes).noalias() = linear * velocity + spin * (axes * own_spin());
}

std::vector<FloatingBody> floating_bodies(const Model& model) {
  std::vector<FloatingBody> out;
  for (const Bodies::Block& block : model.bodies) out.emplace_back(model, block);
  return out;
}

std::optional<Turning> initial_turning(const Model& model, const StepOptions& options) {
  if (options.rigid.rotation != Rotation::finite) return std::nullopt;
  Turning out{.poses = {}, .frames = model, .pushed = {}, .candidate_force = {}};
  out.pushed.resize(model.bodies.size());
  for (const FloatingBody& body : floating_bodies(model)) out.poses.push_back(body.pose());
  for (const Selection& selection : model.selection)
    out.candidate_force.push_back(Vector::Zero(selection.cols()));
  out.rates = model.initial_rates();
  return out;
}

}  // namespace ricochet::contact
