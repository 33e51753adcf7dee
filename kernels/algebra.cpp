// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/algebra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/band.hpp"
#include "kernels/compression.hpp"
#include "ricochet/error.hpp"

namespace ricochet::kernels {
namespace {

/// Factors of the properties of a body.
struct Growth {
  double stiffness, mass, length, area, young;
};

Growth growth(const Similarity& f) {
  const double s = f.scale;
  if (f.area) return {f.young * *f.area / s, f.density * *f.area * s, s, *f.area, f.young};
  return {f.young * s, f.density * s * s * s, s, s * s, f.young};
}

template <class Range>
void multiply(Range& values, double factor) {
  for (auto& value : values) value = static_cast<std::decay_t<decltype(value)>>(value * factor);
}

[[noreturn]] void fail(const Kernel& kernel, const std::string& what) {
  throw InputError(fmt::format("kernel of \"{}\": {}", kernel.body, what));
}

/// Throws InputError if the kernel has loads, moving supports, receivers or gauges, because restriction is
/// not implemented for their data.
void refuse_sources(const Kernel& kernel) {
  if (!kernel.applied.empty() || !kernel.motions.empty() || !kernel.receivers.empty() ||
      !kernel.gauges.empty())
    fail(kernel, "has loads, moving supports, receivers or gauges: compute the requested kernel");
}

/// Calls act(values) for the responses of the visualisation surface and of its stress to forces on the
/// candidates, which may be empty.
template <class Act>
void for_each_view(Kernel& kernel, Act&& act) {
  if (!kernel.view) return;
  act(kernel.view->residual_flexibility);
  if (kernel.view->stress) act(kernel.view->stress->residual_flexibility);
}

/// Throws InputError unless the kernel contains all modes below the end of the certificate.
void require_all_found(const Kernel& kernel) {
  if (kernel.modes.contact_adapted())
    fail(kernel, "holds a contact-adapted basis, which cannot be truncated: compute another one");
  if (kernel.modes.certificate.left_out > 0)
    fail(kernel,
         fmt::format(
             "{} of its modes were truncated: truncate the kernel that has them, or compute it without "
             "flexibility_error",
             kernel.modes.certificate.left_out));
}

/// Relative difference of ends that is due to round-off.
constexpr double same_end = 1e-9;

/// Selects rows of a matrix, by blocks of `height` rows, in the given order.
void take_rows(std::vector<double>& matrix, std::size_t width, const std::vector<std::int64_t>& blocks,
               std::size_t height = 1) {
  std::vector<double> taken;
  taken.reserve(blocks.size() * height * width);
  for (const std::int64_t block : blocks) {
    const auto from = matrix.begin() + block * static_cast<std::int64_t>(height * width);
    taken.insert(taken.end(), from, from + static_cast<std::int64_t>(height * width));
  }
  matrix = std::move(taken);
}

/// Keeps the elements whose corners are all among `points`, renumbered. If there are none, each point becomes
/// an element, and the curvature is lost.
void take_elements(Surface& surface, const std::vector<std::int64_t>& points) {
  std::vector<std::int64_t> number(surface.size(), -1), element, kept;
  for (std::size_t i = 0; i < points.size(); ++i) number[points[i]] = static_cast<std::int64_t>(i);
  const auto k = static_cast<std::size_t>(surface.element_corners);
  for (std::size_t e = 0; e + k <= surface.element.size(); e += k) {
    std::vector<std::int64_t> corners;
    for (std::size_t j = 0; j < k; ++j) corners.push_back(number[surface.element[e + j]]);
    if (std::ranges::count(corners, -1) > 0) continue;
    element.insert(element.end(), corners.begin(), corners.end());
    kept.push_back(static_cast<std::int64_t>(e / k));
  }
  if (!surface.element_normal.empty()) take_rows(surface.element_normal, 3, kept, k);
  if (element.empty() || k == 1) {
    surface.element_normal.clear();
    surface.element_corners = 1;
    element.resize(points.size());
    std::iota(element.begin(), element.end(), std::int64_t{0});
  }
  surface.element = std::move(element);
}

/// Combines each three rows of `width` numbers into one. `by` contains the factors of successive rows, from
/// its beginning again after its end.
template <class T, class Factors>
void contract(std::vector<T>& matrix, std::size_t width, const Factors& by) {
  std::vector<T> sums(matrix.size() / 3, 0);
  for (std::size_t row = 0; row * width < matrix.size(); ++row)
    for (std::size_t j = 0; j < width; ++j)
      sums[row / 3 * width + j] += static_cast<T>(by[row % by.size()] * matrix[row * width + j]);
  matrix = std::move(sums);
}

// Similar bodies. Each structure is decomposed into all its members, so that a new member must get its factor
// here; otherwise this does not compile.

void rescale(Modes& modes, double frequency, const Damping& damping) {
  auto& [basis, omega, decay, residual, stiffness_error, certificate, coriolis] = modes;
  multiply(omega, frequency);
  decay = decay_rates(damping, omega);
  auto& [below, upto_hz, by_inertia, shift, modes_below, found, left_out, complete, orthonormality, error] =
      certificate;
  upto_hz *= frequency;
  multiply(shift, frequency * frequency);
}

void rescale(Surface& surface, const Growth& by) {
  auto& [components, direction, node, centroid, bulge, group, normal, area, corners, element, element_normal,
         shape, flexibility, mesh_error, coupling, compact, normal_residual, whole] = surface;
  const auto rescale_geometry = [&](auto& nodes, auto& centroids, auto& bulges, auto& areas) {
    multiply(nodes, by.length);
    multiply(centroids, by.length);
    multiply(bulges, by.length);
    multiply(areas, by.area);
  };
  rescale_geometry(node, centroid, bulge, area);
  multiply(shape, 1 / std::sqrt(by.mass));
  multiply(flexibility, 1 / by.stiffness);
  multiply(mesh_error, 1 / by.stiffness);
  if (compact) scale(*compact, 1 / by.stiffness);
  if (whole) {
    auto& [all_node, all_centroid, all_bulge, all_normal, all_area, all_corners, all_element,
           all_element_normal, held] = *whole;
    rescale_geometry(all_node, all_centroid, all_bulge, all_area);
  }
}

void rescale(Loads& loads, const Growth& by) {
  auto& [body_force, rotation, residual] = loads;
  multiply(body_force, std::sqrt(by.mass));
  multiply(rotation, std::sqrt(by.mass) * by.length);
  multiply(residual, by.mass / by.stiffness);
}

/// Factor of the force that one unit of the load exerts.
double unit_force(const Load& load, const Growth& by) { return load.unit == "Pa" ? by.area : 1.0; }

void rescale(Load& load, const Growth& by) {
  const double force = unit_force(load, by);
  auto& [name, unit, participation, total, moment, residual, inward] = load;
  multiply(participation, force / std::sqrt(by.mass));
  multiply(total, force);
  multiply(moment, force * by.length);
  multiply(residual, force / by.stiffness);
}

/// Rescales mode shapes at points and the displacements of these points under contact forces, gravity and
/// the `applied` loads.
template <class Range>
void rescale_responses(Range& shape, Range& by_contact, Range& by_gravity, Range& by_loads, const Growth& by,
                       const std::vector<Load>& applied) {
  multiply(shape, 1 / std::sqrt(by.mass));
  multiply(by_contact, 1 / by.stiffness);
  multiply(by_gravity, by.mass / by.stiffness);
  for (std::size_t j = 0; j < by_loads.size(); ++j)
    by_loads[j] = static_cast<std::decay_t<decltype(by_loads[j])>>(
        by_loads[j] * (unit_force(applied[j / 3 % applied.size()], by) / by.stiffness));
}

}  // namespace

double frequency_factor(const Similarity& factors) {
  const Growth by = growth(factors);
  return std::sqrt(by.stiffness / by.mass);
}

Kernel rescaled(Kernel kernel, const Similarity& factors, const Damping& damping) {
  const Growth by = growth(factors);
  auto& [body, hash, scene, mesh_sha256, created_by, dofs, elements, order, mass, centre, inertia, supported,
         parts, held_on_lines, outline, piece_box, piece_elements, modes, surface, loads, applied, motions,
         receivers, gauges, view] = kernel;
  mass *= by.mass;
  multiply(centre, by.length);
  multiply(inertia, by.mass * by.length * by.length);
  multiply(outline, by.length);
  multiply(piece_box, by.length);
  rescale(modes, frequency_factor(factors), damping);
  rescale(surface, by);
  rescale(loads, by);
  for (Load& load : applied) rescale(load, by);
  for (auto& [name, participation, residual, momentum] : motions) {
    multiply(participation, std::sqrt(by.mass));
    multiply(momentum, by.mass);
  }
  for (auto& [name, point, shape, by_contact, by_gravity, by_loads, by_motions] : receivers) {
    multiply(point, by.length);
    rescale_responses(shape, by_contact, by_gravity, by_loads, by, applied);
  }
  const auto rescale_all = [&](auto& seen, double factor) {
    auto& [shape, by_contact, by_gravity, by_loads, by_motions] = seen;
    rescale_responses(shape, by_contact, by_gravity, by_loads, by, applied);
    for (auto* values : {&shape, &by_contact, &by_gravity, &by_loads, &by_motions}) multiply(*values, factor);
  };
  for (auto& [name, point, stress, strain] : gauges) {
    multiply(point, by.length);
    rescale_all(stress, by.young / by.length);
    if (strain) rescale_all(*strain, 1 / by.length);
  }
  if (view) {
    auto& [node, corners, element, shape, by_contact, by_gravity, by_loads, by_motions, stress] = *view;
    multiply(node, by.length);
    rescale_responses(shape, by_contact, by_gravity, by_loads, by, applied);
    if (stress) rescale_all(*stress, by.young / by.length);
  }
  return kernel;
}

Kernel truncated_to_band(Kernel kernel, Hertz band) {
  require_all_found(kernel);
  Certificate& certificate = kernel.modes.certificate;
  if (!(band.value > 0 && band.value <= certificate.upto_hz * (1 + same_end)))
    fail(kernel, fmt::format("has all modes up to {:.6g} Hz, not up to {:.6g}: request less, or compute more "
                             "modes",
                             certificate.upto_hz, band.value));
  kernel = truncated_above(std::move(kernel), RadPerSecond(band));
  certificate.upto_hz = std::min(band.value, certificate.upto_hz);
  certificate.count_found = static_cast<std::int64_t>(kernel.modes.size());
  if (certificate.complete) certificate.count_by_inertia = certificate.count_found;
  const double end = std::pow(RadPerSecond(band).value, 2);
  const auto below = std::ranges::lower_bound(certificate.shift, end) - certificate.shift.begin();
  certificate.shift.resize(static_cast<std::size_t>(below));
  certificate.modes_below.resize(certificate.shift.size());
  certificate.flexibility_error = 0;
  return kernel;
}

Kernel truncated_to_count(Kernel kernel, std::int64_t count) {
  require_all_found(kernel);
  const std::vector<double>& omega = kernel.modes.angular_frequency;
  if (count < 1 || static_cast<std::uint64_t>(count) > omega.size())
    fail(kernel,
         fmt::format("has {} modes, fewer than {}: request fewer, or compute more", omega.size(), count));
  const auto square = [&](std::size_t n) { return omega[n] * omega[n]; };
  auto kept = std::max<std::size_t>(count, std::ranges::count(omega, 0.0));
  while (kept < omega.size() && square(kept) < (1 + multiple_mode) * square(kept - 1)) ++kept;
  const Hertz end = kept < omega.size()
                        ? to_hertz(RadPerSecond{std::sqrt((square(kept - 1) + square(kept)) / 2)})
                        : Hertz{kernel.modes.certificate.upto_hz};
  return truncated_to_band(std::move(kernel), end);
}

void restrict_candidates(Surface& surface, const std::vector<std::int64_t>& points) {
  take_elements(surface, points);
  surface.whole.reset();
  std::vector<std::string> group;
  for (const std::int64_t i : points) group.push_back(surface.group[i]);
  surface.group = std::move(group);
  take_rows(surface.node, 3, points);
  if (!surface.centroid.empty()) take_rows(surface.centroid, 3, points);
  if (!surface.bulge.empty()) take_rows(surface.bulge, 1, points);
  take_rows(surface.normal, 3, points);
  take_rows(surface.area, 1, points);
  if (!surface.mesh_error.empty()) take_rows(surface.mesh_error, 1, points);
}

Kernel restricted_to_points(Kernel kernel, const std::vector<std::int64_t>& points) {
  Surface& surface = kernel.surface;
  const std::size_t m = surface.size(), n = kernel.modes.size(),
                    c = static_cast<std::size_t>(surface.components),
                    r = static_cast<std::size_t>(surface.residual_components());
  refuse_sources(kernel);
  if (points.empty()) fail(kernel, "no candidate would remain: name at least one");
  std::vector<bool> named(m, false);
  for (const std::int64_t i : points) {
    if (i < 0 || static_cast<std::uint64_t>(i) >= m)
      fail(kernel, fmt::format("there is no candidate {}: they are numbered from 0 to {}", i, m - 1));
    if (named[i]) fail(kernel, fmt::format("candidate {} is named twice: name it once", i));
    named[i] = true;
  }
  restrict_candidates(surface, points);
  take_rows(surface.shape, n, points, c);
  if (!surface.residual_flexibility.empty()) {
    std::vector<double> square;
    for (const std::int64_t i : points)
      for (std::size_t a = 0; a < r; ++a)
        for (const std::int64_t j : points)
          for (std::size_t b = 0; b < r; ++b)
            square.push_back(surface.residual_flexibility[(i * r + a) * r * m + j * r + b]);
    surface.residual_flexibility = std::move(square);
  }
  if (surface.compact) surface.compact = restricted(*surface.compact, points);
  if (!kernel.loads.body_force_residual.empty()) take_rows(kernel.loads.body_force_residual, 3, points, r);
  for_each_view(kernel, [&](std::vector<float>& whole) {
    std::vector<float> taken;
    for (std::size_t row = 0; row < whole.size() / (r * m); ++row)
      for (const std::int64_t i : points)
        for (std::size_t a = 0; a < r; ++a) taken.push_back(whole[(row * m + i) * r + a]);
    whole = std::move(taken);
  });
  return kernel;
}

Kernel restricted_to_direction(Kernel kernel, const Vector3& direction) {
  refuse_sources(kernel);
  Surface& surface = kernel.surface;
  if (surface.components != 3) fail(kernel, "has one direction only: compute it without contact.direction");
  if (surface.normal_residual)
    fail(kernel, "holds its residual flexibility along the normals alone: compute it for this direction");
  if (surface.compact) fail(kernel, "is of a body that turns: compute it for this direction");
  const std::size_t m = surface.size();
  const auto along = [&](auto& matrix, std::size_t width) { contract(matrix, width, direction); };
  along(surface.shape, kernel.modes.size());
  if (!surface.residual_flexibility.empty()) {
    along(surface.residual_flexibility, 3 * m);
    along(surface.residual_flexibility, 1);
  }
  along(kernel.loads.body_force_residual, 3);
  for_each_view(kernel, [&](std::vector<float>& values) { along(values, 1); });
  surface.components = 1;
  surface.direction = direction;
  return kernel;
}

Kernel restricted_to_normals(Kernel kernel) {
  Surface& surface = kernel.surface;
  if (surface.residual_flexibility.empty() || surface.residual_components() != 3)
    fail(kernel, "has no residual flexibility in three components: compute the requested kernel");
  const std::vector<double>& normal = surface.normal;
  const std::size_t m = surface.size();
  contract(surface.residual_flexibility, 3 * m, normal);
  contract(surface.residual_flexibility, 1, normal);
  contract(kernel.loads.body_force_residual, 3, normal);
  for (Load& load : kernel.applied) contract(load.residual, 3, normal);
  for (Receiver& receiver : kernel.receivers) contract(receiver.residual_flexibility, 1, normal);
  for_each_sensitivity(kernel, [&](auto& seen) { contract(seen.residual_flexibility, 1, normal); });
  if (kernel.view) contract(kernel.view->residual_flexibility, 1, normal);
  surface.normal_residual = true;
  return kernel;
}

Kernel compacted(Kernel kernel) {
  make_compact(kernel.surface);
  return kernel;
}

Kernel truncated_to_flexibility_error(Kernel kernel, Hertz band, double error) {
  require_all_found(kernel);
  if (!kernel.modes.certificate.complete)
    fail(kernel, "holds imported modes, which are not known to be complete: leave flexibility_error out");
  if (!kernel.surface.has_flexibility())
    fail(kernel, "has no residual flexibility to represent truncated modes: compute it with one");
  Certificate& certificate = kernel.modes.certificate;
  const double above = error_above(kernel, RadPerSecond(band), RadPerSecond(Hertz{certificate.upto_hz}));
  if (!(above < error))
    fail(kernel, fmt::format("its modes end at {:.6g} Hz, and those above may cause an error of {:.2g} up to "
                             "{:.6g} Hz: allow a larger error, or compute modes further up",
                             certificate.upto_hz, above, band.value));
  const std::size_t all = kernel.modes.size();
  const double made = truncate_least_contributing(kernel, RadPerSecond(band), error - above);
  certificate.left_out = static_cast<std::int64_t>(all - kernel.modes.size());
  certificate.flexibility_error = made + above;
  return kernel;
}

}  // namespace ricochet::kernels
