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
  bool choose_samples = false;  ///< with choose_rate: whether steps may be longer than output samples
  Hertz rate{0};  ///< with choose_rate: where to start, from the settings of a similar run; 0: unknown
};

struct Dialled {
  Model model;                                ///< with coarsened points if that hardly changes results
  std::optional<Hertz> rate{};                ///< if it was open
  std::optional<Precision> precision{};       ///< if it was open
  std::optional<ErrorEstimate> estimate{};    ///< no value if nothing touches or a body turns too far
  std::optional<Errors> mesh_near_contact{};  ///< part of the share of the mesh by elements near contact
  bool on_sharp_edge = false;                 ///< Estimator::on_sharp_edge
  std::optional<Quantities> quantities{};     ///< with the settings; no value if a step fails
};

/// Runs the subject several times. @param model  built from the subject's kernels
/// Throws InputError if a model cannot be built or run.
Dialled dial(const Subject& subject, Model model, DialRequest request);

}  // namespace ricochet::contact
