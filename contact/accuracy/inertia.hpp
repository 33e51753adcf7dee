// SPDX-License-Identifier: BSD-2-Clause
// Modes above the band, invented from their static response.
#pragma once

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Gives inertia to half of the residual flexibility R, which represents the modes above the band as if they
/// responded at once.
///
/// Under the pattern w of the impulses of a pair, R yields r = R w/√(wᵀRw). Half of it, ½ r rᵀ, becomes one
/// mode at `omega`, with B = ω r/√2; R − ½ r rᵀ is still positive semidefinite. At a front, |F|² ∝ 1/ω², a
/// mode takes the energy ½ (bᵀw/ω)² ω² |F|², that is the same part of wᵀRw at each ω: the frequencies, which
/// are not known, hardly matter. A smooth force takes hardly more than its static part from any of them.
///
/// Half of R is that of the octave above the band if the modes are those of a rod, Σ 1/n². Others have more
/// modes further up.
///
/// @param impulse  (n) of the rows in a run [N s]
/// @param omega    of each pair [rad/s]
Model with_inertia(Model model, const Vector& impulse, const Vector& omega);

}  // namespace ricochet::contact
