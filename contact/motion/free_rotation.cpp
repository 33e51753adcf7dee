// SPDX-License-Identifier: BSD-2-Clause
#include "contact/motion/free_rotation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Inertia Inertia::of(const Eigen::Matrix3d& tensor) {
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor).eigenvalues()(0);
  return {tensor, tensor.inverse(), 1 / least};
}

Vector3d turn_freely(Quaterniond& attitude, const Vector3d& momentum, const Inertia& inertia, double time,
                     double angle) noexcept {
  Vector3d turned = Vector3d::Zero();
  const double most = momentum.norm() * inertia.largest_inverse * std::abs(time);
  if (!(most > 0)) return turned;
  const double steps = std::max(1.0, std::ceil(most / angle)), h = time / steps;
  for (double k = 0; k < steps; ++k) {
    const Vector3d start = attitude.conjugate() * momentum;
    Vector3d middle = start;
    // The change falls at least by 8 in a round, because a step turns by at most 1/4.
    constexpr int most_rounds = 30;
    double change = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      const Vector3d next = start + 0.5 * h * middle.cross(inertia.inverse * middle);
      const double now = (next - middle).squaredNorm();
      middle = next;
      if (!(now < change)) break;  // only round-off is left
      change = now;
    }
    const Vector3d half = 0.5 * h * (inertia.inverse * middle);
    attitude = (attitude * Quaterniond(1, half.x(), half.y(), half.z())).normalized();
    turned += 2 * half;
  }
  return turned;
}

Vector3d fly_freely(Quaterniond& attitude, const Vector3d& momentum, const Inertia& inertia, double time,
                    double angle) noexcept {
  const double most = momentum.norm() * inertia.largest_inverse * time,
               steps = std::max(1.0, std::ceil(most / angle));
  Vector3d turned = Vector3d::Zero();
  const double part = 1 / (4 - std::cbrt(4.0));
  for (double k = 0; k < steps; ++k)
    for (const double share : {part, part, 1 - 4 * part, part, part})
      turned += turn_freely(attitude, momentum, inertia, share * time / steps, angle);
  return turned;
}

}  // namespace ricochet::contact
