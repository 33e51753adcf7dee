// SPDX-License-Identifier: BSD-2-Clause
// Simulations that a Python program advances step by step.
#pragma once

#include <pybind11/pybind11.h>

namespace ricochet::python {

void bind_simulation(pybind11::module_& module);

}  // namespace ricochet::python
