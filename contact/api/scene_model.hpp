// SPDX-License-Identifier: BSD-2-Clause
// What the scene of the embedding interface means to the steppers. All functions refuse what they cannot use
// in one line.
#pragma once

#include "contact/model/model.hpp"
#include "ricochet/ricochet.hpp"

namespace ricochet {

/// Refers to the kernels of the scene, which must live as long.
contact::Model model_of(const Scene& scene);

StepOptions step_options(const Scene& scene);

/// Matrix (p,N) that maps q̇ to the velocities of the pickups.
contact::Matrix pickups_of(const Scene& scene, const contact::Model& model);

}  // namespace ricochet
