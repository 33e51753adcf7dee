// SPDX-License-Identifier: BSD-2-Clause
// The accuracy dial: chooses the settings that a scene leaves open, and estimates the error with them.
#pragma once

#include <optional>

#include "contact/accuracy/estimate.hpp"

namespace ricochet::contact {

struct DialRequest {
  double accuracy = 0;  ///< relative error that the quantities of interest may have
  StepOptions options;  ///< step and precision are only starting values if they are left open
  bool choose_rate = false, choose_precision = false, choose_points = false;
  Hertz band{0};  ///< end of the band of the kernels; used with choose_rate
};

/// The values chosen for settings that the scene leaves open.
struct Settings {
  std::optional<Hertz> rate{};
  std::optional<Precision> precision{};
};

struct Dialled {
  Model model;  ///< with coarsened points if that hardly changes results
  Settings settings{};
  std::optional<ErrorEstimate> estimate{};  ///< no value if nothing touches
};

/// Runs the subject several times. @param model  built from the subject's kernels
/// Throws InputError if a model cannot be built or run.
Dialled dial(const Subject& subject, Model model, DialRequest request);

}  // namespace ricochet::contact
