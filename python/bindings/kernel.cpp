// SPDX-License-Identifier: BSD-2-Clause
#include "python/bindings/kernel.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kernels/read.hpp"
#include "python/bindings/arrays.hpp"
#include "ricochet/ricochet.hpp"

namespace ricochet::python {

namespace py = pybind11;

namespace {

using kernels::Kernel;

/// (rM,rM), in single precision for a body that turns; None if the scene excludes it, or if it is compressed.
py::object residual_flexibility(const py::object& self) {
  const Kernel& kernel = self.cast<const Kernel&>();
  const kernels::Surface& surface = kernel.surface;
  const py::ssize_t rows = length(surface.size()) * surface.residual_components();
  if (surface.compact && !surface.compact->compressed())
    return view(surface.compact->whole, {rows, rows}, self);
  if (surface.residual_flexibility.empty()) return py::none();
  return view(surface.residual_flexibility, {rows, rows}, self);
}

Shape modes(const Kernel& k) { return {length(k.modes.size())}; }
Shape candidates(const Kernel& k) { return {length(k.surface.size())}; }
Shape places(const Kernel& k) { return {length(k.surface.size()), 3}; }
Shape traces(const Kernel& k) {
  return {length(k.surface.size()), k.surface.components, length(k.modes.size())};
}
Shape elements(const Kernel& k) {
  const py::ssize_t corners = k.surface.element_corners;
  return {length(k.surface.element.size()) / corners, corners};
}
Shape by_axis(const Kernel& k) { return {3, length(k.modes.size())}; }

py::dict certificate(const Kernel& kernel) {
  const kernels::Certificate& c = kernel.modes.certificate;
  py::dict out;
  out["below"] = c.below;
  out["upto_hz"] = c.upto_hz;
  out["count_by_inertia"] = c.count_by_inertia;
  out["count_found"] = c.count_found;
  out["left_out"] = c.left_out;
  out["complete"] = c.complete;
  out["orthonormality"] = c.orthonormality;
  out["flexibility_error"] = c.flexibility_error;
  return out;
}

/// (node (V,3), element (E,k), shape (V,3,N)) of the visualisation surface; None if there is none.
py::object visualisation_surface(const py::object& self) {
  const Kernel& kernel = self.cast<const Kernel&>();
  if (!kernel.view) return py::none();
  const kernels::View& surface = *kernel.view;
  const py::ssize_t nodes = length(surface.node.size()) / 3, corners = surface.element_corners;
  return py::make_tuple(view(surface.node, {nodes, 3}, self),
                        view(surface.element, {length(surface.element.size()) / corners, corners}, self),
                        view(surface.shape, {nodes, 3, length(kernel.modes.size())}, self));
}

/// Receivers by name: (point (3), shape (3,N)).
py::dict receivers(const py::object& self) {
  const Kernel& kernel = self.cast<const Kernel&>();
  py::dict out;
  for (const kernels::Receiver& receiver : kernel.receivers)
    out[py::str(receiver.name)] =
        py::make_tuple(copy(receiver.point), view(receiver.shape, {3, length(kernel.modes.size())}, self));
  return out;
}

}  // namespace

void bind_kernel(py::module_& module) {
  py::class_<Kernel, std::shared_ptr<Kernel>> kernel(module, "Kernel");
  kernel.def_readonly("body", &Kernel::body)
      .def_readonly("hash", &Kernel::hash)
      .def_readonly("scene", &Kernel::scene)
      .def_readonly("created_by", &Kernel::created_by)
      .def_readonly("dofs", &Kernel::dofs)
      .def_readonly("elements", &Kernel::elements)
      .def_readonly("order", &Kernel::order)
      .def_readonly("mass", &Kernel::mass)
      .def_readonly("supported", &Kernel::supported)
      .def_property_readonly("basis", [](const Kernel& k) { return k.modes.basis; })
      .def_property_readonly("certificate", &certificate)
      .def_property_readonly("centre", [](const Kernel& k) { return copy(k.centre); })
      .def_property_readonly("inertia",
                             [](const Kernel& k) {
                               return copy(k.inertia).reshape({3, 3});
                             })
      .def_property_readonly("components", [](const Kernel& k) { return k.surface.components; })
      .def_property_readonly("direction",
                             [](const Kernel& k) -> py::object {
                               if (!k.surface.direction) return py::none();
                               return copy(*k.surface.direction);
                             })
      .def_property_readonly("group", [](const Kernel& k) { return k.surface.group; })
      .def_property_readonly("residual_flexibility", &residual_flexibility)
      .def_property_readonly("visualisation_surface", &visualisation_surface)
      .def_property_readonly("receivers", &receivers);
  // Defines a property whose value is an array that refers to *values(kernel).
  const auto property = [&](const char* name, Shape (*shape)(const Kernel&), auto values) {
    kernel.def_property_readonly(name, [=](const py::object& self) {
      const Kernel& k = self.cast<const Kernel&>();
      return view(*values(k), shape(k), self);
    });
  };
  property("angular_frequency", modes, [](const Kernel& k) { return &k.modes.angular_frequency; });
  property("decay_rate", modes, [](const Kernel& k) { return &k.modes.decay_rate; });
  property("residual", modes, [](const Kernel& k) { return &k.modes.residual; });
  property("node", places, [](const Kernel& k) { return &k.surface.node; });
  property("centroid", places, [](const Kernel& k) {
    return k.surface.centroid.empty() ? &k.surface.node : &k.surface.centroid;
  });
  property("normal", places, [](const Kernel& k) { return &k.surface.normal; });
  property("area", candidates, [](const Kernel& k) { return &k.surface.area; });
  property("element", elements, [](const Kernel& k) { return &k.surface.element; });
  property("shape", traces, [](const Kernel& k) { return &k.surface.shape; });
  property("body_force", by_axis, [](const Kernel& k) { return &k.loads.body_force; });
  property("rotation", by_axis, [](const Kernel& k) { return &k.loads.rotation; });
  module.def("read_kernel",
             [](const std::filesystem::path& path) { return std::make_shared<Kernel>(kernels::read(path)); });
}

}  // namespace ricochet::python
