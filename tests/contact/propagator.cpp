// SPDX-License-Identifier: BSD-2-Clause
// One step of one mode, compared with the matrix exponential in quadruple precision (Taylor series, scaling
// and squaring). This oracle uses no sines, no roots and no cases of damping.
#include "contact/stepping/propagator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace propagator_test {

using ricochet::contact::mode_response;
using ricochet::contact::mode_step;
using ricochet::contact::ModeResponse;
using ricochet::contact::ModeStep;

__extension__ typedef __float128 Quad;  // 113 bits: 20 digits remain even after 2^40 squarings

template <std::size_t n>
using Square = std::array<std::array<Quad, n>, n>;

template <std::size_t n>
Square<n> product(const Square<n>& x, const Square<n>& y) {
  Square<n> z{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k) z[i][j] += x[i][k] * y[k][j];
  return z;
}

/// exp(M). M is first divided by 2^k so that its entries are below 1/8.
template <std::size_t n>
Square<n> exponential(Square<n> m) {
  Quad largest = 0;
  for (const auto& row : m)
    for (const Quad x : row) largest = std::max(largest, x < 0 ? -x : x);
  int halvings = 0;
  for (; largest > Quad(0.125); largest /= 2) ++halvings;
  for (auto& row : m)
    for (Quad& x : row)
      for (int k = 0; k < halvings; ++k) x /= 2;
  Square<n> sum{}, term{};
  for (std::size_t i = 0; i < n; ++i) sum[i][i] = term[i][i] = 1;
  for (int k = 1; k < 40; ++k) {
    term = product(term, m);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) sum[i][j] += (term[i][j] /= k);
  }
  for (int k = 0; k < halvings; ++k) sum = product(sum, sum);
  return sum;
}

struct Exact {
  Quad b, c, e, ss, sr, rr;
};

/// Time is in units of Δ. Motion: (q, q̇, f)'. Squares: x = (S², S S', S'²) satisfies x₁' = 2x₂,
/// x₂' = x₃ − 2δx₂ − ω²x₁, x₃' = −4δx₃ − 2ω²x₂; two more rows integrate x₁ and x₃.
Exact exact_step(double omega, double decay, double step) {
  const Quad D = Quad(decay) * step, X2 = Quad(omega) * step * Quad(omega) * step, dt = step;
  const auto M = exponential<3>({{{0, 1, 0}, {-X2, -2 * D, 1}, {0, 0, 0}}});
  const auto Q = exponential<5>({{{0, 2, 0, 0, 0},
                                  {-X2, -2 * D, 1, 0, 0},
                                  {0, -2 * X2, -4 * D, 0, 0},
                                  {1, 0, 0, 0, 0},
                                  {0, 0, 1, 0, 0}}});
  return {M[0][1] * dt,           M[0][2] * dt * dt,     M[1][1],
          Q[3][2] * dt * dt * dt, Q[0][2] / 2 * dt * dt, Q[4][2] * dt};
}

double error(double got, Quad want) { return std::abs(static_cast<double>(Quad(got) - want)); }

/// Time is in units of Δ. Motion under a force that grows from 0: (q, q̇, f, k)'; another row integrates q.
/// Squares: y = (c², c S, S², c, S, 1) satisfies y₁' = 2y₂, y₂' = y₃ + y₄ − 2δy₂ − ω²y₁,
/// y₃' = 2y₅ − 4δy₃ − 2ω²y₂, y₄' = y₅, y₅' = 1 − 2δy₅ − ω²y₄; another row integrates y₁.
void expect_exact_ramp(double omega, double decay, double step, const ModeStep& m) {
  const Quad D = Quad(decay) * step, X2 = Quad(omega) * step * Quad(omega) * step, dt = step;
  const auto M = exponential<5>(
      {{{0, 1, 0, 0, 0}, {-X2, -2 * D, 1, 0, 0}, {0, 0, 0, 1, 0}, {0, 0, 0, 0, 0}, {1, 0, 0, 0, 0}}});
  const auto Q = exponential<7>({{{0, 2, 0, 0, 0, 0, 0},
                                  {-X2, -2 * D, 1, 1, 0, 0, 0},
                                  {0, -2 * X2, -4 * D, 0, 2, 0, 0},
                                  {0, 0, 0, 0, 1, 0, 0},
                                  {0, 0, 0, -X2, -2 * D, 1, 0},
                                  {0, 0, 0, 0, 0, 0, 0},
                                  {1, 0, 0, 0, 0, 0, 0}}});
  const double r = static_cast<double>(M[0][3] * dt * dt * dt),
               w = static_cast<double>(M[4][3] * dt * dt * dt * dt),
               cc = static_cast<double>(Q[6][5] * dt * dt * dt * dt * dt);
  // From ωΔ = 0.5 on, r, w and cc are differences that amount to 1/25, 1/50 and 1/40 of their
  // terms, and cc inherits the error of r.
  const double eps = std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(m.r, r, 200 * eps * r);
  EXPECT_NEAR(m.w, w, 1000 * eps * w);
  EXPECT_NEAR(m.cc, cc, 2000 * eps * cc);
}

