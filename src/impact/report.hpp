// SPDX-License-Identifier: BSD-2-Clause
// The main figures of an impact as text, one line each.
#pragma once

#include <string>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/summary.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::impact {

std::string report(const contact::Summary& summary, const scene::Scene& scene);
std::string report(const contact::EquilibriumSummary& summary, const scene::Scene& scene);

}  // namespace ricochet::impact
