// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/inertia.hpp"

#include <cmath>

namespace ricochet::contact {

Model with_inertia(Model model, const Vector& impulse, const Vector& omega) {
  const Eigen::Index n = model.omega.size(), pairs = omega.size();
  model.omega.conservativeResize(n + pairs);
  model.omega.tail(pairs) = omega;
  for (Vector* modal : {&model.decay, &model.load, &model.q0, &model.v0}) {
    modal->conservativeResize(n + pairs);
    modal->tail(pairs).setZero();
  }
  model.B.conservativeResize(Eigen::NoChange, n + pairs);
  for (Eigen::Index k = 0; k < pairs; ++k) {
    const Vector w = model.pairs[static_cast<std::size_t>(k)].part_of(impulse), Rw = model.R * w;
    const double yields = w.dot(Rw);
    const Vector half = yields > 0 ? Vector(Rw / std::sqrt(2 * yields)) : Vector::Zero(Rw.size());
    model.B.col(n + k) = omega[k] * half;
    model.R.noalias() -= half * half.transpose();
  }
  return model;
}

}  // namespace ricochet::contact
