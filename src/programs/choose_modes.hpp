// SPDX-License-Identifier: BSD-2-Clause
// The modes that ricochet-kernel computes for a scene's `accuracy`.
#pragma once

#include <mpi.h>

#include "src/scene/scene.hpp"

namespace ricochet {

/// Band and flexibility error for `modes.accuracy` of the scene. They follow from the body that a wave
/// crosses fastest, because contact lasts about that long, and apply to all bodies. Rods get modes, solids a
/// contact-adapted basis. Collective; throws InputError on every rank.
scene::Modes chosen_modes(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet
