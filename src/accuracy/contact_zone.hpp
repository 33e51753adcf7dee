// SPDX-License-Identifier: BSD-2-Clause
// How far from the closest pair candidates may touch, and how many candidates lie there. Independent of MPI.
#pragma once

#include <optional>

#include "contact/accuracy/dial.hpp"
#include "src/accuracy/settings.hpp"

namespace ricochet::accuracy {

/// By how much faster a body may leave than it came, since off-centre forces turn it: the free end of a rod
/// that falls on its other end becomes twice as fast.
inline constexpr double after_impact = 2;

/// Whether a distance may limit the candidates: not at rest, nor if any part of a body that turns may touch.
bool has_zone(const scene::Scene& scene);

/// The distance by which bodies can approach each other rigidly in the duration of the scene, times
/// after_impact [m]. No value without a zone, and if nothing bounds the approach: if a body turns
/// from the beginning, or if forces or supports move it.
std::optional<double> within_flight(const scene::Scene& scene);

/// Twice the distance by which bodies came nearer to each other in a run [m].
double zone_near_contact(const contact::Quantities& run);

/// The zone for a mesh with the smaller elements of local_refinement.hpp [m]: `zone_near_contact`, but at
/// least three points more than were pressed. The gap grows with the square of the distance on rounded
/// surfaces.
double zone_with_finer_elements(const contact::Model& model, const contact::Quantities& run, double wanted);

/// The number of points that were pressed in a pair of surfaces, if the zone of contact is smaller than their
/// distance: fewer than four, or than three along a line. The smallest such number; no value if there is
/// none.
std::optional<int> few_pressed(const contact::Model& model, const contact::Quantities& run);

/// The zone with which a mesh that remains as it is goes on [m]: `zone_near_contact`, with three points more
/// than were pressed. No value if it would contain more than half of the surface that may touch.
std::optional<double> zone_of(const contact::Model& model, const contact::Quantities& run);

/// Number of candidates within a distance [m] of the closest one of their pair.
Eigen::Index candidates_within(const contact::Model& model, double distance);

/// Number of candidates of the body with the most of them, within reach or not.
std::size_t largest_surface(const contact::Model& model);

/// Expected number of candidates within a distance [m] of the closest pair, on meshes with the elements of
/// these settings. Where the model has few points there, their area follows from those farther apart.
double expected_candidates(const contact::Model& model, const KernelSettings& settings, double distance);

}  // namespace ricochet::accuracy
