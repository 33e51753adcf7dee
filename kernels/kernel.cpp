// SPDX-License-Identifier: BSD-2-Clause
#include "ricochet/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "base/format.hpp"
#include "kernels/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::kernels {
namespace {

/// Tolerance of normals and directions, which are normalised in double precision: it allows for a few
/// roundings, but not for a mistake.
constexpr double kUnitTolerance = 1e-9;

/// Tolerance of the relative asymmetry of R, which results from iterated static solves and is symmetric to
/// about their tolerance.
constexpr double kSymmetryTolerance = 1e-6;

/// Checks the lengths and the finiteness of all data that list_kernel lists. Further rules follow below.
class Validator {
 public:
  explicit Validator(const std::string& origin) : origin_(origin) {}

  [[noreturn]] void fail(std::string_view name, const std::string& what) const {
    throw InputError(base::format("{}: {} {} Compute it again with ricochet-kernel.", origin_, name, what));
  }

  [[noreturn]] void fail_dataset(const std::string& name, const std::string& what) const {
    fail(base::format("dataset \"{}\"", name), what);
  }

  void length(const std::string& name, std::size_t found, std::size_t expected) const {
    if (found != expected) fail_dataset(name, base::format("has {} values, expected {}.", found, expected));
  }

  void each(const std::string& name, const auto& values, auto accept, std::string_view rule) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!accept(values[i]))
        fail_dataset(name, base::format("contains {} at index {}: must be {}.", values[i], i, rule));
  }

  void indices(const std::string& name, const std::vector<std::int64_t>& values, std::size_t end) const {
    each(
        name, values, [end](std::int64_t i) { return i >= 0 && static_cast<std::uint64_t>(i) < end; },
        base::format("an index below {}", end));
  }

  void not_negative(const std::string& name, const std::vector<double>& values) const {
    each(
        name, values, [](double value) { return value >= 0; }, "zero or positive");
  }

  void unit(std::string_view name, std::span<const double> vectors) const {
    for (std::size_t i = 0; i + 2 < vectors.size(); i += 3) {
      const double length = std::hypot(vectors[i], vectors[i + 1], vectors[i + 2]);
      if (!(std::abs(length - 1) <= kUnitTolerance))
        fail(name, base::format("has length {} in row {}: must be a unit vector.", length, i / 3));
    }
  }

  // The interface that the lists in format.hpp require.
  void group(const std::string&) const {}
  void attribute(const std::string&, const char*, const auto&) const {}
  void constant(const std::string&, const char*, const char*) const {}
  void optional_attribute(const std::string&, const char*, const auto&) const {}
  std::size_t rows(const std::string&, const auto& values, std::size_t width) const {
    return values.size() / width;
  }
  void dataset(const std::string& name, const auto& values, const Shape& shape, std::string_view) const {
    length(name, values.size(),
           std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies()));
    each(
        name, values, [](auto value) { return std::isfinite(value); }, "finite");
  }
  void optional_dataset(const std::string& name, const auto& values, const Shape& shape,
                        std::string_view unit) const {
    if (!values.empty()) dataset(name, values, shape, unit);
  }
  void strings(const std::string& name, const std::vector<std::string>& values, std::size_t expected) const {
    length(name, values.size(), expected);
  }
  void elements(const std::string& name, const std::vector<std::int64_t>& element, int corners, int fewest,
                std::size_t nodes) const {
    if (corners < fewest || corners > 3)
      fail_dataset(name, base::format("has {} corners per element: must be {} to 3.", corners, fewest));
    if (element.size() % static_cast<std::size_t>(corners) != 0)
      fail_dataset(name, base::format("has {} values, not a multiple of {}.", element.size(), corners));
    indices(name, element, nodes);
  }
  void choose(const std::string&, const auto&) const {}
  void names(const std::string& kind, const auto& items) const {
    const std::string group = base::format("group \"/{}\"", kind);
    std::set<std::string> names;
    for (const auto& item : items) {
      if (!is_free_name(item.name)) fail(group, base::format("has the name \"{}\".", item.name));
      if (!names.insert(item.name).second) fail(group, base::format("has \"{}\" twice.", item.name));
    }
  }

 private:
  const std::string& origin_;
};