void expect_exact(double omega, double decay, double step) {
  SCOPED_TRACE(testing::Message() << "omega " << omega << " decay " << decay << " step " << step);
  const ModeStep m = mode_step(omega, decay, step);
  const Exact x = exact_step(omega, decay, step);
  // Round-off of ω alone shifts the phase by ε ωΔ and the decay by ε δΔ (slow root:
  // ω²Δ/2δ < ωΔ). The factor 20 covers the sums.
  const double eps = 20 * std::numeric_limits<double>::epsilon() * (1 + omega * step);
  // Where a value passes through zero, its error is that of its terms, which the envelope of S bounds.
  const double size_S = static_cast<double>(x.b < 0 ? -x.b : x.b);
  const double slow = decay > omega ? omega * omega / decay : 0;
  const double envelope =
      decay < omega ? std::exp(-decay * step) : static_cast<double>(x.e < 0 ? -x.e : x.e) + slow * size_S;
  const double width =
      decay < omega ? std::min(step, 1 / std::sqrt((omega - decay) * (omega + decay))) * envelope : size_S;
  const double tiny = 1e-290;
  EXPECT_LE(error(m.S, x.b), eps * width + tiny);
  expect_exact_ramp(omega, decay, step, m);
  // c = (1 − a)/ω² of a weakly damped mode near a whole number of periods: relative to the terms that cancel.
  EXPECT_LE(error(m.c, x.c),
            eps * std::max(static_cast<double>(x.c), omega > 0 ? envelope / omega / omega : 0.0) + tiny)
      << m.c << " for " << static_cast<double>(x.c);
  EXPECT_LE(error(m.rate, x.e), eps * (envelope + (decay < omega ? decay * width : 0)) + tiny);
  EXPECT_LE(error(m.ss, x.ss), 10 * eps * static_cast<double>(x.ss) + tiny) << m.ss;
  EXPECT_LE(error(m.sr, x.sr), 2 * eps * width * width + tiny);
  EXPECT_LE(error(m.rr, x.rr), 10 * eps * static_cast<double>(x.rr) + tiny) << m.rr;
  EXPECT_GE(m.c, 0);
}

TEST(ModeStep, equals_the_matrix_exponential_for_any_damping_and_step) {
  const double step = 1 / 44100.0;
  for (double x = 1e-9; x < 1.5e4; x *= 2.7)
    for (const double zeta :
         {0.0, 1e-12,    1e-4,     0.02,  0.3,  0.7,  0.89, 0.91, 0.999, 1 - 1e-5, 1 - 1e-9,
          1.0, 1 + 1e-9, 1 + 1e-5, 1.001, 1.09, 1.11, 1.5,  3.0,  10.0,  100.0})
      expect_exact(x / step, zeta * (x / step), step);
}

TEST(ModeStep, is_continuous_where_series_and_closed_forms_meet) {
  for (const double zeta : {0.0, 0.3, 0.95, 1.0, 1.05, 2.0, 50.0})
    for (const double x : {0.5, 0.4999999, 0.5000001}) {
      const double omega = x / std::max(1.0, zeta);
      expect_exact(omega, zeta * omega, 1.0);
    }
}

TEST(ModeStep, moves_a_rigid_mode_with_and_without_decay) {
  for (double decay = 1e-9; decay < 1e5; decay *= 10) expect_exact(0, decay, 0.01);
  const ModeStep m = mode_step(0, 0, 0.01);
  EXPECT_EQ(m.S, 0.01);
  EXPECT_DOUBLE_EQ(m.c, 0.5e-4);
  EXPECT_EQ(m.rate, 1);
}

// After whole periods, 1 − a nearly vanishes. Phase errors of 2ε per period give a relative error of
// 4ε/1e-6 = 1e-9, whereas evaluation of 1 − cos would give 1e-5.
TEST(ModeStep, keeps_the_small_flexibility_of_steps_a_millionth_off_a_whole_period) {
  const double omega = 6.283185307179586;
  for (const double turns : {1.0, 3.0})
    for (const double decay : {0.0, 1e-13, 1e-10}) {
      const double step = turns * (1 + 1e-6), exact = static_cast<double>(exact_step(omega, decay, step).c);
      EXPECT_LT(exact * omega * omega, 1e-8);
      EXPECT_NEAR(mode_step(omega, decay, step).c, exact, 1e-8 * exact) << turns << " " << decay;
    }
}

TEST(ModeStep, stays_finite_for_huge_frequencies_and_decays) {
  for (const double omega : {0.0, 1.0, 1e8, 1e100, 1e150})
    for (const double decay : {0.0, 1.0, 1e8, 1e100, 1e150}) {
      const ModeStep m = mode_step(omega, decay, 1.0);
      for (const double x : {m.S, m.c, m.rate, m.ss, m.sr, m.rr, m.r, m.w, m.cc})
        EXPECT_TRUE(std::isfinite(x)) << omega << " " << decay;
      EXPECT_GE(m.c, 0);
    }
}

}  // namespace propagator_test
