// SPDX-License-Identifier: BSD-2-Clause
// What python/bindings/simulation.cpp does with Turns, on a vector in place of a simulation: compiled with
// ThreadSanitizer, it shows every access that they leave unordered.
#include <vector>

#include "python/bindings/turns.hpp"

namespace {

class SharedCounter {
 public:
  void step_block(int steps) {
    const ricochet::python::Turns::Change own(turns_);
    for (int k = 0; k < steps; ++k)
      turns_.unlocked([&] {
        for (int& value : values_) ++value;
        return 0;
      });
  }
  void clear() {
    const ricochet::python::Turns::Change own(turns_);
    turns_.settled([&] {
      values_.assign(values_.size() + 1, 0);  // elsewhere in memory
      return 0;
    });
  }
  /// Whether all values are equal, as they are between two steps.
  bool is_settled() {
    return turns_.settled([&] { return values_ == std::vector<int>(values_.size(), values_.front()); });
  }

 private:
  ricochet::python::Turns turns_;
  std::vector<int> values_ = std::vector<int>(1000, 0);
};

}  // namespace

PYBIND11_MODULE(shared_counter, module) {
  pybind11::class_<SharedCounter>(module, "SharedCounter")
      .def(pybind11::init<>())
      .def("step_block", &SharedCounter::step_block)
      .def("clear", &SharedCounter::clear)
      .def("is_settled", &SharedCounter::is_settled);
}
