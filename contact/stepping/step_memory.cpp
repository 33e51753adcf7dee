// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/step_memory.hpp"

#include <algorithm>

#include "contact/stepping/look_ahead_stepper.hpp"
#include "contact/stepping/simd.hpp"

namespace ricochet::contact {
namespace {

constexpr double number = sizeof(double);

}  // namespace

double model_bytes(const ModelSize& size) {
  const auto n = static_cast<double>(size.rows), N = static_cast<double>(size.modes);
  return number * (n * N + 2 * n * n);
}

double building_bytes(const ModelSize& size) {
  const auto n = static_cast<double>(size.rows), held = static_cast<double>(size.held);
  // R of one body and P R.
  return number * (n * n + n * held);
}

double stepper_bytes(const ModelSize& size, const StepOptions& options) {
  const auto n = static_cast<double>(size.rows), N = static_cast<double>(size.modes),
             near = static_cast<double>(size.near);
  const bool rubs = size.rows > size.points, compliant = options.scheme == Scheme::compliant;
  const double square = number * n * n;
  // Two solvers: the factor of an active set each, and with friction another one, with the matrix of the
  // points that touch, its factor and scratch.
  const double solvers = 2 * (rubs ? 5 : 1) * square;
  if (!compliant) return 2 * square + solvers + number * near * near;
  const bool conserving = options.contact_step == ContactStep::conserving && size.has_residual;
  const double system = (conserving ? 4 : 3) * square;  // R, M, S and S_mean
  const double islands = size.pairs > 1 ? 4 * number * near * near : 0;
  if (options.block == 1 || size.points == 0) return system + solvers + islands;
  const double T = options.precision == Precision::float64 ? sizeof(double) : sizeof(float);
  const auto length = static_cast<double>(look_ahead_length(options, size.points));
  const auto width = static_cast<double>(simd::padded(static_cast<std::size_t>(size.rows), simd::point_pad)),
             modes = static_cast<double>(simd::padded(static_cast<std::size_t>(size.modes)));
  // B; the lags, influence, flexibility and residual of all rows.
  const double block = T * n * (modes + (length + (size.has_residual ? 3 : 2)) * width);
  // While it is built, a flexibility and a lag in double precision, and B with weights. Later, the lags and
  // the matrices of the points that may touch.
  const double building = 2 * square + number * n * N;
  const double gathered = (T * length + number * (conserving ? 4 : 3)) * near * near;
  return system + solvers + islands + block + std::max(building, gathered);
}

}  // namespace ricochet::contact
