// SPDX-License-Identifier: BSD-2-Clause
// The band with which the search for the modes of a scene starts.
#pragma once

#include <mpi.h>

#include "src/scene/scene.hpp"

namespace ricochet {

struct StartBand {
  scene::Basis basis = scene::Basis::contact;
  Hertz up_to{0};
};

/// The band up to two crossings of a wave, √(E/ρ), through the body that it crosses in the shortest time:
/// contact between compact bodies lasts about as long or longer. If all bodies are rods, whose ends meet with
/// a shock, the band is wider and the basis consists of modes, because resonances then matter. Collective;
/// throws InputError on every rank.
StartBand start_band(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet
