// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/derive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ricochet/error.hpp"
#include "src/scene/elastic_law.hpp"

namespace ricochet::scene {

namespace {

/// Whether two numbers agree up to a few roundings. Factors are quotients of numbers in scenes, so they are
/// rounded.
bool same(double a, double b) { return std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b)); }

template <class T>
bool both_or_neither(const std::optional<T>& a, const std::optional<T>& b) {
  return a.has_value() == b.has_value();
}

/// Whether the second material equals the first one multiplied by these factors. The lines about which its
/// axes turn are those of the scaled body.
bool similar(Material had, const Material& wanted, const kernels::Similarity& by) {
  stiffen(had, by.young);
  return had.group == wanted.group && same_law(had, wanted) &&
         same(had.density * by.density, wanted.density) && same(had.area * by.area.value_or(1), wanted.area);
}

/// Whether the body is a rod. The patches of a rod are its ends, so their area is that of its cross-section.
/// The key `area` has no effect on solids.
bool is_rod(const kernels::Kernel& kernel, const Body& body) {
  return std::ranges::all_of(kernel.surface.area, [&](double area) {
    return std::ranges::any_of(body.materials, [&](const Material& m) { return same(m.area, area); });
  });
}

/// Whether both requests have the same loads, motions, receivers and gauges, in the same order.
bool same_sources(const KernelRequest& a, const KernelRequest& b) {
  const auto same = [](const auto& x, const auto& y) {
    if constexpr (requires { x.group; })
      if (x.group != y.group || x.pressure.has_value() != y.pressure.has_value()) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(x.at[k] - y.at[k]) > 2e-12) return false;  // two roundings
    return x.name == y.name;
  };
  return std::ranges::equal(a.loads.tractions, b.loads.tractions, same) &&
         std::ranges::equal(a.loads.points, b.loads.points, same) &&
         std::ranges::equal(a.loads.motions, b.loads.motions, same) &&
         std::ranges::equal(a.receivers, b.receivers, same) &&
         std::ranges::equal(a.gauges, b.gauges, [&](const Gauge& x, const Gauge& y) {
           return same(x, y) && x.direction == y.direction && std::abs(x.length - y.length) <= 2e-12;
         });
}

[[noreturn]] void fail(const kernels::Kernel& kernel, const std::string& what) {
  throw InputError(fmt::format("kernel of \"{}\": {}", kernel.body, what));
}

/// Whether `wanted` requests the same modes as `had`, with frequencies multiplied by a factor.
bool same_modes(const Modes& had, const Modes& wanted, double frequency) {
  // A contact-adapted basis also depends on whether a residual flexibility complements it.
  return (had.basis == Basis::modes || had.residual_flexibility == wanted.residual_flexibility) &&
         both_or_neither(had.up_to, wanted.up_to) &&
         (!had.up_to || std::abs(had.up_to->value * frequency / wanted.up_to->value - 1) < 1e-9) &&
         had.count == wanted.count && had.flexibility_error == wanted.flexibility_error;
}

/// @param adapted  whether the stored basis is adapted to the requested candidates
kernels::Kernel with_modes(kernels::Kernel kernel, const Modes& had, const Modes& wanted, double frequency,
                           bool adapted) {
  if (had.basis != wanted.basis || had.low_rank != wanted.low_rank ||
      had.relative_residual > wanted.relative_residual)
    fail(kernel, "its modes were computed with other settings: compute the kernel");
  if (wanted.residual_flexibility && !had.residual_flexibility)
    fail(kernel, "has no residual flexibility: compute it with one");
  const bool independent = had.basis == Basis::modes && !had.flexibility_error;
  if (same_modes(had, wanted, frequency) && (adapted || independent)) return kernel;
  if (had.basis == Basis::contact)
    fail(kernel, "holds a contact-adapted basis for another band or direction: compute another one");
  if (wanted.flexibility_error)
    return kernels::truncated_to_flexibility_error(std::move(kernel), *wanted.up_to,
                                                   *wanted.flexibility_error);
  if (wanted.count) return kernels::truncated_to_count(std::move(kernel), *wanted.count);
  return kernels::truncated_to_band(std::move(kernel), *wanted.up_to);
}

/// Positions of the points of `wanted` among the candidates of `had`.
std::vector<std::int64_t> places(const KernelRequest& had, const KernelRequest& wanted) {
  if (!had.points) return *wanted.points;
  std::vector<std::int64_t> places;
  for (const std::int64_t point : *wanted.points)
    places.push_back(std::ranges::find(*had.points, point) - had.points->begin());
  return places;
}

}  // namespace

