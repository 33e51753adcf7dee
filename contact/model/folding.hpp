// SPDX-License-Identifier: BSD-2-Clause
// Modes that the steps of a run do not sample respond at once:
//
//   q_n = (f_n + Σ F_n h(t) − B_nᵀ p)/ω_n²
//
// Their flexibility joins the residual one, R += B_n B_nᵀ/ω_n², and their loads join the static
// displacements. Whoever steps a model, or observes its steps, sees it folded.
#pragma once

#include <memory>
#include <numbers>

#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Whether steps sample a mode, that is, whether they are no longer than half its period.
inline bool sampled(double omega, double step) { return !(omega * step > std::numbers::pi); }

/// Folds the modes that compliant steps do not sample. Returns `model` itself if there are none, or if they
/// are folded already.
std::shared_ptr<const Model> fold(std::shared_ptr<const Model> model, const StepOptions& options);

/// Sets the coordinates q (N) of the folded modes under the forces p (n) at t [s].
/// @param v  (N) if given, their rates under loads; those under p are not known
void set_folded(const Model& model, double t, const Vector& p, Vector& q, Vector* v = nullptr) noexcept;

}  // namespace ricochet::contact
