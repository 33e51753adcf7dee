// SPDX-License-Identifier: BSD-2-Clause
#include "ricochet/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <string_view>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::kernels {
namespace {

/// Tolerance of normals and directions, which are normalised in double precision: it allows for a few
/// roundings, but not for a mistake.
constexpr double kUnitTolerance = 1e-9;

/// Relative asymmetry of R, which comes from iterated static solves and is symmetric to about their
/// tolerance.
constexpr double kSymmetryTolerance = 1e-6;

class Validator {
 public:
  explicit Validator(const std::string& origin) : origin_(origin) {}

  [[noreturn]] void fail(std::string_view name, const std::string& what) const {
    throw InputError(base::format("{}: {} {} Compute it again with ricochet-kernel.", origin_, name, what));
  }

  void length(std::string_view name, std::size_t found, std::size_t expected) const {
    if (found != expected) fail(name, base::format("has {} values, expected {}.", found, expected));
  }

  template <class T, class Accept>
  void each(std::string_view name, std::span<const T> values, Accept accept, std::string_view rule) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!accept(values[i]))
        fail(name, base::format("contains {} at index {}: must be {}.", values[i], i, rule));
  }

  template <class T>
  void finite(std::string_view name, const std::vector<T>& values, std::size_t expected) const {
    length(name, values.size(), expected);
    each<T>(
        name, values, [](T value) { return std::isfinite(value); }, "finite");
  }

  void finite_not_negative(std::string_view name, const std::vector<double>& values,
                           std::size_t expected) const {
    finite(name, values, expected);
    each<double>(
        name, values, [](double value) { return value >= 0; }, "zero or positive");
  }

  void elements(std::string_view name, const std::vector<std::int64_t>& corners, int per_element,
                int smallest, std::size_t nodes) const {
    if (per_element < smallest || per_element > 3)
      fail(name, base::format("has {} corners per element: must be {} to 3.", per_element, smallest));
    if (corners.size() % static_cast<std::size_t>(per_element) != 0)
      fail(name, base::format("has {} values, not a multiple of {}.", corners.size(), per_element));
    each<std::int64_t>(
        name, corners, [nodes](std::int64_t i) { return i >= 0 && static_cast<std::uint64_t>(i) < nodes; },
        base::format("an index below {}", nodes));
  }

  void unit(std::string_view name, std::span<const double> vectors) const {
    for (std::size_t i = 0; i + 2 < vectors.size(); i += 3) {
      const double length = std::hypot(vectors[i], vectors[i + 1], vectors[i + 2]);
      if (!(std::abs(length - 1) <= kUnitTolerance))
        fail(name, base::format("has length {} in row {}: must be a unit vector.", length, i / 3));
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
  check.finite("dataset \"/body/centre\"", std::vector<double>(kernel.centre.begin(), kernel.centre.end()),
               3);
  check.finite("dataset \"/body/inertia\"", std::vector<double>(kernel.inertia.begin(), kernel.inertia.end()),
               9);
}

void validate_modes(const Modes& modes, const Validator& check) {
  const std::size_t n = modes.size();
  if (modes.basis != "modes" && !modes.contact_adapted() && !modes.imported())
    check.fail("attribute \"basis\" of \"/modes\"", "is neither \"modes\", \"contact\" nor \"imported\".");
  check.finite_not_negative("dataset \"/modes/angular_frequency\"", modes.angular_frequency, n);
  if (!std::ranges::is_sorted(modes.angular_frequency))
    check.fail("dataset \"/modes/angular_frequency\"", "is not ascending.");
  check.finite_not_negative("dataset \"/modes/decay_rate\"", modes.decay_rate, n);
  check.finite_not_negative("dataset \"/modes/residual\"", modes.residual, n);
  const Certificate& certificate = modes.certificate;
  if (certificate.below < 0 || certificate.count_by_inertia < 0 || certificate.count_found < 0 ||
      certificate.left_out < 0 || certificate.approximate < 0)
    check.fail("group \"/modes/certificate\"", "contains a negative count.");
  if (!(std::isfinite(certificate.upto_hz) && certificate.upto_hz >= 0 &&
        std::isfinite(certificate.orthonormality) && certificate.orthonormality >= 0 &&
        std::isfinite(certificate.flexibility_error) && certificate.flexibility_error >= 0))
    check.fail("group \"/modes/certificate\"", "contains a number that is negative or not finite.");
}

/// @param surface  Surface or WholeSurface, @param of  the group of its datasets
template <class Any>
void validate_candidates(const Any& surface, const std::string& of, const Validator& check) {
  const std::size_t m = surface.area.size();
  const auto name = [&](const char* dataset) { return base::format("dataset \"{}/{}\"", of, dataset); };
  check.finite(name("area"), surface.area, m);
  check.template each<double>(
      name("area"), surface.area, [](double a) { return a > 0; }, "positive");
  check.finite(name("node"), surface.node, 3 * m);
  if (!surface.centroid.empty()) check.finite(name("centroid"), surface.centroid, 3 * m);
  check.finite(name("normal"), surface.normal, 3 * m);
  check.unit(name("normal"), surface.normal);
  check.elements(name("element"), surface.element, surface.element_corners, 1, m);
}

void validate_whole(const Surface& surface, const Validator& check) {
  const WholeSurface& whole = *surface.whole;
  validate_candidates(whole, "/surface/whole", check);
  const std::string held = "dataset \"/surface/whole/held\"";
  check.length(held, whole.held.size(), surface.size());
  const std::size_t all = whole.area.size();
  check.each<std::int64_t>(
      held, whole.held, [all](std::int64_t i) { return i >= 0 && static_cast<std::uint64_t>(i) < all; },
      base::format("an index below {}", all));
  for (std::size_t i = 0; i < whole.held.size(); ++i) {
    if (i > 0 && whole.held[i - 1] >= whole.held[i]) check.fail(held, "is not ascending.");
    if (!std::equal(&surface.node[3 * i], &surface.node[3 * i] + 3,
                    &whole.node[3 * static_cast<std::size_t>(whole.held[i])]))
      check.fail(held, base::format("names a candidate that differs from row {}.", i));
  }
}

void validate_surface(const Surface& surface, std::size_t modes, const Validator& check) {
  const std::size_t m = surface.size();
  if (surface.components != 3 && surface.components != 1)
    check.fail("dataset \"/surface/shape\"",
               base::format("has {} components: must be 3 or 1.", surface.components));
  if (surface.direction.has_value() != (surface.components == 1))
    check.fail("dataset \"/surface/shape\"", "must have a direction if and only if it has one component.");
  if (surface.direction) check.unit("attribute \"direction\" of \"/surface/shape\"", *surface.direction);
  const std::size_t c = static_cast<std::size_t>(surface.components);
  validate_candidates(surface, "/surface", check);
  check.length("dataset \"/surface/group\"", surface.group.size(), m);
  if (surface.whole) validate_whole(surface, check);
  check.finite("dataset \"/surface/shape\"", surface.shape, m * c * modes);

  const std::vector<double>& r = surface.residual_flexibility;
  if (r.empty()) return;
  const std::string_view name = "dataset \"/surface/residual_flexibility\"";
  const std::size_t rows = c * m;
  check.finite(name, r, rows * rows);
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const double largest = std::abs(*std::ranges::max_element(r, smaller));
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(r[i * rows + j] - r[j * rows + i]) > kSymmetryTolerance * largest)
        check.fail(name, base::format("is not symmetric at ({}, {}).", i, j));
}

