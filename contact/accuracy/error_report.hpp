// SPDX-License-Identifier: BSD-2-Clause
// Error estimates as text: the formatted shares, and warnings with advice.
#pragma once

#include <string>
#include <vector>

#include "contact/output/summary.hpp"

namespace ricochet::contact {

/// Returns a text such as "0.0031: mesh 0.0029, modes …".
std::string formatted(const ErrorEstimate& estimate);

/// Returns a warning if the estimate exceeds `accuracy`, with its largest cause and a remedy, and another one
/// if shares are unknown.
std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy);

}  // namespace ricochet::contact
