// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/point_forces.hpp"

#include <algorithm>
#include <cstddef>

#include "kernels/flexibility.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// A kernel with one component holds the motion along forces that depart from it by this share at most.
constexpr double along_component = 1e-9;

bool has_place(const kernels::Kernel& kernel, const BodyPlace& place) noexcept {
  const std::size_t count = place.is_receiver ? kernel.receivers.size() : kernel.surface.size();
  return place.number >= 0 && static_cast<std::size_t>(place.number) < count;
}

/// (c,modes) of the modes at a place.
Eigen::Map<const Matrix> shape_at(const Bodies::Block& body, const BodyPlace& place) noexcept {
  const auto number = static_cast<std::size_t>(place.number);
  if (place.is_receiver) return {body.kernel->receivers[number].shape.data(), 3, body.modes};
  const kernels::Surface& surface = body.kernel->surface;
  const auto rows = static_cast<std::size_t>(surface.components);
  return {&surface.shape[rows * number * static_cast<std::size_t>(body.modes)], surface.components,
          body.modes};
}

/// Whether the kernel holds the motion of a place along a force in body axes.
bool holds(const Model& model, const kernels::Kernel& kernel, const BodyPlace& place,
           const Vector3d& force) noexcept {
  const auto& direction = kernel.surface.direction;
  if (place.is_receiver || !direction) return true;
  const Vector3d along(direction->data());
  return !model.turns && (force - along.dot(force) * along).norm() <= along_component * force.norm();
}

}  // namespace

PushStatus PointForces::set(const Model& model, int body, const BodyPlace& place,
                            const Vector3d& force) noexcept {
  const Bodies::Block& block = model.bodies[static_cast<std::size_t>(body)];
  if (!force.allFinite() || !has_place(*block.kernel, place) ||
      !holds(model, *block.kernel, place, block.rotation.transpose() * force))
    return PushStatus::refused;
  const auto found =
      std::ranges::find_if(forces_, [&](const Force& one) { return one.body == body && one.place == place; });
  if (found == forces_.end()) {
    if (force.isZero(0)) return PushStatus::same;
    if (forces_.size() == most) return PushStatus::refused;
    forces_.push_back({body, place, force});
  } else {
    if (found->world == force) return PushStatus::same;
    if (force.isZero(0))
      forces_.erase(found);
    else
      found->world = force;
  }
  return PushStatus::changed;
}

bool PointForces::act_on(int body) const noexcept {
  return std::ranges::any_of(forces_, [&](const Force& one) { return one.body == body; });
}

void PointForces::forget(int body) noexcept {
  std::erase_if(forces_, [&](const Force& one) { return one.body == body; });
}

void PointForces::take(const PointForces& earlier, const std::vector<int>& body) {
  for (const Force& one : earlier.forces_)
    if (const auto now = std::ranges::find(body, one.body); now != body.end())
      forces_.push_back({static_cast<int>(now - body.begin()), one.place, one.world});
}

Vector3d arm_of(const Bodies::Block& body, const BodyPlace& place) noexcept {
  const auto number = static_cast<std::size_t>(place.number);
  const double* const at = place.is_receiver ? body.kernel->receivers[number].point.data()
                                             : &body.kernel->surface.places()[3 * number];
  return Vector3d(at) - body.own_centre();
}

void push_modes(const Bodies::Block& body, const BodyPlace& place, const Vector3d& force,
                Eigen::Ref<Vector> modal) noexcept {
  const auto shape = shape_at(body, place);
  if (shape.rows() == 3)
    modal.noalias() += shape.transpose() * force;
  else
    modal += Vector3d(body.kernel->surface.direction->data()).dot(force) * shape.row(0).transpose();
}

double square_shape(const Bodies::Block& body, const BodyPlace& place, Index first) noexcept {
  const auto shape = shape_at(body, place);
  return shape.rightCols(shape.cols() - first).squaredNorm();
}

void push_rows(const Model& model, int number, const BodyPlace& place, const Vector3d& force, Vector& scratch,
               Vector& displacement) noexcept {
  const kernels::Kernel& kernel = *model.bodies[static_cast<std::size_t>(number)].kernel;
  const kernels::Surface& surface = kernel.surface;
  const Selection& P = model.static_selection[static_cast<std::size_t>(number)];
  auto moved = scratch.head(P.cols());
  const auto at = static_cast<std::size_t>(place.number);
  if (place.is_receiver) {
    const std::vector<double>& residual = kernel.receivers[at].residual_flexibility;
    if (residual.empty()) return;
    moved.noalias() = Eigen::Map<const Matrix>(residual.data(), 3, P.cols()).transpose() * force;
  } else {
    if (!surface.has_flexibility()) return;
    const auto r = static_cast<std::size_t>(surface.residual_components());
    const kernels::Flexibility flexibility(surface);
    // Along the axes of the body, along the normal of the candidate, or along the one component
    const double* const only = surface.normal_residual ? &surface.normal[3 * at]
                               : surface.direction     ? surface.direction->data()
                                                       : nullptr;
    moved.setZero();
    for (std::size_t k = 0; k < r; ++k)
      flexibility.add_row(r * at + k, r == 3 ? force(static_cast<Index>(k)) : Vector3d(only).dot(force),
                          moved.data());
  }
  displacement.noalias() += P * moved;
}

}  // namespace ricochet::contact
