// SPDX-License-Identifier: BSD-2-Clause
// Smaller elements near the points of contact. Independent of MPI.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "contact/accuracy/dial.hpp"
#include "src/scene/settings.hpp"

namespace ricochet::programs {

/// Balls of smaller elements around the points that were pressed in a run, by body, for the bodies whose
/// `refine` is open. A ball reaches to the next candidates; its elements are so small that the distance of
/// candidates is halved, or quartered if only few points were pressed. Bodies with the same geometry have the
/// same balls, so that one kernel serves them all. Empty if the scene gives the spacing of its candidates, or
/// if nothing was pressed.
std::map<std::string, std::vector<scene::FineBall>> balls_near_contact(
    const scene::Scene& scene, const std::map<std::string, scene::MeshSettings>& mesh,
    const contact::Dialled& round);

/// Estimates how many times as many candidates these meshes have within their balls as the meshes for which
/// the balls were made.
double times_as_many_candidates(const scene::KernelSettings& settings);

/// Estimates the unknowns that tetrahedra of an order have in and near these balls.
double unknowns_in(const std::vector<scene::FineBall>& balls, int order);

}  // namespace ricochet::programs
