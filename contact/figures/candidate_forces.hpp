// SPDX-License-Identifier: BSD-2-Clause
// The forces of contact on the candidates of a body in its own axes, in which the static response of a kernel
// is given.
#pragma once

#include "contact/motion/turning.hpp"

namespace ricochet::contact {

/// Sets `out` (rM) [N] to the forces on the r components of M candidates under p (n), unless bodies turn.
void candidate_forces(const Model& model, int body, const Vector& p, Vector& out) noexcept;

/// Sets the coordinates q (N) of the folded modes of a body that turns, at t.
void set_folded(const Model& model, int body, const Turning& turning, double t, Vector& q) noexcept;

}  // namespace ricochet::contact
