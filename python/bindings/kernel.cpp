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

/// A property that views one array of the kernel in this shape.
template <class Values>
auto array(Values values, std::function<Shape(const Kernel&)> shape) {
  return [values, shape](const py::object& self) {
    const Kernel& kernel = self.cast<const Kernel&>();
    return view(values(kernel), shape(kernel), self);
  };
}

/// (cM,cM); None where the scene does without.
py::object residual_flexibility(const py::object& self) {
  const Kernel& kernel = self.cast<const Kernel&>();
  const kernels::Surface& surface = kernel.surface;
  if (surface.residual_flexibility.empty()) return py::none();
  const py::ssize_t rows = length(surface.size()) * surface.components;
  return view(surface.residual_flexibility, {rows, rows}, self);
}

Shape modes(const Kernel& k) { return {length(k.modes.size())}; }
Shape candidates(const Kernel& k) { return {length(k.surface.size())}; }
Shape places(const Kernel& k) { return {length(k.surface.size()), 3}; }

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
  out["approximate"] = c.approximate;
  return out;
}

/// (node (V,3), element (E,k), shape (V,3,N)) of the visualisation surface; None without one.
py::object visualisation_surface(const py::object& self) {
  const Kernel& kernel = self.cast<const Kernel&>();
  if (!kernel.view) return py::none();
  const kernels::View& surface = *kernel.view;
  const py::ssize_t nodes = length(surface.node.size()) / 3, corners = surface.element_corners;
  return py::make_tuple(view(surface.node, {nodes, 3}, self),
                        view(surface.element, {length(surface.element.size()) / corners, corners}, self),
                        view(surface.shape, {nodes, 3, length(kernel.modes.size())}, self));
}

/// By name: (point (3), shape (3,N)).
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
      .def_property_readonly("basis", [](const Kernel& k) { return k.modes.kind(); })
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
  const auto property = [&](const char* name, auto values, auto shape) {
    kernel.def_property_readonly(name, array(values, shape));
  };
  property(
      "angular_frequency", [](const Kernel& k) -> auto& { return k.modes.angular_frequency; }, modes);
  property(
      "decay_rate", [](const Kernel& k) -> auto& { return k.modes.decay_rate; }, modes);
  property(
      "residual", [](const Kernel& k) -> auto& { return k.modes.residual; }, modes);
  property(
      "node", [](const Kernel& k) -> auto& { return k.surface.node; }, places);
  property(
      "centroid", [](const Kernel& k) -> auto& {
        return k.surface.centroid.empty() ? k.surface.node : k.surface.centroid;
      },
      places);
  property(
      "normal", [](const Kernel& k) -> auto& { return k.surface.normal; }, places);
  property(
      "area", [](const Kernel& k) -> auto& { return k.surface.area; }, candidates);
  property(
      "element", [](const Kernel& k) -> auto& { return k.surface.element; },
      [](const Kernel& k) -> Shape {
        const py::ssize_t corners = k.surface.element_corners;
        return {length(k.surface.element.size()) / corners, corners};
      });
  property(
      "shape", [](const Kernel& k) -> auto& { return k.surface.shape; },
      [](const Kernel& k) -> Shape {
        return {length(k.surface.size()), k.surface.components, length(k.modes.size())};
      });
  const auto by_axis = [](const Kernel& k) -> Shape { return {3, length(k.modes.size())}; };
  property(
      "body_force", [](const Kernel& k) -> auto& { return k.loads.body_force; }, by_axis);
  property(
      "rotation", [](const Kernel& k) -> auto& { return k.loads.rotation; }, by_axis);
  module.def("read_kernel",
             [](const std::filesystem::path& path) { return std::make_shared<Kernel>(kernels::read(path)); });
}

}  // namespace ricochet::python
