// SPDX-License-Identifier: BSD-2-Clause
// ricochet._core: the C++ library for the Python package. It parses and checks scenes, reads kernels, runs
// impacts and steps simulations. The modules of the package add names, units and types.
#include <pybind11/pybind11.h>

#include "python/bindings/impact.hpp"
#include "python/bindings/kernel.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/shock.hpp"
#include "python/bindings/simulation.hpp"
#include "ricochet/error.hpp"

namespace {

namespace py = pybind11;

/// A class of ricochet.errors, kept alive until the process ends.
PyObject* error_class(const char* name) {
  return py::module_::import("ricochet.errors").attr(name).cast<py::object>().release().ptr();
}

/// Translates InputError and SolverError of the library into the classes of the package.
void translate_errors() {
  static PyObject* const input = error_class("InputError");
  static PyObject* const solver = error_class("SolverError");
  py::register_exception_translator([](std::exception_ptr failure) {
    try {
      std::rethrow_exception(failure);
    } catch (const ricochet::InputError& error) {
      PyErr_SetString(input, error.what());
    } catch (const ricochet::SolverError& error) {
      PyErr_SetString(solver, error.what());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.attr("__version__") = RICOCHET_VERSION;
  translate_errors();
  ricochet::python::bind_scene(module);
  ricochet::python::bind_kernel(module);
  ricochet::python::bind_impact(module);
  ricochet::python::bind_simulation(module);
  ricochet::python::bind_shock(module);
}
