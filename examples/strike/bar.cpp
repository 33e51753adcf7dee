// SPDX-License-Identifier: BSD-2-Clause
#include "bar.hpp"

#include <cmath>
#include <numbers>

namespace strike {
namespace {

/// Bending wave number of mode n = 1, 2, … times the length: the n-th solution of cosh x cos x = 1.
double wave_number(int n) {
  const double middle = (n + 0.5) * std::numbers::pi;
  double x = middle;
  for (int round = 0; round < 30; ++round) x = middle + (n % 2 == 0 ? -1 : 1) * std::asin(1 / std::cosh(x));
  return x;
}

/// Shape of the mode at s = x/L from an end, with mean square 1: cosh ξ + cos ξ − σ (sinh ξ + sin ξ), ξ = k
/// s. The growing part is written so that no digits cancel.
double bending_shape(double k, double s) {
  const double xi = k * s, bottom = std::sinh(k) - std::sin(k);
  const double rest = (std::cos(k) - std::sin(k) - std::exp(-k)) / bottom;  // 1 − σ
  return std::cos(xi) - (1 - rest) * std::sin(xi) + 0.5 * std::exp(xi) * rest +
         0.5 * std::exp(-xi) * (2 - rest);
}

void add_candidate(ricochet::kernels::Surface& surface, const ricochet::Vector3& node,
                   const ricochet::Vector3& normal, double area) {
  surface.node.insert(surface.node.end(), node.begin(), node.end());
  surface.normal.insert(surface.normal.end(), normal.begin(), normal.end());
  surface.group.push_back("face");
  surface.area.push_back(area);
}

/// Adds modes with φᵀ M e_i = 0 and φᵀ M (e_i × x) = 0. The caller sets those that are not 0.
void add_modes(ricochet::kernels::Kernel& kernel, const std::vector<double>& omega, double loss_factor) {
  const std::size_t n = omega.size();
  kernel.modes.angular_frequency = omega;
  for (const double w : omega) kernel.modes.decay_rate.push_back(loss_factor * w / 2);
  kernel.modes.residual.assign(n, 0);
  kernel.loads.body_force.assign(3 * n, 0);
  kernel.loads.rotation.assign(3 * n, 0);
}

}  // namespace

ricochet::SharedKernel bar_kernel(const Bar& bar, int bending, int candidates) {
  ricochet::kernels::Kernel kernel;
  kernel.body = kernel.hash = "bar";
  kernel.mass = bar.density * bar.length * bar.height * bar.width;
  const double inertia = kernel.mass * bar.length * bar.length / 12;
  kernel.inertia = {0, 0, 0, 0, inertia, 0, 0, 0, inertia};

  const double stretch = std::sqrt(bar.young / bar.density) * bar.height / std::sqrt(12.0);
  std::vector<double> omega = {0, 0};  // translation along z, and rotation about y
  for (int n = 1; n <= bending; ++n) omega.push_back(std::pow(wave_number(n) / bar.length, 2) * stretch);
  add_modes(kernel, omega, bar.loss_factor);
  const std::size_t modes = omega.size();
  kernel.loads.body_force[2 * modes] = std::sqrt(kernel.mass);
  kernel.loads.rotation[modes + 1] = -std::sqrt(inertia);

  ricochet::kernels::Surface& surface = kernel.surface;
  surface.components = 1;
  surface.direction = ricochet::Vector3{0, 0, 1};
  surface.element_corners = 2;
  for (int i = 0; i < candidates; ++i) {
    const double s = static_cast<double>(i) / (candidates - 1), x = (s - 0.5) * bar.length;
    add_candidate(surface, {x, 0, bar.height / 2}, {0, 0, 1}, bar.length * bar.width / candidates);
    if (i > 0) surface.element.insert(surface.element.end(), {i - 1, i});
    surface.shape.push_back(1 / std::sqrt(kernel.mass));
    surface.shape.push_back(x / std::sqrt(inertia));
    for (int n = 1; n <= bending; ++n)
      surface.shape.push_back(bending_shape(wave_number(n), s) / std::sqrt(kernel.mass));
  }
  return std::make_shared<const ricochet::kernels::Kernel>(std::move(kernel));
}

ricochet::SharedKernel mallet_kernel(double mass, double stiffness, const ricochet::Vector3& out) {
  ricochet::kernels::Kernel kernel;
  kernel.body = kernel.hash = "mallet";
  kernel.mass = mass;
  add_modes(kernel, {0}, 0);
  for (std::size_t k = 0; k < 3; ++k) kernel.loads.body_force[k] = std::sqrt(mass) * out[k];

  ricochet::kernels::Surface& surface = kernel.surface;
  surface.components = 1;
  surface.direction = out;
  surface.element_corners = 1;
  surface.element = {0};
  add_candidate(surface, {0, 0, 0}, {-out[0], -out[1], -out[2]}, 1e-4);
  surface.shape = {1 / std::sqrt(mass)};
  surface.residual_flexibility = {1 / stiffness};
  return std::make_shared<const ricochet::kernels::Kernel>(std::move(kernel));
}

}  // namespace strike
