// SPDX-License-Identifier: BSD-2-Clause
// NumPy arrays that refer to memory of the library.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <span>
#include <vector>

#include "ricochet/units.hpp"

namespace ricochet::python {

using Shape = std::vector<pybind11::ssize_t>;

inline pybind11::ssize_t length(std::size_t size) { return static_cast<pybind11::ssize_t>(size); }

/// A read-only array that refers to `values`. They must belong to `owner`, which the array keeps alive.
template <class T>
pybind11::array_t<T> view(const std::vector<T>& values, Shape shape, pybind11::handle owner) {
  pybind11::array_t<T> out(std::move(shape), values.data(), owner);
  pybind11::detail::array_proxy(out.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

inline pybind11::array_t<double> copy(std::span<const double> values) {
  return pybind11::array_t<double>(length(values.size()), values.data());
}

}  // namespace ricochet::python
