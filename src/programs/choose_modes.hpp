// What `accuracy` does in ricochet-kernel: it chooses modes.
#pragma once

#include <mpi.h>

#include "src/scene/scene.hpp"

namespace ricochet {

/// Band and flexibility error for the scene's `modes.accuracy`, the same for all bodies: of the body that a
/// wave crosses fastest, as contact lasts about as long. Modes for rods, vectors fitted to contact for
/// solids. Collective; throws InputError on every rank.
scene::Modes chosen_modes(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet
