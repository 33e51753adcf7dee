// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Dense>

namespace ricochet::test {

/// Random numbers as a vector, of which the last is drawn first. Compilers evaluate the arguments of a
/// constructor in different orders, so that it would be another vector with each of them.
template <class Distribution, class Engine>
Eigen::Vector3d drawn(Distribution& distribution, Engine& engine) {
  Eigen::Vector3d out;
  for (Eigen::Index k = 2; k >= 0; --k) out[k] = distribution(engine);
  return out;
}

}  // namespace ricochet::test
