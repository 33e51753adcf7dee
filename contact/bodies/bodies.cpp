// SPDX-License-Identifier: BSD-2-Clause
#include "contact/bodies/bodies.hpp"

#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Share of the kinetic energy of a rigid velocity that the rigid modes may miss because of round-off in the
/// eigensolver.
constexpr double rigid_slack = 1e-6;

/// Loads of a kernel as (3,N).
auto three_rows(const std::vector<double>& values, int modes) {
  return Eigen::Map<const Matrix>(values.data(), 3, modes);
}

Bodies::Block block_of(const PlacedBody& body, int first_mode, const Vector3d& gravity) {
  const kernels::Kernel& kernel = *body.kernel;
  Bodies::Block block;
  block.name = body.name;
  block.first_mode = first_mode;
  block.modes = static_cast<int>(kernel.modes.size());
  block.mass = kernel.mass;
  block.centre = body.rotation * Eigen::Map<const Vector3d>(kernel.centre.data()) + body.translation;
  const Eigen::Matrix3d inertia =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kernel.inertia.data());
  block.inertia = body.rotation * inertia * body.rotation.transpose();
  // p = ∫ρ v,  L = ∫ρ (Q x + t) × Q v = Q ∫ρ x × v + t × p
  block.momentum = body.rotation * three_rows(kernel.loads.body_force, block.modes);
  block.angular_momentum = body.rotation * three_rows(kernel.loads.rotation, block.modes);
  for (int n = 0; n < block.modes; ++n)
    block.angular_momentum.col(n) += body.translation.cross(Vector3d(block.momentum.col(n)));
  block.supported = kernel.supported;
  block.weight = kernel.mass * gravity;
  block.kernel = body.kernel;
  block.rotation = body.rotation;
  block.translation = body.translation;
  return block;
}

/// v_n = φ_nᵀ M v for the modes with ω_n = 0, of a velocity or a displacement v. This is exact, because these
/// modes span the rigid motions that the supports leave free.
/// @param momentum  (3,modes) of each mode along and about the axes; @param velocity  along or about them
/// @param energy  twice the kinetic energy of the rigid motion
Vector rigid_rates(const PlacedBody& body, const Bodies::Block& block,
                   const Eigen::Matrix<double, 3, Eigen::Dynamic>& momentum, const Vector3d& velocity,
                   double energy, const char* key) {
  Vector out = Vector::Zero(block.modes);
  if (velocity.isZero(0)) return out;
  for (int n = 0; n < block.modes; ++n)
    if (body.kernel->modes.angular_frequency[n] == 0) out(n) = momentum.col(n).dot(velocity);
  if (!(energy > 0) || std::abs(out.squaredNorm() - energy) > rigid_slack * energy)
    throw InputError(base::format(
        "bodies.{}.{}: {} cannot move rigidly that way ({:.3g} of the kinetic energy is in its rigid "
        "modes). {}",
        body.name, key, block.supported ? "a supported body" : "this body",
        energy > 0 ? out.squaredNorm() / energy : 0,
        block.supported
            ? base::format("Set {} = [0, 0, 0], or take its support out.", key)
            : "A rod moves along its axis alone; otherwise compute its kernel again with ricochet-kernel."));
  return out;
}

/// The modal rates of the initial velocity V of the centre and the angular velocity ω about it:
/// v(x) = V + ω × (x − c), φ_nᵀ M v = V·p_n + ω·(L_n − c × p_n)
Vector rigid_velocity(const PlacedBody& body, const Bodies::Block& block) {
  const Vector3d &V = body.velocity, &w = body.angular_velocity;
  Eigen::Matrix<double, 3, Eigen::Dynamic> about = block.angular_momentum;
  for (int n = 0; n < block.modes; ++n) about.col(n) -= block.centre.cross(Vector3d(block.momentum.col(n)));
  return rigid_rates(body, block, block.momentum, V, block.mass * V.squaredNorm(), "velocity") +
         rigid_rates(body, block, about, w, w.dot(block.inertia * w), "angular_velocity");
}

}  // namespace

double Bodies::Block::radius() const {
  const std::vector<double>& places = kernel->surface.places();
  const Vector3d from = own_centre();
  double out = 0;
  for (std::size_t i = 0; i < places.size(); i += 3)
    out = std::max(out, (Eigen::Map<const Vector3d>(&places[i]) - from).norm());
  return out;
}

Bodies build_bodies(const std::vector<PlacedBody>& placed, const Vector3d& gravity) {
  Bodies out;
  out.gravity = gravity;
  int modes = 0;
  for (const PlacedBody& body : placed) {
    out.bodies.push_back(block_of(body, modes, gravity));
    modes += out.bodies.back().modes;
  }
  for (Vector* v : {&out.omega, &out.decay, &out.load, &out.q0, &out.v0}) v->setZero(modes);
  for (std::size_t k = 0; k < placed.size(); ++k) {
    const kernels::Kernel& kernel = *placed[k].kernel;
    const Bodies::Block& block = out.bodies[k];
    const int first = block.first_mode, n = block.modes;
    const Vector3d& d = placed[k].displacement;
    out.omega.segment(first, n) = Eigen::Map<const Vector>(kernel.modes.angular_frequency.data(), n);
    out.decay.segment(first, n) = Eigen::Map<const Vector>(kernel.modes.decay_rate.data(), n);
    out.load.segment(first, n) = block.momentum.transpose() * gravity;
    out.q0.segment(first, n) =
        rigid_rates(placed[k], block, block.momentum, d, block.mass * d.squaredNorm(), "velocity");
    out.v0.segment(first, n) = rigid_velocity(placed[k], block);
  }
  return out;
}

}  // namespace ricochet::contact
