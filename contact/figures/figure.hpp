// SPDX-License-Identifier: BSD-2-Clause
// The quantities of interest (ricochet/quantity.hpp) as numbers, and their errors.
#pragma once

#include <map>

#include "contact/pairing/types.hpp"
#include "ricochet/quantity.hpp"

namespace ricochet::contact {

/// A quantity with the scale to which its error is relative.
struct Figure {
  Vector value;
  double scale = 0;
};

/// The quantities of one run. All runs of one scene have the same ones.
///
/// Velocities are those when contact last ended, or at the end of the run if bodies still touch. They are
/// relative to V, the largest speed at which a pair of bodies approached along its impulse when contact
/// began, or half of the largest change of velocity if that is larger (bodies that are pressed together have
/// no approach speed). With one free body, the relative error of its velocity is therefore the error of the
/// coefficient of restitution. Angular velocities are relative to V divided by the body's radius of gyration,
/// and energies to the energy that was put in (FigureObserver::energy_put_in). All other quantities are
/// relative to themselves.
using Figures = std::map<Quantity, Figure>;

/// Relative error of each quantity that a run has.
using Errors = std::map<Quantity, double>;

/// |value − reference| / scale. If the scale is 0, it is infinite unless both values are equal.
double relative_error(const Vector& value, const Vector& reference, double scale);

}  // namespace ricochet::contact
