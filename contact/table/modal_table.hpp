// SPDX-License-Identifier: BSD-2-Clause
// Responses sampled from a modal model.
#pragma once

#include <cstdint>

#include "contact/model/model.hpp"
#include "contact/table/table.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Samples the responses and the free motion of the model for `steps` steps of the scheme in `options`, as
/// far as the scheme needs them: for impulse, displacement and velocity; for compliant, flexibility, with R
/// and the modes above half the rate in S_0. `bodies` contains the bodies without supports. The table needs
/// steps·m² numbers of memory, twice as many for impulse.
Table table_from_modes(const Model& model, const StepOptions& options, std::int64_t steps);

}  // namespace ricochet::contact
