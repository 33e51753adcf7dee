// SPDX-License-Identifier: BSD-2-Clause
// Error estimates as text: the formatted shares, and warnings with advice.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contact/figures/error_estimate.hpp"

namespace ricochet::contact {

/// Returns a text such as "0.0031 of the rebound: mesh 0.0029, modes …", without shares of 0.
std::string formatted(const ErrorEstimate& estimate);

/// Returns a warning if the error probably exceeds `accuracy`, with its largest cause and a remedy, and
/// another one if shares are unknown.
std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy);

/// The cause with the largest share; no value if all shares are 0 or unknown.
std::optional<Cause> largest_cause(const ErrorEstimate& estimate);

}  // namespace ricochet::contact
