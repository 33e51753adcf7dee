// SPDX-License-Identifier: BSD-2-Clause
// The largest von Mises stress of each body over all steps of a run, at its gauges and on its visualisation
// surface, compared with the stress at which its material yields.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/gauges.hpp"
#include "contact/figures/pressure_check.hpp"
#include "contact/figures/stress_envelope.hpp"
#include "contact/figures/summary.hpp"

namespace ricochet::contact {

/// Whether a body of the model has gauges, or stress of its visualisation surface.
bool has_stress(const Model& model);

/// "gauge foil" or "[0.1, 0, 0.02] m"
std::string place_of(const StressPeak& peak);

class StressPeaks {
 public:
  /// Starts with the stress at t = 0, unless bodies are at rest. `model` must outlive this object.
  /// @param limits  by body; empty: unknown
  StressPeaks(const Model& model, const StepOptions& options, std::vector<MaterialLimits> limits);

  /// Call it after each step.
  void observe(const Stepper& stepper) noexcept;
  /// For bodies at rest. @param q, p  as of AllCoordinates
  void observe(double time, const Vector& q, const Vector& p) noexcept;

  /// By body with gauges or stress of its surface.
  std::map<std::string, StressPeak> peaks() const;
  /// By gauge.
  std::map<std::string, GaugePeaks> gauge_peaks() const;
  /// By body with stress of its surface.
  std::map<std::string, StressEnvelope> envelopes() const;
  /// A line for each body whose stress exceeds its yield.
  std::vector<std::string> warnings() const;

 private:
  struct Largest {
    double value = 0, time = 0;  ///< [Pa] or [1], [s]
    void take(double other, double at) noexcept {
      if (other > value) *this = {other, at};
    }
  };
  struct AtGauge {
    Largest von_mises, strain;
  };
  void note(double time) noexcept;

  const Model& model_;
  std::vector<MaterialLimits> limits_;
  Gauges gauges_;
  std::vector<AtGauge> at_gauge_;                         ///< by gauge
  std::vector<std::optional<EnvelopeObserver>> surface_;  ///< by body
};

}  // namespace ricochet::contact
