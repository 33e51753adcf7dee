#include "src/programs/kernel_run.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <set>
#include <string_view>

#include "src/mesh/gmsh_session.hpp"
#include "src/modes/search.hpp"
#include "src/parallel/memory.hpp"
#include "src/surface/surface.hpp"

namespace ricochet {

namespace {

std::vector<std::string> geometry_numbers(const scene::Body& body) {
  std::vector<std::string> numbers;
  for (const auto& [name, value] : body.geometry) {
    numbers.push_back(name);
    numbers.push_back(fmt::format("{}", value));
  }
  return numbers;
}

/// δ of a mode with angular frequency ω, by the body's law of damping.
double decay_rate(const scene::Damping& damping, double omega) {
  using Law = scene::Damping::Law;
  switch (damping.law) {
    case Law::none:
      return 0;
    case Law::ratio:
      return damping.first * omega;
    case Law::loss_factor:
      return damping.first / 2 * omega;
    case Law::rayleigh:
      return (damping.first + damping.second * omega * omega) / 2;
    case Law::viscosity:
      return damping.first * omega * omega / 2;
  }
  return 0;
}

}  // namespace

namespace {

/// A body on every team of ranks, its factorisation analysed.
struct Discretised {
  std::unique_ptr<parallel::Teams> teams;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  std::unique_ptr<modes::Factorisation> factor;
};

/// As many teams as memory has room for: ranks that work at slices of their own, each with all of the body,
/// are faster than ranks that share one. Throws InputError when there is not even room for one team.
Discretised discretise(const scene::KernelRequest& request, MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const std::string file = body.mesh.filename().string();
  const auto bar = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); };
  console.begin(body.name + ": mesh");
  mesh::GlobalMesh global;
  parallel::on_first_rank(comm, [&] { global = mesh::read_mesh(body, bar); });
  const int ranks = parallel::size_of(comm);
  for (int count = ranks;; --count) {
    if (ranks % count != 0) continue;
    Discretised made{std::make_unique<parallel::Teams>(comm, count), {}, {}, {}};
    const parallel::Teams& teams = *made.teams;
    // Fewer teams may have to be tried.
    mesh::GlobalMesh copy = count > 1 ? global : std::move(global);
    if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(copy, teams.peers());
    made.mesh = mesh::distribute(std::move(copy), teams.team());
    console.end(fmt::format("{} elements, {} nodes", made.mesh.total_elements, made.mesh.total_nodes));

    console.begin(body.name + ": assembly");
    made.matrices = elasticity::assemble(made.mesh, body.materials, file, bar);
    made.factor = std::make_unique<modes::Factorisation>(made.matrices.stiffness, made.matrices.mass);
    const double need = parallel::largest(comm, modes::expected_mib(*made.factor, made.matrices.local_rows,
                                                                    request.modes.count.value_or(0), count));
    const double room = parallel::available_mib(comm);
    console.end(
        fmt::format("{} unknowns; {:.0f} MiB needed of {:.0f} a rank", made.matrices.total_rows, need, room));
    // Delayed pivots and buffers come on top.
    if (need <= 0.8 * room) return made;
    if (count == 1)
      throw InputError(
          fmt::format("{}: its factorisation would need {:.0f} MiB a rank, {:.0f} are free: use more "
                      "machines, a coarser mesh or "
                      "fewer modes",
                      file, need, room));
    console.begin(body.name + ": mesh, for fewer teams");
  }
}

}  // namespace

kernels::Kernel compute_kernel(const scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                               MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const mesh::GmshSession gmsh(geometry_numbers(body));
  const Discretised made = discretise(request, comm, console);
  const parallel::Teams& teams = *made.teams;
  const mesh::Mesh& mesh = made.mesh;
  const elasticity::Body& matrices = made.matrices;

  console.begin(body.name + ": candidates");
  const surface::Patches patches = surface::make_patches(
      mesh, body.contact,
      {.direction = request.direction, .along = request.along, .spacing = request.spacing});
  console.end(fmt::format("{} on the contact surface", patches.geometry.size()));

  const modes::ModeSet modes = modes::compute_modes(
      teams, mesh, matrices, *made.factor,
      {.up_to = request.modes.up_to,
       .count = request.modes.count,
       .relative_residual = request.modes.relative_residual,
       .checkpoint = checkpoint},
      {.begin = [&](const std::string& phase) { console.begin(body.name + ": " + phase); },
       .at = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); }});
  console.end(fmt::format("{} modes up to {:.6g} Hz, count proved", modes.angular_frequency.size(),
                          modes.certificate.upto_hz));

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
  kernel.modes.angular_frequency = modes.angular_frequency;
  kernel.modes.residual = modes.residual;
  kernel.modes.certificate = modes.certificate;
  for (double omega : modes.angular_frequency)
    kernel.modes.decay_rate.push_back(decay_rate(body.damping, omega));
  surface::trace(teams, mesh, matrices, *made.factor, modes, patches, request.modes.residual_flexibility,
                 request.view, kernel);
  console.end();
  return kernel;
}

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
  for (const scene::KernelRequest& request : requests) {
    const std::filesystem::path path = scene::kernel_path(options.out, request);
    std::vector<char> there{first && kernels::read_hash(path) == request.hash};
    parallel::broadcast(comm, there);
    if (there[0] != 0) {
      console.say(fmt::format("{}: already there: {}", request.body.name, path.string()));
      continue;
    }
    // Kept until the kernel is there: a run that was killed goes on from it.
    std::filesystem::path checkpoint = path;
    checkpoint.replace_extension().replace_extension(".slices");
    const kernels::Kernel kernel = compute_kernel(request, checkpoint, comm, console);
    parallel::on_first_rank(comm, [&] {
      kernels::write(kernel, path);
      std::error_code ignored;
      std::filesystem::remove_all(checkpoint, ignored);
    });
    console.say(fmt::format("{}: {}", request.body.name, path.string()));
  }
  // Peak memory is that of the rank that needed most.
  if (!console.phases().empty()) console.say(console::Console::table(console.phases()));
  return 0;
}

}  // namespace ricochet
