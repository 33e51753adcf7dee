// SPDX-License-Identifier: BSD-2-Clause
// Filters and spectra of accelerations.
#pragma once

#include <pybind11/pybind11.h>

namespace ricochet::python {

void bind_shock(pybind11::module_& module);

}  // namespace ricochet::python