/// Checks a dataset that is either complete or empty.
template <class T>
void finite_or_none(const Validator& check, const std::string& name, const std::vector<T>& values,
                    std::size_t expected) {
  if (!values.empty()) check.finite(name, values, expected);
}

void validate_names(const auto& items, const std::string& group, const Validator& check) {
  std::set<std::string> names;
  for (const auto& item : items) {
    if (!is_free_name(item.name))
      check.fail(base::format("group \"{}\"", group), base::format("has the name \"{}\".", item.name));
    if (!names.insert(item.name).second)
      check.fail(base::format("group \"{}\"", group), base::format("has \"{}\" twice.", item.name));
  }
}

void validate_sources(const Kernel& kernel, const Validator& check) {
  const std::size_t n = kernel.modes.size(),
                    rows = static_cast<std::size_t>(kernel.surface.components) * kernel.surface.size();
  validate_names(kernel.applied, "/loads", check);
  validate_names(kernel.motions, "/motions", check);
  validate_names(kernel.receivers, "/receivers", check);
  for (const Load& load : kernel.applied) {
    const std::string data = "dataset \"/load_data/" + load.name;
    if (load.unit != "Pa" && load.unit != "N")
      check.fail("dataset \"/loads/" + load.name + "\"",
                 "has neither the unit of a traction nor that of a force.");
    check.finite("dataset \"/loads/" + load.name + "\"", load.participation, 3 * n);
    check.finite(data + "/total\"", load.total, 9);
    check.finite(data + "/moment\"", load.moment, 9);
    finite_or_none(check, data + "/residual\"", load.residual, 3 * rows);
  }
  for (const Motion& motion : kernel.motions) {
    const std::string data = "dataset \"/motions/" + motion.name;
    check.finite(data + "/participation\"", motion.participation, 3 * n);
    check.finite(data + "/residual\"", motion.residual, 3 * rows);
    check.finite(data + "/momentum\"", motion.momentum, 9);
  }
  for (const Receiver& receiver : kernel.receivers) {
    const std::string data = "dataset \"/receiver_data/" + receiver.name;
    check.finite("dataset \"/receivers/" + receiver.name + "\"", receiver.shape, 3 * n);
    check.finite(data + "/point\"", std::vector<double>(receiver.point.begin(), receiver.point.end()), 3);
    finite_or_none(check, data + "/residual_flexibility\"", receiver.residual_flexibility, 3 * rows);
    finite_or_none(check, data + "/body_force_residual\"", receiver.body_force_residual, 9);
    finite_or_none(check, data + "/load_residual\"", receiver.load_residual, 9 * kernel.applied.size());
    check.finite(data + "/motion_residual\"", receiver.motion_residual, 9 * kernel.motions.size());
  }
}

