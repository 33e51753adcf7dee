// SPDX-License-Identifier: BSD-2-Clause
// When bodies part that touch at the end of a run.
#pragma once

#include <optional>
#include <string>

#include "contact/figures/figure_observer.hpp"
#include "contact/figures/summary.hpp"
#include "contact/stepping/stepper.hpp"
#include "src/impact/runner.hpp"

namespace ricochet::impact {

/// Steps on, beyond the run, until bodies have parted (FigureObserver::parted), and returns this time, at
/// which the run would know its rebound [s]. No value if bodies do not part within as many steps as the run
/// has or, if these are few, within 20 000 and 20 times those of the run; under loads, which may press them
/// together for good, within its steps and 20 000 of them; with sampled responses, and for bodies that turn
/// under loads.
///
/// @param figures  of the run
std::optional<double> parting(const Impact& impact, contact::Stepper& stepper,
                              contact::FigureObserver figures);

/// The warning of a run that ends while bodies touch which part afterwards, which nothing presses together,
/// or on whose parting it waited; otherwise empty.
std::string ends_in_contact(const scene::Scene& scene, const contact::Summary& summary);

}  // namespace ricochet::impact
