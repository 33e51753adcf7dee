// SPDX-License-Identifier: BSD-2-Clause
// Runs the impact of a scene in this process.
#pragma once

#include <pybind11/pybind11.h>

namespace ricochet::python {

void bind_impact(pybind11::module_& module);

}  // namespace ricochet::python
