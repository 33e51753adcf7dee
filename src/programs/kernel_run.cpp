#include "src/programs/kernel_run.hpp"

#include <fmt/format.h>

#include <iostream>
#include <set>
#include <string_view>

#include "src/mesh/gmsh_session.hpp"
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

kernels::Kernel compute_kernel(const scene::KernelRequest& request, MPI_Comm comm,
                               console::Console& console) {
  const scene::Body& body = request.body;
  const std::string file = body.mesh.filename().string();
  const mesh::GmshSession gmsh(geometry_numbers(body));

  const auto bar = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); };
  console.begin(body.name + ": mesh");
  mesh::GlobalMesh global;
  parallel::on_first_rank(comm, [&] { global = mesh::read_mesh(body, bar); });
  // Each rank works at slices of its own, with all of the body.
  const parallel::Teams teams(comm, parallel::size_of(comm));
  if (parallel::rank_of(teams.team()) == 0) mesh::broadcast(global, teams.peers());
  const mesh::Mesh mesh = mesh::distribute(std::move(global), teams.team());
  console.end(fmt::format("{} elements, {} nodes", mesh.total_elements, mesh.total_nodes));

  console.begin(body.name + ": assembly");
  const elasticity::Body matrices = elasticity::assemble(mesh, body.materials, file, bar);
  const surface::Patches patches = surface::make_patches(
      mesh, body.contact,
      {.direction = request.direction, .along = request.along, .spacing = request.spacing});
  console.end(fmt::format("{} unknowns, {} candidates", matrices.total_rows, patches.geometry.size()));

  const modes::ModeSet modes = modes::compute_modes(
      teams, mesh, matrices,
      {.up_to = request.modes.up_to,
       .count = request.modes.count,
       .relative_residual = request.modes.relative_residual},
      {.begin = [&](const std::string& phase) { console.begin(body.name + ": " + phase); }, .at = bar});
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
  surface::trace(teams, mesh, matrices, modes, patches, request.modes.residual_flexibility, request.view,
                 kernel);
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
    const kernels::Kernel kernel = compute_kernel(request, comm, console);
    parallel::on_first_rank(comm, [&] { kernels::write(kernel, path); });
    console.say(fmt::format("{}: {}", request.body.name, path.string()));
  }
  // Peak memory is that of the rank that needed most.
  if (!console.phases().empty()) console.say(console::Console::table(console.phases()));
  return 0;
}

}  // namespace ricochet