void validate_body(const Kernel& kernel, const Validator& check) {
  if (kernel.body.empty()) check.fail("attribute \"body\"", "is empty.");
  if (std::ranges::any_of(kernel.body, [](unsigned char c) { return c < 32 || c == 127; }))
    check.fail("attribute \"body\"", "contains control characters.");
  if (kernel.hash.empty()) check.fail("attribute \"hash\"", "is empty.");
  if (!(std::isfinite(kernel.mass) && kernel.mass > 0))
    check.fail("attribute \"mass\"", base::format("is {}: must be positive.", kernel.mass));
  if (kernel.dofs < 0 || kernel.elements < 0 || kernel.order < 0)
    check.fail("attribute \"dofs\", \"elements\" or \"order\"", "is negative.");
  if (kernel.parts < 0) check.fail("attribute \"parts\"", "is negative.");
  if (kernel.held_on_lines < 0 || kernel.held_on_lines > 7)
    check.fail("attribute \"held_on_lines\"", "must be from 0 to 7.");
  if (std::ranges::any_of(kernel.piece_elements, [](std::int64_t n) { return n < 1; }))
    check.fail_dataset("/body/piece_elements", "contains a piece without elements.");
  const std::vector<double>& box = kernel.piece_box;
  if (box.size() != 6 * kernel.piece_elements.size())
    check.fail_dataset("/body/piece_box", base::format("has {} values, not 6 for each of {} pieces.",
                                                       box.size(), kernel.piece_elements.size()));
  for (std::size_t i = 0; i < box.size(); ++i)
    if (i % 6 < 3 && box[i] > box[i + 3])
      check.fail_dataset(
          "/body/piece_box",
          base::format("has a lowest coordinate of {} above the highest, {}.", box[i], box[i + 3]));
}

void validate_modes(const Modes& modes, const Validator& check) {
  if (modes.basis != "modes" && !modes.contact_adapted() && !modes.imported())
    check.fail("attribute \"basis\" of \"/modes\"", "is neither \"modes\", \"contact\" nor \"imported\".");
  check.not_negative("/modes/angular_frequency", modes.angular_frequency);
  if (!std::ranges::is_sorted(modes.angular_frequency))
    check.fail_dataset("/modes/angular_frequency", "is not ascending.");
  check.not_negative("/modes/decay_rate", modes.decay_rate);
  check.not_negative("/modes/residual", modes.residual);
  const Certificate& certificate = modes.certificate;
  if (certificate.below < 0 || certificate.count_by_inertia < 0 || certificate.count_found < 0 ||
      certificate.left_out < 0)
    check.fail("group \"/modes/certificate\"", "contains a negative count.");
  if (!(std::isfinite(certificate.upto_hz) && certificate.upto_hz >= 0 &&
        std::isfinite(certificate.orthonormality) && certificate.orthonormality >= 0 &&
        std::isfinite(certificate.flexibility_error) && certificate.flexibility_error >= 0))
    check.fail("group \"/modes/certificate\"", "contains a number that is negative or not finite.");
}

void validate_mesh_error(const Surface& surface, const Validator& check) {
  check.not_negative("/surface/mesh_error", surface.mesh_error);
  if (!(surface.mesh_error_coupling >= 0 && surface.mesh_error_coupling <= 1))
    check.fail("attribute \"mesh_error_coupling\" of \"/surface\"", "must be from 0 to 1.");
}

void validate_coriolis(const Modes& modes, const Validator& check) {
  const std::string pairs = "/modes/coriolis_pair";
  const auto& [pair, coupling] = modes.coriolis;
  check.indices(pairs, pair, modes.size());
  check.length("/modes/coriolis_coupling", coupling.size(), pair.size() / 2 * 3);
  for (std::size_t k = 0; k + 1 < pair.size(); k += 2)
    if (pair[k] >= pair[k + 1] || modes.angular_frequency[pair[k]] == 0)
      check.fail_dataset(pairs, base::format("is not of two ascending elastic modes in row {}.", k / 2));
}

/// @param surface  Surface or WholeSurface, @param group  of its datasets
void validate_candidates(const auto& surface, const std::string& group, const Validator& check) {
  check.each(
      group + "/area", surface.area, [](double a) { return a > 0; }, "positive");
  check.unit("dataset \"" + group + "/normal\"", surface.normal);
  check.unit("dataset \"" + group + "/element_normal\"", surface.element_normal);
}

void validate_whole(const Surface& surface, const Validator& check) {
  const WholeSurface& whole = *surface.whole;
  validate_candidates(whole, "/surface/whole", check);
  const std::string held = "/surface/whole/held";
  check.indices(held, whole.held, whole.area.size());
  for (std::size_t i = 0; i < whole.held.size(); ++i) {
    if (i > 0 && whole.held[i - 1] >= whole.held[i]) check.fail_dataset(held, "is not ascending.");
    if (!std::equal(&surface.node[3 * i], &surface.node[3 * i] + 3, &whole.node[3 * whole.held[i]]))
      check.fail_dataset(held, base::format("names a candidate that differs from row {}.", i));
  }
}

void validate_components(const Surface& surface, const Validator& check) {
  if (surface.components != 3 && surface.components != 1)
    check.fail_dataset("/surface/shape",
                       base::format("has {} components: must be 3 or 1.", surface.components));
  if (surface.direction.has_value() != (surface.components == 1))
    check.fail_dataset("/surface/shape", "must have a direction if and only if it has one component.");
  if (surface.compact && (surface.components != 3 || surface.normal_residual))
    check.fail_dataset("/surface/residual_flexibility",
                       "must have three components if it is in single precision or compressed.");
  if (surface.normal_residual && (surface.components != 3 || surface.residual_flexibility.empty()))
    check.fail_dataset(
        "/surface/residual_flexibility",
        "cannot be stored along the normals if it is missing or if the kernel has a direction.");
  if (surface.direction) check.unit("attribute \"direction\" of \"/surface/shape\"", *surface.direction);
}

