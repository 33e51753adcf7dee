// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/turning_loads.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

using Square = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

/// Largest displacement of a candidate under a unit vector [m]. @param beyond  (M,3,3), or empty
double largest_response(const Bodies::Block& block, const std::vector<double>& beyond,
                        const Matrix& at_once) {
  const kernels::Surface& surface = block.kernel->surface;
  double most = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    Matrix3d response = Eigen::Map<const Matrix>(
                            &surface.shape[3 * i * static_cast<std::size_t>(block.modes)], 3, block.modes) *
                        at_once.transpose();
    if (!beyond.empty()) response += Square(&beyond[9 * i]);
    most = std::max(most, response.norm());
  }
  return most;
}

}  // namespace

TurningLoads::TurningLoads(const Model& model, std::span<const FloatingBody> bodies, ForcedResponse& response,
                           MovingPoints& points)
    : model_(&model) {
  for (const FloatingBody& body : bodies) largest_inverse_.push_back(body.inertia.largest_inverse);
  for (Vector* x : {&settled_, &displaced_, &change_, &pushed_}) x->setZero(model.omega.size());
  for (std::size_t j = 0; j < model.folded.modes.size(); ++j) {
    const int n = model.folded.modes[j];
    settled_(n) = model.folded.load(static_cast<Index>(j)) / (model.omega(n) * model.omega(n));
  }
  for (std::size_t d = 0; d < model.forcing.size(); ++d) {
    const Model::Forcing& one = model.forcing[d];
    const FloatingBody& body = bodies[static_cast<std::size_t>(one.body)];
    drivers_.push_back(driver(model, one, body, points));
    drivers_[d].force = drivers_[d].dynamic.transpose() * one.along(body.attitude);
    response.turn(d, drivers_[d].force);
  }
}

TurningLoads::Driver TurningLoads::driver(const Model& model, const Model::Forcing& one,
                                          const FloatingBody& body, MovingPoints& points) const {
  const Bodies::Block& block = model.bodies[static_cast<std::size_t>(one.body)];
  const auto entry = static_cast<std::size_t>(one.entry);
  const Matrix participation = one.participation(block);
  Driver out{.of = &one};
  out.dynamic = out.at_once = Matrix::Zero(3, block.modes);
  if (one.support) {
    out.at_once = participation;
  } else {
    out.dynamic = participation;
    out.dynamic.leftCols(body.frame_modes).setZero();
    for (const int n : model.folded.modes)
      if (const Index own = n - block.first_mode; own >= 0 && own < block.modes) {
        out.at_once.col(own) = participation.col(own) / (model.omega(n) * model.omega(n));
        out.dynamic.col(own).setZero();
      }
    out.free = !block.supported;
  }
  const std::vector<double>& beyond =
      one.support ? block.kernel->motions[entry].residual : block.kernel->applied[entry].residual;
  if (!beyond.empty()) {
    auto& responses = points.candidates(one.body).static_responses();
    out.response = static_cast<int>(responses.size());
    responses.push_back({.to_unit = beyond.data()});
  }
  const double length = one.vector.norm();
  out.pull = length * std::sqrt(one.own_total.squaredNorm() * body.inverse_mass +
                                one.own_moment.squaredNorm() * body.inertia.largest_inverse +
                                out.dynamic.squaredNorm());
  out.reach = length * largest_response(block, beyond, out.at_once);
  return out;
}

void TurningLoads::release(std::span<FloatingBody> bodies) noexcept {
  for (FloatingBody& body : bodies)
    for (Vector3d* x : {&body.load, &body.load_torque, &body.lag}) x->setZero();
}

void TurningLoads::act(std::span<FloatingBody> bodies, double from, double to, ForcedResponse& response,
                       MovingPoints& points) noexcept {
  if (drivers_.empty() && !has_pushed_) return;
  release(bodies);
  change_.setZero();
  const double step = to - from;
  for (std::size_t d = 0; d < drivers_.size(); ++d) {
    Driver& one = drivers_[d];
    const History& h = one.of->history;
    FloatingBody& body = bodies[static_cast<std::size_t>(one.of->body)];
    const Vector3d along = one.of->along(body.attitude), grows = (h.at(to) - h.at(from)) * along;
    change_.segment(body.first_mode, body.modes).noalias() += one.at_once.transpose() * grows;
    if (one.response >= 0)
      points.candidates(one.of->body).static_responses()[static_cast<std::size_t>(one.response)].change =
          grows;
    if (!one.free || !(h.peak(from, to) > 0)) continue;
    if (!one.of->follows) {
      one.force.noalias() = one.dynamic.transpose() * along;
      response.turn(d, one.force);
    }
    const double impulse = h.integral(from, to);
    const Vector3d force = body.attitude * (one.of->own_total * along);
    body.load += impulse / step * force;
    body.load_torque += impulse / step * (body.attitude * (one.of->own_moment * along));
    body.lag += (h.double_integral(from, to) - 0.5 * step * impulse) * body.inverse_mass * force;
  }
  if (has_pushed_) push(bodies, response);
}

void TurningLoads::push(std::span<FloatingBody> bodies, ForcedResponse& response) noexcept {
  pushed_.setZero();
  for (const PointForces::Force& one : pushes_.all()) {
    const Bodies::Block& block = model_->bodies[static_cast<std::size_t>(one.body)];
    FloatingBody& body = bodies[static_cast<std::size_t>(one.body)];
    const Vector3d own = body.axes.transpose() * one.world;
    push_modes(block, one.place, own, pushed_.segment(block.first_mode, block.modes));
    if (block.supported) continue;
    body.load += one.world;
    body.load_torque += body.axes * arm_of(block, one.place).cross(own);
  }
  for (const FloatingBody& body : bodies) pushed_.segment(body.first_mode, body.frame_modes).setZero();
  for (const int n : model_->folded.modes) pushed_(n) = 0;
  response.push(*model_, pushed_, {});
}

PushStatus TurningLoads::push_at(int body, const BodyPlace& place, const Vector3d& force) noexcept {
  const PushStatus status = pushes_.set(*model_, body, place, force);
  has_pushed_ = has_pushed_ || status == PushStatus::changed;
  return status;
}

void TurningLoads::take(const TurningLoads& earlier, const std::vector<int>& body) {
  pushes_.take(earlier.pushes_, body);
  has_pushed_ = earlier.has_pushed_;
}

const Vector& TurningLoads::place(std::span<const FloatingBody> bodies, double t,
                                  MovingPoints& points) noexcept {
  if (drivers_.empty()) return settled_;
  displaced_ = settled_;
  for (const Driver& one : drivers_) {
    const FloatingBody& body = bodies[static_cast<std::size_t>(one.of->body)];
    const Vector3d now = one.of->history.at(t) * one.of->along(body.attitude);
    displaced_.segment(body.first_mode, body.modes).noalias() += one.at_once.transpose() * now;
    if (one.response >= 0)
      points.candidates(one.of->body).static_responses()[static_cast<std::size_t>(one.response)].now = now;
  }
  return displaced_;
}

bool TurningLoads::act_on_free(double from, double to) const noexcept {
  const auto on_free = [&](const PointForces::Force& one) {
    return !model_->bodies[static_cast<std::size_t>(one.body)].supported;
  };
  return std::ranges::any_of(pushes_.all(), on_free) || std::ranges::any_of(drivers_, [&](const Driver& one) {
           return one.free && one.of->history.peak(from, to) > 0;
         });
}

bool TurningLoads::move(double from, double to) const noexcept {
  return std::ranges::any_of(
      drivers_, [&](const Driver& one) { return one.of->support && one.of->history.steepest(from, to) > 0; });
}

/// As FloatingBody::pull, of a unit force at a point.
double TurningLoads::pull_of(const PointForces::Force& one) const noexcept {
  const Bodies::Block& block = model_->bodies[static_cast<std::size_t>(one.body)];
  const double of_modes = square_shape(block, one.place, block.frame_modes());
  if (block.supported) return std::sqrt(of_modes);
  const double arm = arm_of(block, one.place).norm();
  return std::sqrt(of_modes + 1 / block.mass +
                   arm * arm * largest_inverse_[static_cast<std::size_t>(one.body)]);
}

double TurningLoads::pull(int body, double from, double to) const noexcept {
  double sum = 0;
  for (const Driver& one : drivers_)
    if (one.of->body == body) sum += one.pull * one.of->history.peak(from, to);
  for (const PointForces::Force& one : pushes_.all())
    if (one.body == body) sum += one.world.norm() * pull_of(one);
  return sum;
}

double TurningLoads::reach(int body, double from, double to) const noexcept {
  double sum = 0;
  for (const Driver& one : drivers_)
    if (one.of->body == body) sum += one.reach * one.of->history.peak(from, to);
  return sum;
}

double TurningLoads::speed(int body, double from, double to) const noexcept {
  double sum = 0;
  for (const Driver& one : drivers_)
    if (one.of->body == body && one.of->support) sum += one.reach * one.of->history.steepest(from, to);
  return sum;
}

}  // namespace ricochet::contact
