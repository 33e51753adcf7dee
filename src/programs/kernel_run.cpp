#include "src/programs/kernel_run.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <set>
#include <string_view>

#include "kernels/band.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/parts.hpp"
#include "src/modes/approximate.hpp"
#include "src/modes/contact_basis.hpp"
#include "src/modes/search.hpp"
#include "src/parallel/memory.hpp"
#include "src/programs/choose_modes.hpp"
#include "src/programs/kernel_candidates.hpp"
#include "src/scene/derive.hpp"

namespace ricochet {

namespace {

/// A body on every team of ranks, its factorisation analysed.
struct Discretised {
  std::unique_ptr<parallel::Teams> teams;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  std::unique_ptr<modes::Factorisation> factor;
  surface::Sources sources;          ///< loads with histories, moving supports, receivers
  std::int64_t modes_per_shift = 0;  ///< for the search for modes
};

/// Rank 0's mesh split among the ranks of each team. Collective over all teams.
mesh::Mesh hand_out(mesh::GlobalMesh whole, const parallel::Teams& teams) {
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(whole, teams.peers());
  return mesh::distribute(std::move(whole), teams.team());
}

/// The parts of a split mesh, read by each team. Collective over all teams.
mesh::Mesh read_parts(const scene::Body& body, const mesh::Asked& asked, const parallel::Teams& teams,
                      const parallel::Progress& progress) {
  mesh::Mesh mesh;
  std::string complaint;
  try {
    mesh = mesh::read_parts(body, teams.team(), progress, asked);
  } catch (const InputError& error) {
    complaint = error.what();
  }
  // A file may be out of reach of one team only.
  parallel::agree(teams.world(), complaint);
  return mesh;
}

/// Memory of the search for modes on this rank [MiB].
double expected_mib(const scene::Modes& wanted, const Discretised& made, std::int64_t per_shift, int teams) {
  const std::int64_t count = wanted.count.value_or(0), rows = made.matrices.local_rows;
  if (wanted.approximate > 0) return modes::expected_approximate_mib(*made.factor, rows, count, teams);
  return modes::expected_mib(*made.factor, rows, count, per_shift, teams);
}

/// As many teams as memory has room for: ranks that work at slices of their own, each with all of the body,
/// are faster than ranks that share one. Where room is short, slices become smaller. Vectors fitted to
/// contact need few factorisations, which ranks share better. Throws InputError when there is not even room
/// for one team.
Discretised discretise(const scene::KernelRequest& request, MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const std::string file = body.mesh.filename().string();
  const auto bar = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); };
  console.begin(body.name + ": mesh");
  const mesh::Asked asked = surface::asked_of(request);
  std::vector<std::string> moved;
  for (const std::string& support : asked.moved) moved.push_back(body.support.at(support));
  Source source = open_source(body, asked, comm, bar);
  const int ranks = parallel::size_of(comm);
  const int most = request.modes.basis == scene::Basis::contact ? 1 : ranks;
  for (int count = most;; --count) {
    if (ranks % count != 0) continue;
    Discretised made{std::make_unique<parallel::Teams>(comm, count), {}, {}, {}, {}};
    const parallel::Teams& teams = *made.teams;
    if (source.in_parts)
      made.mesh = read_parts(body, asked, teams, bar);
    else  // Fewer teams may have to be tried.
      made.mesh = hand_out(count > 1 ? source.whole : std::move(source.whole), teams);
    console.end(fmt::format("{} elements, {} nodes", made.mesh.total_elements, made.mesh.total_nodes));

    if (request.modes.approximate > 0 && made.mesh.order < 2)
      throw InputError(
          fmt::format("{}: modes.approximate = {}: elements of order 1 have no lower order to start from: "
                      "raise the order, "
                      "or leave it out",
                      file, request.modes.approximate));

    console.begin(body.name + ": assembly");
    made.sources = surface::make_sources(made.mesh, request);
    made.matrices = elasticity::assemble(made.mesh, body.materials, file, bar, moved);
    made.factor = std::make_unique<modes::Factorisation>(made.matrices.stiffness, made.matrices.mass,
                                                         request.modes.low_rank);
    const double room = parallel::available_mib(comm);
    // Delayed pivots and buffers come on top of what is expected.
    constexpr double usable = 0.85;
    double need = 0;
    for (const std::int64_t per_shift : {260, 130, 65}) {
      made.modes_per_shift = per_shift;
      need = parallel::largest(comm, expected_mib(request.modes, made, per_shift, count));
      if (need <= usable * room || (per_shift == 130 && count > 1)) break;
    }
    console.end(
        fmt::format("{} unknowns; {:.0f} MiB needed of {:.0f} a rank", made.matrices.total_rows, need, room));
    if (need <= usable * room) return made;
    if (count == 1)
      throw InputError(
          fmt::format("{}: its factorisation would need {:.0f} MiB a rank, {:.0f} are free: use more "
                      "machines, a coarser mesh or "
                      "fewer modes",
                      file, need, room));
    console.begin(body.name + ": mesh, for fewer teams");
  }
}

/// Of the flexibility error asked for from modes: what may come from those above the search, and from those
/// left out of what it found.
constexpr double beyond_search = 0.5, left_out = 0.5;

/// Modes or vectors, and the lifts of supports that move.
modes::ModeSet find_modes(const scene::KernelRequest& request, Discretised& made,
                          const Eigen::MatrixXd& loads, const std::filesystem::path& checkpoint,
                          console::Console& console) {
  const scene::Modes& wanted = request.modes;
  const auto lift = [&](double sigma) {
    made.sources.lift = modes::static_lift(*made.teams, made.mesh, made.matrices, *made.factor, sigma);
  };
  const bool fitted = wanted.basis == scene::Basis::contact || wanted.flexibility_error;
  if (fitted) lift(modes::shift_near_zero(*wanted.up_to));
  const modes::Progress progress{
      .begin = [&](const std::string& phase) { console.begin(request.body.name + ": " + phase); },
      .at = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); }};
  const auto contact_basis = [&](double error, std::optional<std::int64_t> count) {
    // Gravity moves a supported body's surface too; a support that moves, by the inertia of its lift.
    const surface::Sources& sources = made.sources;
    Eigen::MatrixXd all(loads.rows(), loads.cols() + 3 + sources.receiver.cols() + sources.load.cols() +
                                          sources.lift.inertia.cols());
    all << loads, made.matrices.rigid_load.leftCols(3), sources.receiver, sources.load, sources.lift.inertia;
    return modes::contact_basis(*made.teams, made.mesh, made.matrices, *made.factor, all, loads.cols(),
                                {.band = *wanted.up_to,
                                 .flexibility_error = error,
                                 .count = count,
                                 .residual_flexibility = wanted.residual_flexibility},
                                progress);
  };
  if (wanted.basis == scene::Basis::contact)
    return contact_basis(wanted.flexibility_error.value_or(0), wanted.count);
  std::optional<Hertz> up_to = wanted.up_to;
  if (wanted.flexibility_error) {
    // The vectors fitted to contact tell how far up modes matter.
    const double error = beyond_search * *wanted.flexibility_error;
    up_to = modes::needed_up_to(*made.teams, made.mesh, contact_basis(error, {}), loads, loads.cols(),
                                *wanted.up_to, error);
  }
  if (wanted.approximate > 0) {
    modes::ModeSet modes = modes::approximate_modes(
        *made.teams, made.mesh, made.matrices, *made.factor, request.body.materials,
        request.body.mesh.filename().string(),
        {.up_to = wanted.up_to, .count = wanted.count, .iterations = wanted.approximate}, progress);
    lift(modes.static_shift);
    return modes;
  }
  modes::ModeSet modes = modes::compute_modes(*made.teams, made.mesh, made.matrices, *made.factor,
                                              {.up_to = up_to,
                                               .count = wanted.count,
                                               .relative_residual = wanted.relative_residual,
                                               .modes_per_shift = made.modes_per_shift,
                                               .checkpoint = checkpoint},
                                              progress);
  if (!fitted) lift(modes.static_shift);
  return modes;
}

std::string told(const scene::KernelRequest& request, const modes::ModeSet& modes) {
  const std::size_t n = modes.angular_frequency.size();
  if (request.modes.basis == scene::Basis::modes)
    return fmt::format("{} {}modes up to {:.6g} Hz, count proved", n, modes.exact ? "" : "approximate ",
                       modes.certificate.upto_hz);
  return fmt::format("{} vectors, flexibility up to {:.6g} Hz within {:.2g}", n, request.modes.up_to->value,
                     modes.certificate.flexibility_error);
}

/// Takes out of a kernel the modes that contact does not need.
void leave_to_residual(const scene::KernelRequest& request, kernels::Kernel& kernel) {
  const double error = *request.modes.flexibility_error;
  const auto found = static_cast<std::int64_t>(kernel.modes.size());
  const double made =
      kernels::keep_contributing(kernel, static_cast<RadPerSecond>(*request.modes.up_to), left_out * error);
  kernel.modes.certificate.left_out = found - static_cast<std::int64_t>(kernel.modes.size());
  kernel.modes.certificate.flexibility_error = made + beyond_search * error;
}

}  // namespace

kernels::Kernel compute_kernel(const scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                               MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const mesh::GmshSession gmsh;
  Discretised made = discretise(request, comm, console);
  const parallel::Teams& teams = *made.teams;
  const mesh::Mesh& mesh = made.mesh;
  const elasticity::Body& matrices = made.matrices;

  console.begin(body.name + ": candidates");
  surface::Patches patches = patches_of(request, mesh);
  const std::size_t all = patches.geometry.size();
  if (request.points) surface::keep(patches, *request.points);
  console.end(request.points ? fmt::format("{} of {} within reach", patches.geometry.size(), all)
                             : fmt::format("{} on the contact surface", all));

  Eigen::MatrixXd loads = surface::patch_loads(mesh, patches);
  const modes::ModeSet modes = find_modes(request, made, loads, checkpoint, console);
  console.end(told(request, modes));

  console.begin(body.name + ": trace");
  kernels::Kernel kernel;
  kernel.body = body.name;
  kernel.hash = request.hash;
  kernel.scene = request.toml;
  kernel.mesh_sha256 = request.mesh_sha256;
  kernel.created_by = "ricochet-kernel " RICOCHET_VERSION;
  kernel.dofs = matrices.free_rows;
  kernel.elements = mesh.total_elements;
  kernel.order = mesh.order;
  kernel.mass = matrices.total_mass;
  kernel.centre = matrices.centre;
  kernel.inertia = matrices.inertia;
  kernel.supported = matrices.free_rows < matrices.total_rows;
  const bool fitted = request.modes.basis == scene::Basis::contact;
  kernel.modes.basis = fitted ? "contact" : "modes";
  kernel.modes.angular_frequency = modes.angular_frequency;
  kernel.modes.residual = modes.residual;
  kernel.modes.certificate = modes.certificate;
  for (double omega : modes.angular_frequency)
    kernel.modes.decay_rate.push_back(kernels::decay_rate(body.damping, RadPerSecond{omega}));
  surface::trace(teams, mesh, matrices, *made.factor, modes, patches, std::move(loads),
                 request.modes.residual_flexibility, request.view, kernel, made.sources);
  if (request.modes.basis == scene::Basis::modes && request.modes.flexibility_error)
    leave_to_residual(request, kernel);
  console.end(fmt::format("{} {} kept", kernel.modes.size(), fitted ? "vectors" : "modes"));
  return kernel;
}

namespace {

/// Writes the kernel from another one in the folder, when one allows it. @return what to say of it;
/// empty when the kernel has to be computed. Collective.
std::string derive_if_possible(const scene::KernelRequest& request, const std::filesystem::path& folder,
                               const std::filesystem::path& path, MPI_Comm comm) {
  std::string from;
  parallel::on_first_rank(comm, [&] {
    const auto derived = scene::derive_from_any(folder, request);
    if (!derived) return;
    kernels::write(derived->kernel, path);
    from = fmt::format("derived from {}: ", derived->from.filename().string());
  });
  parallel::broadcast(comm, from);
  return from;
}

}  // namespace

int run_kernel(const console::Options& options, MPI_Comm comm) {
  const bool first = parallel::rank_of(comm) == 0;
  scene::Scene scene;
  // Each rank reads the small scene file; the complaint of one is the complaint of all.
  std::string complaint;
  std::vector<scene::KernelRequest> requests;
  try {
    scene = scene::read(options.scene, options.overrides);
    if (!options.dry_run)
      for (const scene::Body& body : scene.bodies) requests.push_back(scene::kernel_request(scene, body));
  } catch (const InputError& error) {
    complaint = error.what();
  }
  parallel::agree(comm, complaint);
  if (options.dry_run) {
    if (first) std::cout << scene::to_toml(scene);
    return 0;
  }
  parallel::on_first_rank(comm, [&] {
    std::error_code failure;
    std::filesystem::create_directories(options.out, failure);
    if (failure)
      throw InputError(fmt::format("{}: can't make this folder ({}): choose another with --out",
                                   options.out.string(), failure.message()));
  });

  console::Console console(options.quiet || !first,
                           [comm] { return parallel::largest(comm, console::peak_memory_mib()); });
  if (requests.empty()) console.say("the scene takes its kernels from contact.table: nothing to compute");
  std::vector<Points> points = needed_points(scene, requests, options.out, comm, console);
  // The error of the mesh is estimated from another order, with all candidates; these may fail.
  if (scene.accuracy)
    for (std::size_t k = 0; k < scene.bodies.size(); ++k)
      if (const auto other = scene::other_order(requests[k])) {
        requests.push_back(*other);
        points.push_back({});
      }
  std::optional<scene::Modes> chosen;
  for (std::size_t k = 0; k < requests.size(); ++k) {
    scene::KernelRequest request = with_points(requests[k], points[k]);
    std::string there;
    if (first)
      for (const programs::KernelFile& file : programs::kernel_files(options.out, requests[k]))
        if (there.empty() && file.holds(points[k])) there = file.path.string();
    parallel::broadcast(comm, there);
    if (!there.empty()) {
      console.say(fmt::format("{}: already there: {}", request.body.name, there));
      continue;
    }
    std::filesystem::path path = scene::kernel_path(options.out, request);
    const std::string from = derive_if_possible(request, options.out, path, comm);
    if (from.empty()) {
      request = with_points(requests[k], worth_computing(requests, points, k));
      path = scene::kernel_path(options.out, request);
    }
    // Kept until the kernel is there: a run that was killed goes on from it.
    std::filesystem::path checkpoint = path;
    checkpoint.replace_extension().replace_extension(".slices");
    if (from.empty()) {
      if (request.modes.accuracy) {
        if (!chosen) chosen = chosen_modes(scene, comm);
        request.modes = *chosen;
      }
      try {
        const kernels::Kernel kernel = compute_kernel(request, checkpoint, comm, console);
        parallel::on_first_rank(comm, [&] { kernels::write(kernel, path); });
      } catch (const InputError& error) {  // the same on every rank
        if (k < scene.bodies.size()) throw;
        if (first)
          console.warn(
              fmt::format("in elements of order {}, from which the error of the mesh is estimated: {}",
                          request.body.order, error.what()));
        continue;
      }
    }
    if (first) {
      std::error_code ignored;
      std::filesystem::remove_all(checkpoint, ignored);
    }
    console.say(fmt::format("{}: {}{}", request.body.name, from, path.string()));
  }
  // Peak memory is that of the rank that needed most.
  if (!console.phases().empty()) console.say(console::Console::table(console.phases()));
  return 0;
}

}  // namespace ricochet
