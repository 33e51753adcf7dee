// SPDX-License-Identifier: BSD-2-Clause
// Finds a line in the spectrum of the force above the band of the modes.
//
// Pressed bodies vibrate on the residual flexibility with frequencies somewhat above the band. There, neither
// modes nor residual flexibility are right: such a vibration belongs to the truncation, not to the bodies,
// and its frequency moves with the band.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

struct SpectralLine {
  double frequency = 0;  ///< [Hz]
  double share = 0;      ///< amplitude of the line, relative to the mean force; both weighted by the window
};

/// The strongest line of `force` between `band` and 1.5 times this frequency. A line is a maximum of the
/// spectrum under a Hann window that exceeds 0.05 of the mean force, four times the median of the spectrum
/// from 0.5 to 2 times the band, and the leakage of a stronger line within the band.
/// @param force  samples while bodies touch   @param rate  of the samples [Hz]   @param band  [Hz]
std::optional<SpectralLine> line_above(double band, std::span<const double> force, double rate);

/// Observes the total force of a run in bounded memory: of each touch, the first periods of the band.
class RippleCheck {
 public:
  /// `model` must outlive the check.
  /// @param step  Δ [s]; modes above half its rate do not count for the band
  RippleCheck(const Model& model, double step);

  /// Call it after each step or flight, at `time` [s]. @param force  Σ λ [N]
  void observe(double time, double force);

  std::vector<std::string> warnings() const;

 private:
  void add(double force);
  void finish();
  std::optional<SpectralLine> line_of_touch() const;

  const Model& model_;
  double step_;                ///< Δ [s]
  int body_ = -1;              ///< the body whose band ends first; −1: no body has elastic modes
  double band_ = 0;            ///< its end [Hz]
  int steps_per_sample_ = 1;   ///< a sample is the mean of these
  std::vector<double> touch_;  ///< samples of the present touch; short openings belong to it
  double sum_ = 0;             ///< of the present sample
  int summed_ = 0;             ///< steps in it
  double time_ = 0;            ///< of the last step [s]
  double idle_ = 0;            ///< time without a force at the end of the touch [s]
  double largest_ = 0;         ///< largest sum of samples of a touch
  std::optional<SpectralLine> worst_;
};

}  // namespace ricochet::contact