std::optional<kernels::Similarity> similarity(const KernelRequest& had, const KernelRequest& wanted) {
  if (wanted.modes.open()) return std::nullopt;
  const Body &a = had.body, &b = wanted.body;
  if (had.mesh_sha256 != wanted.mesh_sha256 || a.geometry != b.geometry || a.order != b.order ||
      a.size_factor != b.size_factor || a.refine != b.refine || (!a.refine.empty() && a.scale != b.scale) ||
      a.contact != b.contact || a.support != b.support || a.materials.size() != b.materials.size() ||
      (had.direction && had.direction != wanted.direction) ||
      (wanted.modes.residual_flexibility &&
       ((had.normal_residual && !wanted.normal_residual) || (had.turns && !wanted.turns))) ||
      had.along != wanted.along || !both_or_neither(had.spacing, wanted.spacing))
    return std::nullopt;
  kernels::Similarity by{.scale = b.scale / a.scale};
  if (!a.materials.empty()) {
    const Material &one = a.materials.front(), &other = b.materials.front();
    by.young = stiffness_ratio(one, other);
    by.density = other.density / one.density;
    if (one.area > 0 && other.area > 0) by.area = other.area / one.area;
  }
  KernelRequest scaled = had;
  scale_places(scaled, by.scale);
  for (std::size_t k = 0; k < a.materials.size(); ++k)
    if (!similar(scaled.body.materials[k], b.materials[k], by)) return std::nullopt;
  if (had.spacing && !same(*had.spacing * by.scale, *wanted.spacing)) return std::nullopt;
  const auto has = [&](std::int64_t point) { return std::ranges::count(*had.points, point) > 0; };
  if (had.points && !(wanted.points && std::ranges::all_of(*wanted.points, has))) return std::nullopt;
  if (wanted.within_reach && had.points && !had.within_reach) return std::nullopt;
  if (!same_sources(scaled, wanted)) return std::nullopt;
  return by;
}

kernels::Kernel derived(kernels::Kernel kernel, const KernelRequest& had, const KernelRequest& wanted) {
  auto factors = similarity(had, wanted);
  if (!factors) fail(kernel, "is of another body or has other candidates: compute the requested kernel");
  if (!is_rod(kernel, had.body)) factors->area.reset();
  if (wanted.view && !kernel.view) fail(kernel, "has no visualisation surface: compute it with one");
  if (wanted.stress && !kernel.view->stress)
    fail(kernel, "holds no stress of its visualisation surface: compute it with it");
  if (wanted.body.damping.law == Damping::Law::by_mode && kernel.modes.certificate.left_out > 0)
    fail(kernel,
         "some of its modes were left out, so that damping by mode does not apply: compute the kernel");
  kernel = kernels::rescaled(std::move(kernel), *factors, wanted.body.damping);
  const bool turned = had.direction != wanted.direction;
  if (turned) kernel = kernels::restricted_to_direction(std::move(kernel), *wanted.direction);
  if (wanted.points && (wanted.points != had.points || wanted.within_reach != had.within_reach)) {
    kernels::WholeSurface whole = kernels::whole_surface(kernel.surface);
    kernel = kernels::restricted_to_points(std::move(kernel), places(had, wanted));
    if (wanted.within_reach) {
      whole.held = *wanted.points;
      kernel.surface.whole = std::move(whole);
    }
  }
  const bool projected = wanted.normal_residual && !had.normal_residual;
  if (projected) kernel = kernels::restricted_to_normals(std::move(kernel));
  kernel = with_modes(std::move(kernel), had.modes, wanted.modes, kernels::frequency_factor(*factors),
                      !turned && !projected);
  if (!wanted.modes.residual_flexibility) {
    kernel.surface.residual_flexibility.clear();
    kernel.surface.compact.reset();
    kernel.surface.normal_residual = false;
    kernel.loads.body_force_residual.clear();
    for (kernels::Load& load : kernel.applied) load.residual.clear();
    const auto without_residual = [](auto& motion) {
      for (auto* part : {&motion.residual_flexibility, &motion.body_force_residual, &motion.load_residual})
        part->clear();
    };
    for (kernels::Receiver& receiver : kernel.receivers) without_residual(receiver);
    kernels::for_each_sensitivity(kernel, without_residual);
    if (kernel.view) without_residual(*kernel.view);
  }
  if (wanted.turns) kernel = kernels::compacted(std::move(kernel));
  if (!wanted.view) kernel.view.reset();
  if (kernel.view && !wanted.stress) kernel.view->stress.reset();
  kernel.body = wanted.body.name;
  kernel.hash = wanted.hash;
  kernel.scene = wanted.toml;
  return kernel;
}

std::optional<kernels::Kernel> derive_from(const std::filesystem::path& file, const KernelRequest& wanted) {
  const auto header = kernels::read_header(file);
  if (!header || header->mesh_sha256 != wanted.mesh_sha256 || (wanted.mesh_error && !header->mesh_error))
    return std::nullopt;
  try {
    const KernelRequest had = request_of(*header, file.string());
    if (similarity(had, wanted)) return derived(kernels::read(file), had, wanted);
  } catch (const InputError&) {
    // Another file may be suitable. If none is, the kernel is computed.
  }
  return std::nullopt;
}

std::optional<Derived> derive_from_any(const std::filesystem::path& folder, const KernelRequest& wanted) {
  std::vector<std::filesystem::path> files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
    if (entry.path().filename().string().ends_with(".kernel.h5")) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files)
    if (auto kernel = derive_from(file, wanted)) return Derived{std::move(*kernel), file};
  return std::nullopt;
}

}  // namespace ricochet::scene
