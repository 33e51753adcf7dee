// SPDX-License-Identifier: BSD-2-Clause
// Chooses the modes that ricochet-kernel computes for the `accuracy` of a scene.
#pragma once

#include <mpi.h>

#include "src/scene/scene.hpp"

namespace ricochet {

/// Band and flexibility error for `modes.accuracy` of the scene, for all bodies. They follow from the body
/// that a wave crosses in the shortest time, because contact lasts about as long. If all bodies are rods,
/// they get modes; otherwise the basis is that of the scene. Collective; throws InputError on every rank.
scene::Modes chosen_modes(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet
