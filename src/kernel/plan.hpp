// SPDX-License-Identifier: BSD-2-Clause
// Memory and time of the kernels of a scene on any number of ranks: ricochet-kernel --plan.
#pragma once

#include "src/kernel/discretise.hpp"

namespace ricochet::kernel {

/// What one number of ranks would need.
struct RankPlan {
  int ranks = 1, teams = 1;
  std::int64_t slices = 0;
  double mib = 0;      ///< of the rank that needs most
  double seconds = 0;  ///< from reading the mesh to the trace
};

/// The plan of one kernel.
struct KernelPlan {
  std::string body;
  std::int64_t unknowns = 0, modes = 0;
  modes::Pace pace;                ///< measured
  std::vector<RankPlan> on_ranks;  ///< 1, 2, 4, …
};

/// Assembles the matrices of a body, factors once or twice, measures the pace of the search, and plans it for
/// other numbers of ranks. It finds no mode and writes nothing. Needs a GmshSession. Collective. Throws
/// InputError as `discretise` does.
///
/// Each rank holds the whole body if the memory of this machine suffices for that, and works on its own
/// slices; otherwise, as few ranks as possible share one. Those are assumed to be as fast as the root of
/// their number.
KernelPlan plan_kernel(scene::KernelRequest request, OpenedMeshes& meshes, MPI_Comm comm,
                       console::Console& console);

/// The plan of all kernels, which are computed one after another: a line for each of them, a table, and the
/// command that submits the job to SLURM, with the most ranks of which at least half are used.
/// @param words  arguments of `ricochet kernel`
std::string plan_text(const std::vector<KernelPlan>& kernels, const std::vector<std::string>& words);

}  // namespace ricochet::kernel
