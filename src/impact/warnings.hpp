// SPDX-License-Identifier: BSD-2-Clause
// Warnings on the figures of a finished run, with the settings that would remove their cause.
#pragma once

#include <string>
#include <vector>

#include "contact/figures/summary.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::impact {

/// Adds warnings about too few steps for a touch, energy that contact removes, steps whose forces are not the
/// only solution, a restitution below 0 or above 1, and triangles of an obstacle that are too far from its
/// drawing. With an accuracy in the scene, its error estimate
/// covers the steps.
void add_warnings(const scene::Scene& scene, contact::Summary& summary);

/// Warnings about obstacles that move along their surface although no pair with friction names them.
std::vector<std::string> motions_without_friction(const scene::Scene& scene);

}  // namespace ricochet::impact
