// SPDX-License-Identifier: BSD-2-Clause
#include "python/bindings/shock.hpp"

#include <pybind11/stl.h>

#include "contact/figures/shock.hpp"
#include "python/bindings/arrays.hpp"

namespace ricochet::python {

namespace py = pybind11;

void bind_shock(py::module_& module) {
  using Signal = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const auto span = [](const Signal& x) {
    return std::span<const double>(x.data(), static_cast<std::size_t>(x.size()));
  };
  module.attr("channel_classes") = py::tuple(py::cast(contact::channel_classes));
  module.def("filter_channel", [span](const Signal& x, double rate, double channel_class, double rest) {
    py::array_t<double> out = copy(span(x));
    contact::filter_channel({out.mutable_data(), static_cast<std::size_t>(out.size())}, rate, channel_class,
                            rest);
    return out;
  });
  module.def("shock_response",
             [span](const Signal& x, double rate, const Signal& frequency, double quality, double rest) {
               return copy(contact::shock_response(span(x), rate, span(frequency), quality, rest));
             });
}

}  // namespace ricochet::python
