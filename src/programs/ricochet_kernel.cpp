// SPDX-License-Identifier: BSD-2-Clause
// ricochet-kernel SCENE.toml: computes the modes of each body and stores their trace on its contact surface.
//
//   mpirun -n 2 ricochet-kernel meshes/two-disks/two-disks.toml
//
//   mesh ──► PT-Scotch parts ──► K, M (PETSc) ──► modes (SLEPc, MUMPS) ──► trace on the contact surface ──►
//   <out>/<body>-<hash>.kernel.h5

#include <fmt/format.h>

#include <iostream>

#include "src/console/ending.hpp"
#include "src/kernel/run.hpp"
#include "src/parallel/blas.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/key_reference.hpp"

int main(int argc, char** argv) {
  using namespace ricochet;
  parallel::prepare_blas();
  console::end_cleanly_on_signals();  // before MPI starts, so that signals are handled then too
  const parallel::Session session;
  console::end_cleanly_on_signals();  // again, because PETSc has replaced some handlers
  const bool first = parallel::rank_of(PETSC_COMM_WORLD) == 0;
  const auto parsed = console::parse(
      {.name = "ricochet-kernel",
       .purpose = "Computes the contact kernel of each body of a scene, in parallel under mpirun.",
       .examples = "  mpirun -n 2 ricochet-kernel two-disks.toml\n"
                   "  mpirun -n 4 ricochet-kernel two-disks.toml --set modes.up_to_hz=3000 --out kernels\n"
                   "  ricochet-kernel two-rods.toml --set 'modes={ count = 100 }' --dry-run\n"
                   "PETSc and MUMPS (-mat_mumps_icntl_N) take their own options from PETSC_OPTIONS.",
       .keys = scene::key_reference()},
      argc, argv, first);
  if (!parsed.options) return parsed.status;
  try {
    const int status = kernel::run_kernel(*parsed.options, PETSC_COMM_WORLD);
    return console::all_printed("ricochet-kernel") ? status : 1;
  } catch (const InputError& error) {
    // The error is the same on every rank.
    return first ? console::status_of(error, "ricochet-kernel") : 2;
  } catch (const std::exception& error) {
    const bool all = session.is_called_on_all_ranks();
    if (all && !first) return 1;
    std::cerr << "ricochet-kernel: "
              << (all ? "" : fmt::format("rank {}: ", parallel::rank_of(PETSC_COMM_WORLD)))
              << console::message_of(error) << std::endl;
    if (!all) MPI_Abort(PETSC_COMM_WORLD, 1);  // the others may wait in a collective call
    return 1;
  }
}
