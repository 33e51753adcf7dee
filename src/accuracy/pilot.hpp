// SPDX-License-Identifier: BSD-2-Clause
// The settings of the first round of a search by accuracy: a coarse model of all that might touch.
#pragma once

#include <mpi.h>

#include "src/accuracy/settings.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::accuracy {

/// Coarse meshes, a band up to two crossings of a wave, √(E/ρ), through the body that it crosses in the
/// longest time, and the zone of `within_flight`. The static correction stands for what happens faster. If
/// all bodies are rods, whose ends meet with a shock, the band is wider, because resonances then matter.
/// Collective; throws InputError on every rank if a body has no extent.
Settings pilot_settings(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet::accuracy
