// SPDX-License-Identifier: BSD-2-Clause
#include "src/programs/kernel_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <utility>

#include "base/atomic_file.hpp"
#include "kernels/band.hpp"
#include "kernels/write.hpp"
#include "src/accuracy/loop.hpp"
#include "src/mesh/extent.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/modes/contact_basis.hpp"
#include "src/modes/search.hpp"
#include "src/modes/validate.hpp"
#include "src/programs/discretise.hpp"
#include "src/programs/imported_modes.hpp"
#include "src/programs/kernel_candidates.hpp"
#include "src/programs/verify_run.hpp"
#include "src/scene/derive.hpp"
#include "src/scene/read.hpp"
#include "src/scene/write.hpp"
#include "src/store/body_warnings.hpp"
#include "src/surface/trace.hpp"

namespace ricochet {

namespace {

/// Shares of the requested flexibility error: for modes above the search, and for modes that are found but
/// left out.
constexpr double beyond_search = 0.5, left_out = 0.5;

/// Computes modes or Ritz vectors, and the lifts of moving supports.
modes::ModeSet find_modes(const scene::KernelRequest& request, Discretised& made,
                          const std::filesystem::path& checkpoint, MPI_Comm comm, console::Console& console) {
  const scene::Modes& wanted = request.modes;
  const auto lift = [&](double sigma) {
    made.sources.lift = modes::static_lift(*made.teams, made.mesh, made.matrices, *made.factor, sigma);
  };
  const bool fitted = wanted.basis == scene::Basis::contact || wanted.flexibility_error;
  if (fitted) lift(modes::shift_near_zero(*wanted.up_to));
  const modes::Progress progress{
      .begin = [&](const std::string& phase) { console.begin(request.body.name + ": " + phase); },
      .counted = [&](std::int64_t modes) { check_memory(request, made, modes, comm, console); },
      .at = [&](std::int64_t done, std::int64_t total) { console.advance(done, total); }};
  const Eigen::Index pressed = made.pressed.cols();
  Eigen::MatrixXd loads;
  if (fitted) {
    // Gravity also moves the surface of a supported body. A moving support acts through the inertia of its
    // lift.
    const surface::Sources& sources = made.sources;
    loads.resize(made.pressed.rows(),
                 pressed + 3 + sources.receiver.cols() + sources.load.cols() + sources.lift.inertia.cols());
    loads.leftCols(pressed) = made.pressed;
    loads.rightCols(loads.cols() - pressed) << made.matrices.rigid_load.leftCols(3), sources.receiver,
        sources.load, sources.lift.inertia;
  }
  const auto contact_basis = [&](double error, std::optional<std::int64_t> count) {
    return modes::contact_basis(*made.teams, made.mesh, made.matrices, *made.factor, loads, pressed,
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
    // A contact-adapted basis determines up to which frequency modes are needed.
    const double error = beyond_search * *wanted.flexibility_error;
    up_to = modes::needed_up_to(*made.teams, made.mesh, contact_basis(error, {}), loads, pressed,
                                *wanted.up_to, error);
  }
  modes::ModeSet modes = modes::compute_modes(*made.teams, made.mesh, made.matrices, *made.factor,
                                              {.up_to = up_to,
                                               .count = wanted.count,
                                               .relative_residual = wanted.relative_residual,
                                               .modes_per_shift = made.modes_per_shift,
                                               .checkpoint = checkpoint,
                                               .eps_type = wanted.solver},
                                              progress);
  if (!fitted) lift(modes.static_shift);
  return modes;
}

std::string summary_of(const scene::KernelRequest& request, const modes::ModeSet& modes) {
  const std::size_t n = modes.angular_frequency.size();
  if (request.modes.basis == scene::Basis::modes)
    return fmt::format("{} modes up to {:.6g} Hz, count proved", n, modes.certificate.upto_hz);
  return fmt::format("{} vectors, flexibility up to {:.6g} Hz within {:.2g}", n, request.modes.up_to->value,
                     modes.certificate.flexibility_error);
}

/// Removes the modes that contact does not need; their static response moves to the residual flexibility.
void leave_to_residual(const scene::KernelRequest& request, kernels::Kernel& kernel) {
  const double error = *request.modes.flexibility_error;
  const auto found = static_cast<std::int64_t>(kernel.modes.size());
  const double made = kernels::truncate_least_contributing(
      kernel, static_cast<RadPerSecond>(*request.modes.up_to), left_out * error);
  kernel.modes.certificate.left_out = found - static_cast<std::int64_t>(kernel.modes.size());
  kernel.modes.certificate.flexibility_error = made + beyond_search * error;
}

/// Moves the vectors of a contact-adapted basis above its band to the residual flexibility. They carry static
/// flexibility, not motion, and chatter in flat contact if a time step is short enough to resolve them.
void move_above_band(Hertz band, kernels::Kernel& kernel) {
  const std::size_t found = kernel.modes.size();
  kernel = kernels::truncated_above(std::move(kernel), RadPerSecond(band));
  kernel.modes.certificate.left_out = static_cast<std::int64_t>(found - kernel.modes.size());
}

/// Computes the kernel of one body from its mesh, on all ranks. Rank 0 returns the whole kernel; other ranks
/// return it without the visualisation surface. Collective.
/// @param checkpoint  folder of finished slices, read and extended
/// Throws InputError on every rank, or SolverError.
kernels::Kernel compute_kernel(const scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                               OpenedMeshes& meshes, MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const mesh::GmshSession gmsh;
  if (body.imported() && holds_modes(body, comm)) return kernel_of_modes(request, comm, console);
  Discretised made = discretise(request, meshes, comm, console);
  const parallel::Teams& teams = *made.teams;
  const mesh::Mesh& mesh = made.mesh;
  const elasticity::Body& matrices = made.matrices;
  if (body.imported()) {
    console.begin(body.name + ": inertia of the matrices");
    parallel::on_all_ranks(
        comm, [&] { modes::validate_matrices(mesh, matrices, *made.factor, body.mesh.string()); });
    console.end("definite; rigid modes counted");
  }

  console.begin(body.name + ": candidates");
  const surface::Patches& patches = made.patches;
  console.end(request.points ? fmt::format("{} of {} within reach", patches.geometry.size(), made.candidates)
                             : fmt::format("{} on the contact surface", made.candidates));

  const modes::ModeSet modes = find_modes(request, made, checkpoint, comm, console);
  console.end(summary_of(request, modes));

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
  kernel.outline = mesh::outline_of(mesh);
  kernel.held_on_lines = mesh::held_on_lines(mesh);
  if (mesh.total_elements > 0) kernel.parts = mesh.parts;
  const bool fitted = request.modes.basis == scene::Basis::contact;
  kernel.modes.basis = fitted ? "contact" : "modes";
  kernel.modes.angular_frequency = modes.angular_frequency;
  kernel.modes.residual = modes.residual;
  kernel.modes.certificate = modes.certificate;
  kernel.modes.decay_rate = kernels::decay_rates(body.damping, modes.angular_frequency);
  const bool residual = request.modes.residual_flexibility && patches.geometry.size() > 0;
  const surface::Residual form = !residual                 ? surface::Residual::none
                                 : request.normal_residual ? surface::Residual::normal
                                                           : surface::Residual::all;
  surface::trace(teams, mesh, matrices, *made.factor, modes, patches, made.loads, form, request.view, kernel,
                 made.sources);
  if (request.modes.basis == scene::Basis::modes && request.modes.flexibility_error)
    leave_to_residual(request, kernel);
  if (fitted && residual) move_above_band(*request.modes.up_to, kernel);
  console.end(fmt::format("{} {} kept", kernel.modes.size(), fitted ? "vectors" : "modes"));
  return kernel;
}

/// Prints mass, size and wave speed of a body, and warnings about them.
void report_body(const scene::Body& body, const kernels::Kernel& kernel, console::Console& console) {
  console.say(fmt::format("{}: {}", body.name, store::figures_of(body, kernel)));
  for (const std::string& warning : store::warnings_of(body, kernel)) console.warn(warning);
}

/// Derives the kernel from another one in the folder, if one is suitable, and writes it. Collective. @return
/// a note for the user; empty if the kernel must be computed
std::string derive_if_possible(const scene::KernelRequest& request, const std::filesystem::path& folder,
                               const std::filesystem::path& path, MPI_Comm comm, console::Console& console) {
  std::string from;
  parallel::on_first_rank(comm, [&] {
    const auto derived = scene::derive_from_any(folder, request);
    if (!derived) return;
    kernels::write(derived->kernel, path);
    report_body(request.body, derived->kernel, console);
    from = fmt::format("derived from {}: ", derived->from.filename().string());
  });
  parallel::broadcast(comm, from);
  return from;
}

/// The folder of finished slices. It is kept until the kernel is written, so that an interrupted run can be
/// resumed.
std::filesystem::path checkpoint_of(std::filesystem::path kernel) {
  return kernel.replace_extension().replace_extension(".slices");
}

void forget(const std::filesystem::path& checkpoint) {
  std::error_code ignored;
  std::filesystem::remove_all(checkpoint, ignored);
}

/// Computes the kernels of a closed scene that are not there yet. Collective.
/// @param check  whether to check all bodies before the first one is computed
/// @return the files written
std::vector<std::filesystem::path> compute_kernels(const scene::Scene& scene, bool check,
                                                   const console::Options& options, MPI_Comm comm,
                                                   console::Console& console) {
  const bool first = parallel::rank_of(comm) == 0;
  std::vector<scene::KernelRequest> requests;
  parallel::on_all_ranks(comm, [&] {
    for (const scene::Body& body : scene.bodies) requests.push_back(scene::kernel_request(scene, body));
  });
  OpenedMeshes meshes(comm, console);
  const std::vector<Need> needs = needs_of(scene, requests, options.out, meshes, comm, console);
  const auto stored = [&](std::size_t k) {
    std::string found;
    if (first)
      for (const store::KernelFile& file : store::kernel_files(options.out, requests[k]))
        if (found.empty() && file.holds(needs[k].points, needs[k].normals)) found = file.path.string();
    parallel::broadcast(comm, found);
    return found;
  };
  const auto check_missing = [&](std::size_t from) {
    for (std::size_t k = from; k < scene.bodies.size(); ++k) {
      const auto alike = [&](const scene::KernelRequest& other) {
        return other.hash == requests[k].hash || scene::similarity(other, requests[k]);
      };
      const auto earlier = requests.begin() + static_cast<std::ptrdiff_t>(k);
      if (std::none_of(requests.begin(), earlier, alike) && stored(k).empty())
        check_body(requests[k], meshes, comm, console);
    }
  };
  std::vector<std::filesystem::path> written;
  if (options.check) {
    check_missing(0);
    return written;
  }
  // Errors of later bodies are reported early.
  auto check_later = [&, checked = !check](std::size_t k) mutable {
    if (!std::exchange(checked, true)) check_missing(k + 1);
  };
  for (std::size_t k = 0; k < requests.size(); ++k) {
    scene::KernelRequest request = limited_to(requests[k], needs[k]);
    const std::string there = stored(k);
    if (!there.empty() && !scene.bodies[k].copy_of.empty()) continue;
    if (!there.empty()) {
      if (first) forget(checkpoint_of(there));
      console.say(fmt::format("{}: already there: {}", request.body.name, there));
      continue;
    }
    std::filesystem::path path = scene::kernel_path(options.out, request);
    parallel::on_first_rank(comm, [&] { base::check_place(path); });
    const std::string from = derive_if_possible(request, options.out, path, comm, console);
    if (from.empty()) {
      request = limited_to(requests[k], worth_computing(requests, needs, k));
      path = scene::kernel_path(options.out, request);
    }
    const std::filesystem::path checkpoint = checkpoint_of(path);
    if (from.empty()) {
      check_later(k);
      const kernels::Kernel kernel = compute_kernel(request, checkpoint, meshes, comm, console);
      parallel::on_first_rank(comm, [&] { kernels::write(kernel, path); });
      if (first && check) report_body(request.body, kernel, console);
    }
    written.push_back(path);
    if (first) forget(checkpoint);
    console.say(fmt::format("{}: {}{}", request.body.name, from, path.string()));
  }
  return written;
}

}  // namespace

int run_kernel(const console::Options& options, MPI_Comm comm) {
  const bool first = parallel::rank_of(comm) == 0;
  scene::Scene scene;
  parallel::on_all_ranks(comm, [&] {  // the scene file is small, so each rank reads it
    scene = scene::read(options.scene, options.overrides, scene::Purpose::kernels);
  });
  if (options.dry_run) {
    if (first) std::cout << scene::to_toml(scene);
    return 0;
  }
  if (options.verify) {
    console::Console console(options.quiet || !first);
    return verify_kernels(scene, options, comm, console);
  }
  // Refuses invalid histories before the computation starts.
  parallel::on_first_rank(comm, [&] { store::forcing_of(scene); });

  console::Console console(options.quiet || !first,
                           [comm] { return parallel::largest(comm, console::peak_memory_mib()); });
  if (scene.bodies.empty()) console.say("the scene takes its kernels from contact.table: nothing to compute");
  const auto compute = [&](const scene::Scene& closed, bool check) {
    return compute_kernels(closed, check, options, comm, console);
  };
  if (!scene.accuracy)
    compute(scene, true);
  else if (options.check)
    compute(accuracy::closed_for_check(scene, comm), true);
  else
    accuracy::close_by_accuracy(scene, options.out, comm, console, compute);
  // The peak memory of each phase is the maximum over the ranks.
  console.total();
  return 0;
}

}  // namespace ricochet
