// SPDX-License-Identifier: BSD-2-Clause
// Modes by SLEPc's EPS: by the engine of Ricochet or by another of its types, under the same certificate.
#pragma once

#include <string>

#include "src/modes/checkpoint.hpp"
#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// The type of EPS to use: that of -eps_type in PETSC_OPTIONS, otherwise the given one. Throws InputError if
/// SLEPc has no such type.
std::string chosen_eps_type(const std::string& given);

/// Whether a type works for several teams at a time. Others need all ranks in one team.
bool works_in_teams(const std::string& eps_type);

/// Computes the modes of K and M with the EPS that `request` names. Collective on all ranks of `teams`.
/// Throws like compute_modes.
/// @param stiffness, mass  those of `operators`
/// @param checkpoint  for the engine of Ricochet; other types begin anew
ModeSet modes_by_eps(const parallel::Teams& teams, const Operators& operators, Mat stiffness, Mat mass,
                     Factorisation& factor, const Request& request, const Checkpoint& checkpoint,
                     const Progress& progress);

}  // namespace ricochet::modes
