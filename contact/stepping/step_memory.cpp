// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/step_memory.hpp"

#include <algorithm>

#include "contact/simd/simd.hpp"
#include "contact/stepping/block_system.hpp"
#include "contact/stepping/look_ahead_stepper.hpp"

namespace ricochet::contact {
namespace {

constexpr double number = sizeof(double);

/// Rows of bodies that turn which touch at once: more than those of a face of a body that is meshed to
/// tumble.
constexpr double rows_of_turning_bodies = 600;
constexpr double bytes_of_moving_point = 700, vectors_of_rows = 30;

}  // namespace

double model_bytes(const ModelSize& size) {
  if (size.turns) return 0;
  const auto n = static_cast<double>(size.rows), N = static_cast<double>(size.modes);
  return number * (n * N + (size.two_sided ? 2 : 1) * n * n);
}

double stepper_bytes(const ModelSize& size, const StepOptions& options) {
  const auto n = static_cast<double>(size.rows), m = static_cast<double>(size.points),
             near = static_cast<double>(size.near);
  const bool rubs = size.rows > size.points, compliant = options.contact.scheme == Scheme::compliant;
  const bool conserving = options.contact.integration == ContactStep::conserving && size.has_residual;
  const bool blocks = compliant && options.block != 1 && size.points > 0;
  // The factor of the active set of two solvers, and with friction three more matrices of the points that
  // touch.
  if (size.turns) {
    const double at_once = std::min(n, rows_of_turning_bodies);
    return bytes_of_moving_point * m +
           number * (vectors_of_rows * n + (4 + 2 * (rubs ? 5 : 1)) * at_once * at_once);
  }
  const double touching = blocks ? near : n;
  const double solvers = 2 * (rubs ? 5 : 1) * number * touching * touching;
  if (!compliant) return number * (m * m + near * near) + solvers;
  const double islands = size.pairs > 1 ? 4 * number * near * near : 0;
  const double matrices = conserving ? 4 : 3;  // R, M, S and S_mean
  if (!blocks) return matrices * number * n * n + solvers + islands;
  const double T = options.precision == Precision::float64 ? sizeof(double) : sizeof(float);
  const auto length = static_cast<double>(look_ahead_length(options, size.rows));
  const auto width = static_cast<double>(simd::padded(static_cast<std::size_t>(size.rows), simd::point_pad)),
             modes = static_cast<double>(simd::padded(static_cast<std::size_t>(size.modes)));
  // B twice; of the rows that may touch, the lags and M, and the influence and flexibility on all rows.
  const auto of_rows = [&](double rows) {
    return rows * ((T * length + number) * rows + 2 * sizeof(float) * width);
  };
  const double all = of_rows(width),
               block = n * modes * (T + number) + (all > matrices_at_once ? of_rows(near) : all);
  const double gathered = (T * length + number * matrices) * near * near;
  return solvers + islands + block + gathered;
}

}  // namespace ricochet::contact
