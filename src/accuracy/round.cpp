// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/round.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/expected_modes.hpp"
#include "src/scene/elastic_law.hpp"
#include "src/store/memory.hpp"

namespace ricochet::accuracy {

namespace {

/// Modes of a body in a band. Those of a contact-adapted basis are not known and are estimated.
double modes_in_band(const scene::Scene& scene, std::size_t k, const kernels::Kernel& kernel, Hertz band) {
  const auto found = static_cast<double>(kernel.modes.size());
  const double wave = scene::wave_speeds(scene.bodies[k]).mean;
  if (scene.modes.basis == scene::Basis::modes || wave == 0) return found;
  const double omega = RadPerSecond(band).value;
  return std::max(
      found, kernels::expected_count(kernels::box_of(kernel.mass, kernel.inertia), wave,
                                     scene::mean_poisson(scene.bodies[k].materials.front()))(omega * omega));
}

/// Smallest side of a box with the inertia of a body [m].
double width_of(const kernels::Kernel& kernel) {
  const Eigen::Map<const Eigen::Matrix3d> inertia(kernel.inertia.data());
  const Eigen::Matrix3d second = inertia.trace() / 2 * Eigen::Matrix3d::Identity() - inertia;  // ∫ ρ x xᵀ dV
  return std::sqrt(12 * std::max(0.0, second.selfadjointView<Eigen::Lower>().eigenvalues()[0]) / kernel.mass);
}

}  // namespace

PairedRound pair_round(scene::Scene scene, const std::filesystem::path& folder) {
  store::KernelStore store;
  PairedRound out{.scene = std::move(scene), .kernels = {}, .prepared = {}, .memory = {}};
  out.kernels = store::read_kernels(out.scene, folder, store);
  const store::KernelPointers kernels = out.kernels.pointers();
  out.prepared.scene = store::library_scene(out.scene, kernels);
  store::in_file(out.scene.file, [&] { store::read_histories(out.scene, out.prepared.scene); });
  out.prepared.placement = store.placements.place(out.scene, kernels);
  out.memory = store::check_impact(out.scene, kernels, out.prepared.placement);
  return out;
}

std::vector<BodySize> sizes_of(const PairedRound& round, Hertz band) {
  std::vector<BodySize> sizes;
  for (std::size_t k = 0; k < round.scene.bodies.size(); ++k) {
    const kernels::Kernel& kernel = *round.kernels.kernel[k];
    sizes.push_back(
        {.body = round.scene.bodies[k].name,
         .modes = modes_in_band(round.scene, k, kernel, band),
         .vectors = static_cast<double>(kernel.modes.size()),
         .unknowns = static_cast<double>(kernel.dofs),
         .elements = static_cast<double>(kernel.elements),
         .dimension = kernel.surface.corners() == 1 ? 1 : 3,
         .width = width_of(kernel),
         .candidates = round.scene.motion.is_finite() ? static_cast<double>(kernel.surface.size()) : 0});
  }
  return sizes;
}

Dialled dialled_of(const PairedRound& round, Hertz rate) {
  contact::Model model =
      store::in_file(round.scene.file, [&] { return store::model_of(round.scene, round.prepared); });
  return dial_of(round.scene, round.kernels, round.prepared, std::move(model), rate, {});
}

}  // namespace ricochet::accuracy
