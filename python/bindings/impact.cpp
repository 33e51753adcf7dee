// SPDX-License-Identifier: BSD-2-Clause
#include "python/bindings/impact.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <sstream>

#include "contact/figures/figure.hpp"
#include "src/impact/run.hpp"

namespace ricochet::python {

namespace py = pybind11;

namespace {

/// Calls `progress(phase, done, total)` at most ten times a second and at the end of a phase; Ctrl-C ends the
/// run.
class Watch {
 public:
  explicit Watch(py::object progress) : progress_(std::move(progress)) {}

  void operator()(const std::string& phase, std::int64_t done, std::int64_t total) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100) && done < total) return;
    last_ = now;
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress_.is_none()) progress_(phase, done, total);
  }

 private:
  py::object progress_;
  std::chrono::steady_clock::time_point last_{};
};

/// Writes the result and the summary of the scene into `folder`, as ricochet-contact does.
void run(const std::filesystem::path& file, const std::vector<std::string>& settings,
         const std::filesystem::path& folder, const py::object& progress) {
  Watch watch(progress);
  console::Options options;
  options.scene = file;
  options.overrides = settings;
  options.out = folder;
  options.quiet = true;
  options.watch = std::ref(watch);
  std::ostringstream nowhere;
  const py::gil_scoped_release unlocked;
  impact::run_contact(options, nowhere);
}

/// Throws ValueError if the lengths differ.
double relative_error(const std::vector<double>& value, const std::vector<double>& reference, double scale) {
  if (value.size() != reference.size())
    throw py::value_error(
        fmt::format("a quantity has {} components, and its reference {}: they belong to "
                    "different scenes",
                    value.size(), reference.size()));
  const auto vector = [](const std::vector<double>& x) -> contact::Vector {
    return Eigen::Map<const contact::Vector>(x.data(), std::ssize(x));
  };
  return contact::relative_error(vector(value), vector(reference), scale);
}

}  // namespace

void bind_impact(py::module_& module) {
  module.def("run_impact", &run);
  module.def("relative_error", &relative_error);
}

}  // namespace ricochet::python
