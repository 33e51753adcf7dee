// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/compute.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/memory.hpp"
#include "kernels/algebra.hpp"
#include "kernels/band.hpp"
#include "src/elasticity/rigid.hpp"
#include "src/kernel/discretise.hpp"
#include "src/kernel/imported_modes.hpp"
#include "src/mesh/extent.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/modes/search.hpp"
#include "src/modes/validate.hpp"
#include "src/reduction/contact_basis.hpp"
#include "src/reduction/coriolis.hpp"
#include "src/surface/mesh_error.hpp"
#include "src/surface/trace.hpp"

namespace ricochet::kernel {

namespace {

/// Shares of the requested flexibility error: for modes above the search, and for modes that are found but
/// left out.
constexpr double beyond_search = 0.5, left_out = 0.5;

/// What was planned for a search, from when on.
struct Planned {
  double mib = 0, seconds = 0, since = 0;

  /// What the search has needed, beside the plan; nothing if none was made. Collective.
  std::string met(MPI_Comm comm) const {
    if (seconds == 0) return "";
    return fmt::format("; {:.0f} of {:.0f} MiB planned, {} of {}",
                       parallel::largest(comm, console::peak_memory_mib()), mib,
                       console::duration_of(console::now() - since), console::duration_of(seconds));
  }
};

/// Computes modes or Ritz vectors, and the lifts of moving supports.
modes::ModeSet find_modes(const scene::KernelRequest& request, Discretised& made,
                          const std::filesystem::path& checkpoint, MPI_Comm comm, console::Console& console,
                          Planned& planned) {
  const scene::Modes& wanted = request.modes;
  const auto lift = [&](double sigma) {
    made.sources.lift = reduction::static_lift(*made.teams, made.mesh, made.matrices, *made.factor, sigma);
  };
  const bool fitted = wanted.basis == scene::Basis::contact || wanted.flexibility_error;
  if (fitted) lift(reduction::shift_near_zero(*wanted.up_to));
  const modes::Progress progress{
      .begin = [&](const std::string& phase) { console.begin(request.body.name + ": " + phase); },
      .counted =
          [&](std::int64_t modes, std::int64_t slices, double seconds) {
            check_memory(request, made, modes, slices, seconds, comm, console);
            planned = {needed_mib(request, made, modes, made.teams->count(), comm), seconds, console::now()};
          },
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
    return reduction::contact_basis(*made.teams, made.mesh, made.matrices, *made.factor, loads, pressed,
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
    up_to = reduction::needed_up_to(*made.teams, made.mesh, contact_basis(error, {}), loads, pressed,
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
void leave_to_flexibility(const scene::KernelRequest& request, kernels::Kernel& kernel) {
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

}  // namespace

kernels::Kernel compute(scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                        double view_mib, OpenedMeshes& meshes, MPI_Comm comm, console::Console& console) {
  const scene::Body& body = request.body;
  const mesh::GmshSession gmsh;
  if (body.imported() && holds_modes(body, comm)) {
    // Its surface is part of its file.
    if (static_cast<double>(std::filesystem::file_size(body.mesh)) <= view_mib * base::mib)
      request = scene::with_view(std::move(request));
    return kernel_of_modes(request, comm, console);
  }
  Discretised made = discretise(request, view_mib, meshes, comm, console);
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

  Planned planned;
  const modes::ModeSet modes = find_modes(request, made, checkpoint, comm, console, planned);
  console.end(summary_of(request, modes) + planned.met(comm));

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
  if (mesh.parts > 1 || elasticity::mechanisms(mesh) > 0)
    for (const mesh::Piece& piece : mesh.pieces) {
      kernel.piece_elements.push_back(piece.elements);
      kernel.piece_box.insert(kernel.piece_box.end(), piece.box.begin(), piece.box.end());
    }
  const bool fitted = request.modes.basis == scene::Basis::contact;
  kernel.modes.basis = fitted ? "contact" : "modes";
  kernel.modes.angular_frequency = modes.angular_frequency;
  kernel.modes.residual = modes.residual;
  kernel.modes.certificate = modes.certificate;
  kernel.modes.decay_rate = kernels::decay_rates(body.damping, modes.angular_frequency);
  if (!kernel.supported && mesh.dim == 3)
    kernel.modes.coriolis = reduction::coriolis(teams, matrices.mass, modes);
  const bool corrected = request.modes.residual_flexibility && patches.geometry.size() > 0;
  const surface::Correction form = !corrected                     ? surface::Correction::none
                                   : request.normal_residual      ? surface::Correction::normal
                                   : is_compressed(request, made) ? surface::Correction::compressed
                                                                  : surface::Correction::all;
  surface::trace(teams, mesh, matrices, *made.factor, modes, patches, made.loads, form, request.view, kernel,
                 made.sources, request.stress ? body.materials : std::vector<scene::Material>{},
                 [&](std::int64_t done, std::int64_t total) { console.advance(done, total); });
  if (fitted && corrected) move_above_band(*request.modes.up_to, kernel);
  if (request.mesh_error) {
    console.begin(body.name + ": error by the mesh");
    surface::estimate_mesh_error(
        teams, mesh, body.materials, matrices, *made.factor, modes, patches, made.loads, kernel,
        [&](std::int64_t done, std::int64_t total) { console.advance(done, total); });
  }
  if (request.modes.basis == scene::Basis::modes && request.modes.flexibility_error)
    leave_to_flexibility(request, kernel);
  if (request.turns) kernel = kernels::compacted(std::move(kernel));
  console.end(fmt::format("{} {} kept", kernel.modes.size(), fitted ? "vectors" : "modes"));
  return kernel;
}

}  // namespace ricochet::kernel
