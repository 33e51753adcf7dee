// SPDX-License-Identifier: BSD-2-Clause
// The accuracy loop of ricochet-kernel: a pilot with coarse kernels, then rounds that refine what costs least
// for its gain, until the estimated error of the impact is below the accuracy of the scene.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <vector>

#include "src/console/console.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::accuracy {

/// Computes the kernels of a closed scene that are not there yet, and returns the files that it wrote. With
/// `check`, checks all bodies before it computes any. Collective.
using ComputeKernels =
    std::function<std::vector<std::filesystem::path>(const scene::Scene& closed, bool check)>;

/// Closes a scene that has an accuracy. All kernels of the result are in `folder` afterwards, with those from
/// which the error of the mesh is estimated, and so are the settings, from which later runs start. Reports
/// each round in a line. Collective. Throws InputError in the same cases as the computation of kernels and
/// impacts; once a round has succeeded, the loop ends with its settings instead.
scene::Scene close_by_accuracy(const scene::Scene& scene, const std::filesystem::path& folder, MPI_Comm comm,
                               console::Console& console, const ComputeKernels& compute);

/// The scene with the settings of the first round. Collective; throws InputError.
scene::Scene closed_for_check(const scene::Scene& scene, MPI_Comm comm);

}  // namespace ricochet::accuracy
