// SPDX-License-Identifier: BSD-2-Clause
// The loops over modes in which a player spends its time, written so that compilers vectorise them, also for
// WebAssembly, for which Eigen has no packets.
#pragma once

#include <cstddef>

namespace ricochet::player {

/// Σ a_k b_k in four partial sums.
inline double dot(const double* a, const double* b, std::ptrdiff_t n) noexcept {
  double sums[4] = {0, 0, 0, 0};
  std::ptrdiff_t k = 0;
  for (; k + 4 <= n; k += 4)
    for (std::ptrdiff_t i = 0; i < 4; ++i) sums[i] += a[k + i] * b[k + i];
  for (; k < n; ++k) sums[0] += a[k] * b[k];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Motion of n modes without force, as in propagator.hpp: g = −ω² q, and the increment dq = S q̇ + c g.
inline void increment(const double* __restrict stiffness, const double* __restrict S,
                      const double* __restrict c, const double* __restrict q, const double* __restrict v,
                      double* __restrict g, double* __restrict dq, std::ptrdiff_t n) noexcept {
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    g[k] = -stiffness[k] * q[k];
    dq[k] = S[k] * v[k] + c[k] * g[k];
  }
}

/// The end of a step: q + dq, and q̇⁺ = S' q̇ + S g.
inline void advance(const double* __restrict rate, const double* __restrict S, const double* __restrict g,
                    const double* __restrict dq, double* __restrict q, double* __restrict v,
                    std::ptrdiff_t n) noexcept {
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    q[k] += dq[k];
    v[k] = rate[k] * v[k] + S[k] * g[k];
  }
}

/// Both at once, for free flight.
inline void fly(const double* __restrict stiffness, const double* __restrict S, const double* __restrict c,
                const double* __restrict rate, double* __restrict q, double* __restrict v,
                std::ptrdiff_t n) noexcept {
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const double g = -stiffness[k] * q[k], speed = v[k];
    q[k] += S[k] * speed + c[k] * g;
    v[k] = rate[k] * speed + S[k] * g;
  }
}

}  // namespace ricochet::player
