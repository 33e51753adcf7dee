// SPDX-License-Identifier: BSD-2-Clause
// Closed-form kernel of a uniform bar that moves along its axis.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels::test {

struct Bar {
  double young = 3, density = 2, length = 1.7, area = 0.3;
  double beside = 0.4;  ///< the axis is at y = beside
  bool clamped = true;  ///< at x = 0
  std::size_t modes = 40;
  std::vector<double> at = {0.25, 0.5, 0.75, 1};  ///< candidates, as fractions of the length
  std::function<double(double)> decay = [](double) { return 0.0; };

  double speed() const { return std::sqrt(young / density); }
  double mass() const { return density * area * length; }

  /// Wave number of elastic mode n = 1, 2, …
  double wave_number(std::size_t n) const {
    return (static_cast<double>(n) - (clamped ? 0.5 : 0.0)) * std::numbers::pi / length;
  }
  double omega(std::size_t n) const { return wave_number(n) * speed(); }
  double shape(std::size_t n, double x) const {
    const double angle = wave_number(n) * x;
    return std::sqrt(2 / mass()) * (clamped ? std::sin(angle) : std::cos(angle));
  }
  /// ∫ ρ A φ dx
  double momentum(std::size_t n) const {
    return clamped ? density * area * std::sqrt(2 / mass()) / wave_number(n) : 0;
  }

  /// Displacement at x under a unit force at y, relative to the rigid motion of a free bar.
  double flexibility(double x, double y) const {
    if (clamped) return std::min(x, y) / (young * area);
    return (length / 3 - std::max(x, y) + (x * x + y * y) / (2 * length)) / (young * area);
  }
  /// Displacement at x under unit acceleration.
  double sag(double x) const { return clamped ? density / young * (length * x - x * x / 2) : 0; }

  /// The frequency halfway between the last mode and the next.
  Hertz end() const { return to_hertz(RadPerSecond{(omega(modes) + omega(modes + 1)) / 2}); }

  Kernel kernel() const;
};

inline Kernel Bar::kernel() const {
  Kernel out;
  out.body = "bar";
  out.hash = out.mesh_sha256 = std::string(64, 'c');
  out.scene = "of the caller";
  out.created_by = "a formula";
  out.dofs = 1000;
  out.elements = 999;
  out.order = 1;
  out.mass = mass();
  out.centre = {length / 2, beside, 0};
  const double turn = mass() * length * length / 12;
  out.inertia = {0, 0, 0, 0, turn, 0, 0, 0, turn};
  out.supported = clamped;

  const std::size_t rigid = clamped ? 0 : 1, n = rigid + modes, m = at.size();
  const auto place = [&](std::size_t i) { return at[i] * length; };
  const auto mode = [&](std::size_t k, double x) {
    return k < rigid ? 1 / std::sqrt(mass()) : shape(k - rigid + 1, x);
  };
  const auto carried = [&](std::size_t k) { return k < rigid ? std::sqrt(mass()) : momentum(k - rigid + 1); };
  for (std::size_t k = 0; k < n; ++k) {
    out.modes.angular_frequency.push_back(k < rigid ? 0 : omega(k - rigid + 1));
    out.modes.decay_rate.push_back(decay(out.modes.angular_frequency.back()));
    out.modes.residual.push_back(1e-12 * static_cast<double>(k));
  }
  out.modes.certificate = {.upto_hz = end().value,
                           .count_by_inertia = static_cast<std::int64_t>(n),
                           // Between the second elastic mode and the third, and at the end.
                           .shift = {omega(2) * omega(3), std::pow(RadPerSecond(end()).value, 2)},
                           .modes_below = {static_cast<double>(rigid) + 2, static_cast<double>(n)},
                           .count_found = static_cast<std::int64_t>(n),
                           .complete = true,
                           .orthonormality = 1e-13};

  Surface& surface = out.surface;
  surface.components = 1;
  surface.direction = Vector3{1, 0, 0};
  surface.element_corners = 2;
  View view;
  view.element_corners = 2;
  for (std::size_t i = 0; i < m; ++i) {
    surface.node.insert(surface.node.end(), {place(i), beside, 0});
    surface.group.push_back("side " + std::to_string(at[i]));
    surface.normal.insert(surface.normal.end(), {1, 0, 0});
    surface.area.push_back(area);
    for (std::size_t k = 0; k < n; ++k) surface.shape.push_back(mode(k, place(i)));
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t k = 0; k < n; ++k)
        view.shape.push_back(d == 0 ? static_cast<float>(mode(k, place(i))) : 0.0F);
    if (i + 1 < m)
      surface.element.insert(surface.element.end(),
                             {static_cast<std::int64_t>(i), static_cast<std::int64_t>(i + 1)});
    for (std::size_t j = 0; j < m; ++j) {
      double rest = flexibility(place(i), place(j));
      for (std::size_t k = 1; k <= modes; ++k)
        rest -= shape(k, place(i)) * shape(k, place(j)) / (omega(k) * omega(k));
      surface.residual_flexibility.push_back(rest);
    }
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t j = 0; j < m; ++j)
        view.residual_flexibility.push_back(
            d == 0 ? static_cast<float>(surface.residual_flexibility[i * m + j]) : 0.0F);
    double rest = sag(place(i));
    for (std::size_t k = 1; k <= modes; ++k) rest -= shape(k, place(i)) * momentum(k) / (omega(k) * omega(k));
    out.loads.body_force_residual.insert(out.loads.body_force_residual.end(), {rest, 0, 0});
    view.body_force_residual.push_back(static_cast<float>(rest));
    view.body_force_residual.resize(view.body_force_residual.size() + 8, 0.0F);
  }
  view.node = surface.node;
  view.element = surface.element;
  out.view = view;

  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t k = 0; k < n; ++k) {
      out.loads.body_force.push_back(d == 0 ? carried(k) : 0);
      out.loads.rotation.push_back(d == 2 ? -beside * carried(k) : 0);  // e_z × x = (−y, x, 0)
    }
  return out;
}

}  // namespace ricochet::kernels::test
