// SPDX-License-Identifier: BSD-2-Clause
// Kernel files as NumPy arrays that share the kernel's memory.
#pragma once

#include <pybind11/pybind11.h>

namespace ricochet::python {

void bind_kernel(pybind11::module_& module);

}  // namespace ricochet::python