void validate_view(const Kernel& kernel, const Validator& check) {
  const View& view = *kernel.view;
  const std::size_t nodes = view.node.size() / 3, rows = 3 * nodes,
                    candidates = static_cast<std::size_t>(kernel.surface.components) * kernel.surface.size();
  check.finite("dataset \"/view/node\"", view.node, rows);
  check.elements("dataset \"/view/element\"", view.element, view.element_corners, 2, nodes);
  check.finite("dataset \"/view/shape\"", view.shape, rows * kernel.modes.size());
  finite_or_none(check, "dataset \"/view/residual_flexibility\"", view.residual_flexibility,
                 rows * candidates);
  finite_or_none(check, "dataset \"/view/body_force_residual\"", view.body_force_residual, 3 * rows);
  finite_or_none(check, "dataset \"/view/load_residual\"", view.load_residual,
                 3 * rows * kernel.applied.size());
  check.finite("dataset \"/view/motion_residual\"", view.motion_residual, 3 * rows * kernel.motions.size());
}

}  // namespace

WholeSurface whole_surface(const Surface& surface) {
  if (surface.whole) return *surface.whole;
  WholeSurface out{surface.node,
                   surface.centroid,
                   surface.normal,
                   surface.area,
                   surface.element_corners,
                   surface.element,
                   {}};
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
  const std::size_t n = kernel.modes.size();
  validate_body(kernel, check);
  validate_modes(kernel.modes, check);
  validate_surface(kernel.surface, n, check);
  check.finite("dataset \"/loads/body_force\"", kernel.loads.body_force, 3 * n);
  check.finite("dataset \"/loads/rotation\"", kernel.loads.rotation, 3 * n);
  if (!kernel.loads.body_force_residual.empty())
    check.finite("dataset \"/loads/body_force_residual\"", kernel.loads.body_force_residual,
                 3 * static_cast<std::size_t>(kernel.surface.components) * kernel.surface.size());
  validate_sources(kernel, check);
  if (kernel.view) validate_view(kernel, check);
}

}  // namespace ricochet::kernels
