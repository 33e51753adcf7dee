// SPDX-License-Identifier: BSD-2-Clause
// The accuracy dial: chooses the settings that a scene leaves open, and estimates the error with them.
#pragma once

#include <optional>

#include "contact/accuracy/estimate.hpp"

namespace ricochet::contact {

struct DialRequest {
  double accuracy = 0;  ///< relative error that the quantities of interest may have
  StepOptions options;  ///< step and precision are starting values where they are left open
  bool choose_rate = false, choose_precision = false, choose_points = false;
  Hertz band{0};  ///< end of the band that the kernels are for; with choose_rate
};

/// Settings that were left open, as chosen.
struct Settings {
  std::optional<Hertz> rate{};
  std::optional<Precision> precision{};
};

struct Dialled {
  Model model;  ///< its points coarsened where that hardly matters
  Settings settings{};
  std::optional<ErrorEstimate> estimate{};  ///< none: nothing touches
};

/// Runs the subject several times. @param model  of the subject's kernels
/// Throws InputError as building the model and running it do.
Dialled dial(const Subject& subject, Model model, DialRequest request);

}  // namespace ricochet::contact
