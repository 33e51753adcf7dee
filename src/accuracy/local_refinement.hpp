// SPDX-License-Identifier: BSD-2-Clause
// Smaller elements near the points of contact. Independent of MPI.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/accuracy/settings.hpp"

namespace ricochet::accuracy {

/// Balls of smaller elements around the points that were pressed in a run, by body, for the bodies whose
/// `refine` is open. A ball reaches to the next candidates, and its elements are so small that their distance
/// is divided by `times_denser`. If several points were pressed, a ball reaches twice as far and serves the
/// next points too. Bodies with the same geometry have the same balls, so that one kernel serves them all.
/// Empty if the scene gives the spacing of its candidates, or if nothing was pressed.
std::map<std::string, std::vector<scene::FineBall>> balls_near_contact(
    const scene::Scene& scene, const std::map<std::string, MeshSettings>& mesh, const contact::Dialled& round,
    double wanted);

/// Factor by which the distance of candidates falls in these balls: as wanted, but 4 for fewer than three
/// pressed points of a pair, which do not resolve the extent of the contact at all.
double times_denser(int pressed, double wanted);

/// Estimates the unknowns that tetrahedra of an order have in and around these balls, with sizes that grow up
/// to a distance [m] from each of them.
double unknowns_in(const std::vector<scene::FineBall>& balls, int order, double distance);

}  // namespace ricochet::accuracy
