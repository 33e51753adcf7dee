// SPDX-License-Identifier: BSD-2-Clause
// ricochet._core: the C++ library as the Python package sees it. Scenes are parsed and checked here, kernels
// are read, impacts run and simulations step; the modules around it add names, units and types.
#include <pybind11/pybind11.h>

#include "python/bindings/impact.hpp"
#include "python/bindings/kernel.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/simulation.hpp"
#include "ricochet/error.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace ricochet;
  module.attr("__version__") = RICOCHET_VERSION;
  pybind11::register_exception<InputError>(module, "InputError", PyExc_ValueError);
  pybind11::register_exception<SolverError>(module, "SolverError", PyExc_RuntimeError);
  python::bind_scene(module);
  python::bind_kernel(module);
  python::bind_impact(module);
  python::bind_simulation(module);
}