/// @param r  (rows,rows)
template <class T>
void validate_symmetry(const std::vector<T>& r, std::size_t rows, const Validator& check) {
  if (r.empty()) return;
  const auto smaller = [](T a, T b) { return std::abs(a) < std::abs(b); };
  const double largest = std::abs(*std::ranges::max_element(r, smaller));
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(r[i * rows + j] - r[j * rows + i]) > kSymmetryTolerance * largest)
        check.fail_dataset("/surface/residual_flexibility",
                           base::format("is not symmetric at ({}, {}).", i, j));
}

void validate_compressed(const CompactFlexibility& compact, std::size_t candidates, const Validator& check) {
  const std::string group = kCompressed, first = group + "/near_first", near = group + "/near_candidate";
  if (!(std::isfinite(compact.error) && compact.error >= 0))
    check.fail(base::format("attribute \"error\" of \"{}\"", group), "is negative or not finite.");
  check.indices(near, compact.near_candidate, candidates);
  const auto& starts = compact.near_first;
  if (starts.front() != 0 || starts.back() != std::ssize(compact.near_candidate) ||
      !std::ranges::is_sorted(starts))
    check.fail_dataset(first, base::format("does not ascend from 0 to {}.", compact.near_candidate.size()));
  for (std::size_t i = 0; i < candidates; ++i)
    for (std::int64_t k = starts[i], before = static_cast<std::int64_t>(i) - 1; k < starts[i + 1]; ++k) {
      const std::int64_t j = compact.near_candidate[static_cast<std::size_t>(k)];
      if (j <= std::exchange(before, j))
        check.fail_dataset(near, base::format("is not ascending from {} on for candidate {}.", i, i));
    }
}

void validate_sources(const Kernel& kernel, const Validator& check) {
  for (const Load& load : kernel.applied)
    if (load.unit != "Pa" && load.unit != "N")
      check.fail_dataset("/loads/" + load.name, "has neither the unit of a traction nor that of a force.");
  // Unlike the other residuals, those of motions are also required without residual flexibility.
  const std::size_t motions = kernel.motions.size();
  for (const Receiver& receiver : kernel.receivers)
    check.length("/receiver_data/" + receiver.name + "/motion_residual", receiver.motion_residual.size(),
                 9 * motions);
  for (const Gauge& gauge : kernel.gauges) {
    check.length("/gauges/" + gauge.name + "/stress/motion_residual", gauge.stress.motion_residual.size(),
                 18 * motions);
    if (gauge.strain)
      check.length("/gauges/" + gauge.name + "/strain/motion_residual", gauge.strain->motion_residual.size(),
                   3 * motions);
  }
  if (!kernel.view) return;
  check.length("/view/motion_residual", kernel.view->motion_residual.size(),
               3 * kernel.view->node.size() * motions);
  if (kernel.view->stress)
    check.length("/view/stress/motion_residual", kernel.view->stress->motion_residual.size(),
                 stress_rows * kernel.view->node.size() * motions);
}

}  // namespace

WholeSurface whole_surface(const Surface& surface) {
  if (surface.whole) return *surface.whole;
  WholeSurface out{surface.node,    surface.centroid,       surface.bulge,
                   surface.normal,  surface.area,           surface.element_corners,
                   surface.element, surface.element_normal, {}};
  out.held.resize(surface.size());
  std::iota(out.held.begin(), out.held.end(), std::int64_t{0});
  return out;
}

bool is_free_name(const std::string& name) {
  constexpr std::array taken = {".", "..", "body_force", "body_force_residual", "rotation"};
  return !name.empty() && name.size() <= 100 && std::ranges::find(taken, name) == taken.end() &&
         std::ranges::none_of(name, [](unsigned char c) { return c == '/' || c < 32 || c == 127; });
}

void validate(const Kernel& kernel, const std::string& origin) {
  const Validator check(origin);
  validate_body(kernel, check);
  validate_components(kernel.surface, check);
  list_kernel(check, kernel);
  validate_modes(kernel.modes, check);
  validate_coriolis(kernel.modes, check);
  validate_mesh_error(kernel.surface, check);
  validate_candidates(kernel.surface, "/surface", check);
  if (kernel.surface.whole) validate_whole(kernel.surface, check);
  const std::size_t rows = kernel.surface.residual_components() * kernel.surface.size();
  validate_symmetry(kernel.surface.residual_flexibility, rows, check);
  if (const auto& compact = kernel.surface.compact; compact && compact->compressed())
    validate_compressed(*compact, kernel.surface.size(), check);
  else if (compact)
    validate_symmetry(compact->whole, rows, check);
  validate_sources(kernel, check);
}

}  // namespace ricochet::kernels
