// SPDX-License-Identifier: BSD-2-Clause
// Error estimates as text: the formatted shares, and warnings with advice.
#pragma once

#include <string>
#include <vector>

#include "contact/output/summary.hpp"

namespace ricochet::contact {

/// "0.0031: mesh 0.0029, modes …"
std::string formatted(const ErrorEstimate& estimate);

/// Warns of an estimate above `accuracy`, with its largest cause and a remedy, and of shares that are
/// unknown.
std::vector<std::string> warnings(const ErrorEstimate& estimate, double accuracy);

}  // namespace ricochet::contact
