// SPDX-License-Identifier: BSD-2-Clause
// Stress and strain at the gauges of the kernels at the end of each step, in the axes of their bodies.
//
//   σ = Σ_n σ_n q_n + Σ_j σ^R_j f_j + (static parts of gravity, loads and supports)
//
// Near a contact, the static part σ^R of its forces f dominates.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "contact/figures/body_coordinates.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class Gauges {
 public:
  /// The gauges of all bodies, with their values at t = 0. `model` must outlive them. Throws InputError if
  /// two gauges have one name.
  Gauges(const Model& model, const StepOptions& options);

  struct Gauge {
    const kernels::Gauge* kernel;
    std::size_t body;
    std::size_t first;  ///< of its values: 6 of stress [Pa], and 1 of strain if it records one
  };
  const std::vector<Gauge>& gauges() const { return gauges_; }
  /// What determines the deformation of the bodies.
  const AllCoordinates& coordinates() const { return coordinates_; }
  /// Values of all gauges.
  std::span<const double> values() const { return values_; }

  /// Sets the values. They do not allocate.
  /// @param q, p, turning  as of AllCoordinates
  void set(double time, const Vector& q, const Vector& p, const Turning* turning) noexcept;
  /// Call it after each step of `stepper` whose values are needed.
  void observe(const Stepper& stepper) noexcept {
    set(stepper.time(), stepper.modal()->q, stepper.end_force(), stepper.turning());
  }

 private:
  AllCoordinates coordinates_;
  std::vector<Gauge> gauges_;
  std::vector<double> values_;
};

/// Whether a body of the model has gauges.
bool has_gauges(const Model& model);

}  // namespace ricochet::contact
