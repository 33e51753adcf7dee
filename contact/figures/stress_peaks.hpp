// SPDX-License-Identifier: BSD-2-Clause
// The largest von Mises stress at the gauges of each body over all steps of a run, compared with the stress
// at which its material yields.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "contact/figures/gauges.hpp"
#include "contact/figures/pressure_check.hpp"
#include "contact/figures/summary.hpp"

namespace ricochet::contact {

/// √(½ ((σx − σy)² + (σy − σz)² + (σz − σx)²) + 3 (τ_yz² + τ_xz² + τ_xy²)) of a stress in the order of a
/// gauge.
double von_mises(const double* stress) noexcept;

class StressPeaks {
 public:
  /// Starts with the stress at t = 0, unless bodies are at rest. `model` must outlive this object.
  /// @param limits  by body; empty: unknown
  StressPeaks(const Model& model, const StepOptions& options, std::vector<MaterialLimits> limits);

  /// Call it after each step.
  void observe(const Stepper& stepper) noexcept;
  /// For bodies at rest. @param q, p  as of AllCoordinates
  void observe(double time, const Vector& q, const Vector& p) noexcept;

  /// By body with gauges.
  std::map<std::string, StressPeak> peaks() const;
  /// A line for each body whose stress exceeds its yield.
  std::vector<std::string> warnings() const;

 private:
  struct Largest {
    double stress = 0, time = 0;  ///< [Pa], [s]
    const kernels::Gauge* gauge = nullptr;
  };
  void note(double time) noexcept;

  const Model& model_;
  std::vector<MaterialLimits> limits_;
  Gauges gauges_;
  std::vector<Largest> largest_;  ///< by body; no gauge: it has none
};

}  // namespace ricochet::contact
