// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/discretise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/memory.hpp"
#include "contact/api/scene_model.hpp"
#include "kernels/compression.hpp"
#include "src/elasticity/assemble.hpp"
#include "src/elasticity/expected_size.hpp"
#include "src/elasticity/matrix_file.hpp"
#include "src/kernel/imported_modes.hpp"
#include "src/mesh/faces.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/parts.hpp"
#include "src/modes/eps_solve.hpp"
#include "src/modes/modes.hpp"
#include "src/modes/search.hpp"
#include "src/parallel/memory.hpp"
#include "src/reduction/contact_basis.hpp"

namespace ricochet::kernel {
namespace {

/// Distributes the mesh on rank 0 among the ranks of each team. Collective over all teams.
mesh::Mesh hand_out(mesh::GlobalMesh whole, const parallel::Teams& teams) {
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(whole, teams.peers());
  return mesh::distribute(std::move(whole), teams.team(), teams.peers());
}

/// For a message: what may be used of the memory that is free to a rank [MiB].
std::string usable_of(double free_mib) {
  return fmt::format("{:.0f} of {:.0f} free ones may be used", usable * free_mib, free_mib);
}

/// A lower bound of the memory of the matrices of a whole solid [MiB], before its mesh is distributed; 0 for
/// another body, whose matrices are small or in a file. Collective.
double least_mib(const scene::Body& body, const Source& source, MPI_Comm comm) {
  std::int64_t nodes = 0;
  if (!source.files) {
    if (source.whole.dim == 3 && !body.imported())
      nodes = static_cast<std::int64_t>(source.whole.position.size() / 3);
    return elasticity::least_mib(parallel::of_rank(comm, 0, nodes));
  }
  for (const mesh::MshOutline& outline : source.files->outline)
    for (const mesh::MshNodes& block : outline.nodes) nodes += block.tags.count;
  return elasticity::least_mib(nodes);
}

/// The largest number of teams below `count` that memory may allow: the larger a team, the less of its body
/// does each of its ranks hold. 1 if memory allows no other.
/// @param need  memory that a rank would still need with `count` teams [MiB]
/// @param held  memory that it already takes for its share of the body [MiB]
/// @param room  memory that is free to a rank beside it [MiB]
int fewer_teams(int ranks, int count, double need, double held, double room) {
  const double most = count * usable * (room + held) / (need + usable * held);
  int fewer = count - 1;
  while (fewer > 1 && (ranks % fewer != 0 || fewer > most)) --fewer;
  return fewer;
}

/// Buffers of BLAS and MUMPS, and code that the search touches for the first time. They are part of the
/// stated memory and of the memory that is not usable.
constexpr double buffers_mib = 24;

/// Largest visualisation surface of all nodes in a kernel [MiB]. Larger ones have the corners of elements
/// alone: they consist of so many faces that these are small.
constexpr double all_nodes_mib = 64;

/// Number of modes or vectors that the search will find, as far as this is known before it; 0: unknown.
std::int64_t expected_count(const scene::Modes& wanted, const Discretised& made) {
  if (wanted.count) return *wanted.count;
  if (wanted.basis == scene::Basis::contact || made.mesh.total_elements == 0) return 0;
  return modes::expected_modes(made.matrices, *wanted.up_to);
}

/// Columns of the loads from which a contact-adapted basis starts.
std::int64_t starting_loads(const Discretised& made) {
  return made.pressed.cols() + 3 + made.sources.receiver.cols() + made.sources.load.cols();
}

/// Memory that the search for modes needs on this rank [MiB].
/// @param count  number of modes, if known
/// @param teams  that share their shapes
double expected_mib(const scene::Modes& wanted, const Discretised& made, std::int64_t count,
                    std::int64_t per_shift, int teams) {
  const std::int64_t rows = made.matrices.local_rows;
  const bool fitted = wanted.basis == scene::Basis::contact;
  double loads = 0, adapted = 0;
  if (fitted || wanted.flexibility_error) {
    loads = sizeof(double) * static_cast<double>(rows * starting_loads(made)) / base::mib;
    adapted =
        loads + reduction::expected_basis_mib(*made.factor, rows, starting_loads(made), fitted ? count : 0);
  }
  if (fitted) return adapted;
  const double search =
      modes::expected_mib(*made.factor, rows, count > 0 ? count : per_shift, per_shift, teams);
  return std::max(adapted, loads + search);
}

/// Components of displacement and stress on the visualisation surface; 0 except on the first rank of a team.
double surface_rows(const scene::KernelRequest& request, const Discretised& made) {
  const std::size_t rows = 3 + (request.stress ? kernels::stress_rows : 0);
  return static_cast<double>(rows * made.mesh.visualisation.node.size());
}

/// Memory that the residual flexibility needs on this rank [MiB], besides that of the factorisation, which is
/// freed before. Modes that are projected out add a little.
double flexibility_mib(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes,
                       int teams) {
  if (!has_flexibility(request, made)) return 0;
  const reduction::Loads border =
      reduction::beside({made.pressed, made.sources.receiver.sparseView(),
                         made.matrices.rigid_load.sparseView(), made.sources.load.sparseView()});
  const auto mib_of = [](double numbers) { return sizeof(double) * numbers / base::mib; };
  const auto loads = static_cast<double>(border.cols()), rows = static_cast<double>(made.matrices.local_rows),
             shapes = mib_of(rows * static_cast<double>(modes)) / teams;
  // With a picture: factors again, and the response of its nodes, as they come, gathered and stored.
  const double seen = surface_rows(request, made);
  const double nodes = request.view ? mib_of(seen * loads * 2.5) : 0;
  if (is_compressed(request, made))
    return shapes + made.factor->expected_mib() +
           kernels::compression_bytes(made.patches.geometry.size()) / base::mib + nodes;
  // The matrix itself exists three times while it is stored in the kernel.
  const double size = mib_of(loads * loads);
  // Row, column and value of each entry of K. MUMPS estimates less than it reaches: counted in runs, its
  // front of the border has one and a half copies more.
  const double entries = mib_of(2.0 * static_cast<double>(made.factor->entries().row.size()));
  const double complement =
      entries + 1.5 * size +
      reduction::BorderedStiffness(*made.teams, *made.factor, {}, border).expected_mib();
  const double picture = request.view ? made.factor->expected_mib() + size + nodes : 0;
  return shapes + std::max({complement, 3 * size, picture});
}

/// Size of the visualisation surface in the kernel: modes and static responses [MiB]; 0 except on the first
/// rank of a team.
double surface_mib(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes) {
  const auto fields = static_cast<double>(modes) +
                      (has_flexibility(request, made) ? static_cast<double>(made.loads.cols()) : 0);
  return sizeof(float) * surface_rows(request, made) * fields / base::mib;
}

/// Distributes the mesh of a body over `count` teams of ranks. Collective; throws InputError on every rank.
/// @param last  whether the source may be consumed
Discretised distributed(const scene::KernelRequest& request, Source& source, int count, bool last,
                        MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  Discretised made;
  made.teams = std::make_unique<parallel::Teams>(comm, count);
  if (source.files)
    made.mesh = mesh::read_msh(
        *source.files, body, made.teams->team(), made.teams->peers(),
        [&](std::int64_t done, std::int64_t total) { console.advance(done, total); },
        surface::requested_groups(request));
  else
    made.mesh = hand_out(last ? std::move(source.whole) : source.whole, *made.teams);
  console.end(body.imported()
                  ? fmt::format("{} nodes", made.mesh.total_nodes)
                  : fmt::format("{} elements, {} nodes", made.mesh.total_elements, made.mesh.total_nodes));
  return made;
}

/// Assembles the matrices of a distributed mesh. Collective; throws InputError on every rank.
void assemble(const scene::KernelRequest& request, Discretised& made, MPI_Comm comm,
              console::Console& console) {
  const scene::Body& body = request.body;
  const std::string file = body.mesh.filename().string();
  std::vector<std::string> moved;
  for (const std::string& support : surface::requested_groups(request).moved)
    moved.push_back(body.support.at(support));
  if (request.friction && made.mesh.dim == 1)
    throw InputError(fmt::format("{}: {}", file, friction_on_rod(body.name)));
  console.begin(body.name + ": assembly");
  made.sources = surface::make_sources(made.mesh, request);
  if (body.imported())
    parallel::on_all_ranks(comm,
                           [&] { made.matrices = elasticity::read_matrices(made.mesh, body.mesh, moved); });
  else
    made.matrices = elasticity::assemble(
        made.mesh, body.materials, file,
        [&](std::int64_t done, std::int64_t total) { console.advance(done, total); }, moved);
  made.patches = patches_of(request, made.mesh);
  made.candidates = made.patches.geometry.size();
  if (request.points) surface::restrict_to(made.patches, *request.points);
  made.loads = surface::patch_loads(made.mesh, made.patches);
  made.pressed =
      request.normal_residual ? surface::along_normals(made.loads, made.patches.geometry) : made.loads;
}

}  // namespace

bool has_flexibility(const scene::KernelRequest& request, const Discretised& made) {
  return request.modes.residual_flexibility && made.patches.geometry.size() > 0;
}

bool is_compressed(const scene::KernelRequest& request, const Discretised& made) {
  const kernels::Surface& surface = made.patches.geometry;
  return has_flexibility(request, made) && request.turns && surface.components == 3 &&
         kernels::is_compressed(surface.size());
}

Discretised discretise(scene::KernelRequest& request, double view_mib, OpenedMeshes& meshes, MPI_Comm comm,
                       console::Console& console) {
  const std::string& name = request.body.name;
  const std::string file = request.body.mesh.filename().string();
  base::return_freed_memory();  // of the body before
  console.begin(name + ": mesh");
  Source source = meshes.take(request);
  const int ranks = parallel::size_of(comm);
  bool in_teams = request.modes.basis == scene::Basis::modes;
  parallel::on_all_ranks(comm, [&] {
    in_teams = in_teams && modes::works_in_teams(modes::chosen_eps_type(request.modes.solver));
  });
  int count = in_teams ? ranks : 1;
  if (count > 1) {  // memory may not even suffice for so many copies of the mesh
    const double least = least_mib(request.body, source, comm) / ranks * count,
                 free_mib = parallel::available_mib(comm);
    if (least > usable * free_mib) count = fewer_teams(ranks, count, least, 0, free_mib);
  }
  for (bool again = false;; again = true) {
    if (again) console.begin(name + ": mesh, for fewer teams");
    const double before = base::resident_bytes() / base::mib;
    const auto held = [&] { return parallel::largest(comm, base::resident_bytes() / base::mib - before); };
    // The source is needed again if memory allows only fewer teams.
    Discretised made = distributed(request, source, count, count == 1, comm, console);
    const double matrices = parallel::largest(comm, elasticity::expected_mib(made.mesh)),
                 free_mib = parallel::available_mib(comm);
    if (matrices > usable * free_mib) {
      if (count > 1) {
        count = fewer_teams(ranks, count, matrices, held(), free_mib);
        continue;
      }
      throw InputError(fmt::format(
          "{}: its matrices would need {:.0f} MiB a rank, {}: use more machines or a coarser mesh", file,
          matrices, usable_of(free_mib)));
    }
    assemble(request, made, comm, console);
    made.factor = std::make_unique<modes::Factorisation>(made.matrices.stiffness, made.matrices.mass,
                                                         request.modes.low_rank);
    const double room = parallel::available_mib(comm);
    made.resident_mib = parallel::largest(comm, base::resident_bytes() / base::mib);
    const std::int64_t expected = expected_count(request.modes, made);
    const auto shown_mib = [&] { return parallel::largest(comm, surface_mib(request, made, expected)); };
    double shown = shown_mib();
    if (shown > all_nodes_mib) {
      if (parallel::rank_of(made.mesh.comm) == 0) mesh::keep_corners(made.mesh.visualisation);
      shown = shown_mib();
    }
    if (!request.view && 0 < shown && shown <= view_mib) request = scene::with_view(request);
    double need = 0;
    for (const std::int64_t per_shift : {260, 130, 65}) {
      made.modes_per_shift = per_shift;
      need = parallel::largest(comm, expected_mib(request.modes, made, expected, per_shift, count));
      if (need <= usable * room || (per_shift == 130 && count > 1)) break;
    }
    const double flexibility = parallel::largest(comm, flexibility_mib(request, made, expected, count)),
                 most_needed = std::max(need, flexibility);
    console.end(fmt::format("{} unknowns; {:.0f} MiB needed of {:.0f} a rank", made.matrices.total_rows,
                            made.resident_mib + most_needed + buffers_mib, made.resident_mib + room));
    if (most_needed <= usable * room) return made;
    if (count == 1 && flexibility > need)
      throw InputError(fmt::format(
          "{}: the residual flexibility between {} candidates would need {:.0f} MiB a rank, "
          "{}: name a smaller contact surface, set contact.reach or contact.spacing, or use more machines",
          file, made.patches.geometry.size(), flexibility, usable_of(room)));
    if (count == 1)
      throw InputError(
          fmt::format("{}: its factorisation would need {:.0f} MiB a rank, {}: use more machines, a coarser "
                      "mesh or fewer modes",
                      file, need, usable_of(room)));
    count = fewer_teams(ranks, count, most_needed, held(), room);
  }
}

double needed_mib(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes, int teams,
                  MPI_Comm comm) {
  const double need =
      parallel::largest(comm, std::max(expected_mib(request.modes, made, modes, made.modes_per_shift, teams),
                                       flexibility_mib(request, made, modes, teams)));
  return made.resident_mib + need + buffers_mib;
}

void check_memory(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes,
                  std::int64_t slices, double seconds, MPI_Comm comm, console::Console& console) {
  const double before = made.resident_mib,
               whole = needed_mib(request, made, modes, made.teams->count(), comm),
               need = whole - before - buffers_mib;
  const double now = parallel::largest(comm, base::resident_bytes() / base::mib),
               there = std::max(now, before) + parallel::available_mib(comm);
  console.end(fmt::format("{} eigenvalues; {:.0f} MiB needed of {:.0f} a rank{}", modes, whole, there,
                          seconds > 0
                              ? fmt::format("; {} {} planned, {}", slices, slices == 1 ? "slice" : "slices",
                                            console::duration_of(seconds))
                              : ""));
  if (need > usable * (there - before))
    throw InputError(fmt::format(
        "{}: {} modes would need {:.0f} MiB a rank, {}: use more machines, a coarser mesh or fewer modes",
        request.body.mesh.filename().string(), modes, need, usable_of(there - before)));
}

void check_body(const scene::KernelRequest& request, OpenedMeshes& meshes, MPI_Comm comm,
                console::Console& console) {
  const mesh::GmshSession gmsh;
  if (request.body.imported() && holds_modes(request.body, comm)) {
    kernel_of_modes(request, comm, console);
    return;
  }
  console.begin(request.body.name + ": mesh, to check it");
  Source source = meshes.look(request);
  Discretised made = distributed(request, source, 1, true, comm, console);
  assemble(request, made, comm, console);
  modes::refuse_more_than_there_are(request.modes.count, made.matrices);
  console.end(fmt::format("{} unknowns", made.matrices.total_rows));
}

}  // namespace ricochet::kernel
