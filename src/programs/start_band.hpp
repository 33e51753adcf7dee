// SPDX-License-Identifier: BSD-2-Clause
// The band with which the search for the modes of a scene starts.
#pragma once

#include <mpi.h>

#include "src/scene/scene.hpp"

namespace ricochet {

/// The band up to two crossings of a wave, √(E/ρ), through the body that it crosses in the longest time. The
/// static correction stands for what happens faster. If all bodies are rods, whose ends meet with a shock,
/// the band is wider, because resonances then matter. Collective; throws InputError on every rank.
Hertz start_band(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet
