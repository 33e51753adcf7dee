// SPDX-License-Identifier: BSD-2-Clause
// Table kernels sampled from a modal model.
#pragma once

#include <cstdint>

#include "contact/model/model.hpp"
#include "contact/table/table.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// The model's kernels and free motion for `steps` steps of the scheme in `options`, with only what it needs
/// (impulse: displacement and velocity; compliant: flexibility, with R and the modes above half the rate
/// in S_0). Bodies without supports are in `bodies`. Memory: steps·m² numbers, twice for impulse.
Table table_from_modes(const Model& model, const StepOptions& options, std::int64_t steps);

}  // namespace ricochet::contact
