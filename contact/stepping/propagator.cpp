// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/propagator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace ricochet::contact {
namespace {

/// φ(x) = (eˣ − 1)/x, so that ∫₀^Δ e^{rt} dt = Δ φ(rΔ) for any r ≤ 0, zero included.
double phi(double x) { return x == 0 ? 1.0 : std::expm1(x) / x; }

/// (eˣ − 1 − x)/x² and (eˣ − 1 − x − x²/2)/x³ for x ≤ 0. They occur in the double and triple integrals of
/// e^{rt}.
struct Phis {
  double two, three;
};
Phis higher_phis(double x) {
  if (x > -1) {
    double two = 0, three = 0, term = 1;  // Σ xᵏ/(k+2)!, Σ xᵏ/(k+3)!; 1/22! < 1e-21
    for (int k = 0; k < 20; ++k) {
      two += term / (k + 2);
      three += term / ((k + 2.0) * (k + 3.0));
      term *= x / (k + 2);
    }
    return {two, three};
  }
  const double two = (std::expm1(x) - x) / x / x;
  return {two, (two - 0.5) / x};
}

/// The same as phi for a complex z ≠ 0 with Re z ≤ 0.
std::complex<double> phi(std::complex<double> z) {
  const double half = std::sin(0.5 * z.imag());
  const std::complex<double> expm1(std::expm1(z.real()) * std::cos(z.imag()) - 2 * half * half,
                                   std::exp(z.real()) * std::sin(z.imag()));
  return expm1 / z;
}

/// Roots of r² + 2δr + ω² = 0 for δ ≥ ω: slow = −ω²/(δ + s), fast = −(δ + s), s = √(δ² − ω²).
struct Roots {
  double slow, fast, s;
};
Roots roots(double omega, double decay) {
  const double s = std::sqrt(decay - omega) * std::sqrt(decay + omega);
  return {-omega * (omega / (decay + s)), -(decay + s), s};
}

double damped_frequency(double omega, double decay) {
  return std::sqrt(omega - decay) * std::sqrt(omega + decay);
}

/// Response to a unit impulse at time t and its rate.
struct Response {
  double S, rate;
};
Response response(double omega, double decay, double t) {
  if (decay < omega) {
    const double wd = damped_frequency(omega, decay), E = std::exp(-decay * t);
    const double S = E * std::sin(wd * t) / wd;
    return {S, E * std::cos(wd * t) - decay * S};
  }
  const auto [slow, fast, s] = roots(omega, decay);
  const double S = std::exp(slow * t) * t * phi(-2 * s * t);
  return {S, std::exp(fast * t) + slow * S};
}

/// Series for max(ω, δ)Δ ≤ 0.5: S(t) = Δ Σ y_k (t/Δ)^k, by the recurrence of S'' + 2δS' + ω²S = 0.
constexpr int terms = 32;  // of S²: 2^k/k! < 1e-26 at the end
using Series = std::array<double, terms + 1>;
constexpr double short_span = 0.5;

Series series(double omega, double decay, double step) {
  const double D = decay * step, X2 = (omega * step) * (omega * step);
  Series y{};
  y[1] = 1;
  for (int k = 0; k + 2 <= terms; ++k)
    y[k + 2] = -(2 * D * (k + 1) * y[k + 1] + X2 * y[k]) / ((k + 2.0) * (k + 1.0));
  return y;
}

ModeResponse short_response(const Series& y, double step) {
  ModeResponse sum{};
  for (int k = terms; k >= 1; --k) {  // smallest terms first
    double term = y[k];
    sum.rate += k * term;
    sum.S += term;
    sum.c += term /= k + 1;
    sum.r += term /= k + 2;
    sum.w += term /= k + 3;
  }
  const double square = step * step;
  return {sum.rate, step * sum.S, square * sum.c, step * square * sum.r, square * square * sum.w};
}

/// ∫S², ∫S'² and ∫c² over a step.
struct Squares {
  double ss, rr, cc;
};

Squares short_squares(const Series& y, double step) {
  double ss = 0, rr = 0, cc = 0;
  for (int k = terms; k >= 0; --k) {
    double of_S = 0, of_rate = 0, of_c = 0;  // coefficients of t^k in S² and S'², of t^{k+2} in c²
    for (int i = 0; i <= k; ++i) {
      const double pair = y[i] * y[k - i];
      of_S += pair;
      of_c += pair / ((i + 1.0) * (k - i + 1.0));
      if (k < terms) of_rate += (i + 1) * y[i + 1] * (k - i + 1) * y[k - i + 1];
    }
    ss += of_S / (k + 1);
    rr += of_rate / (k + 1);
    cc += of_c / (k + 3);
  }
  const double cube = step * step * step;
  return {cube * ss, step * rr, step * step * cube * cc};
}

/// c = ∫₀^Δ S of a step that is not short.
double flexibility(double omega, double decay, double step, double S) {
  if (decay < omega) {
    // 1 − a = (1 − E) + E (1 − cos) − δ S; each part is free of cancellation if damping is weak
    const double half = std::sin(0.5 * damped_frequency(omega, decay) * step);
    const double rest = -std::expm1(-decay * step) + std::exp(-decay * step) * 2 * half * half - decay * S;
    return std::max(0.0, rest) / omega / omega;
  }
  const auto [slow, fast, s] = roots(omega, decay);
  if (decay < 1.1 * omega) return (1 - std::exp(fast * step) + fast * S) / omega / omega;
  return step * (phi(slow * step) - phi(fast * step)) / (2 * s);
}

/// r = ∫c and w = ∫r of a step that is not short.
struct Integrals {
  double r, w;
};
Integrals integrals(double omega, double decay, double step, double S, double c) {
  if (decay >= 1.1 * omega) {
    const auto [slow, fast, s] = roots(omega, decay);
    const Phis of_slow = higher_phis(slow * step), of_fast = higher_phis(fast * step);
    return {step * (step * (of_slow.two - of_fast.two) / (2 * s)),
            step * (step * (step * (of_slow.three - of_fast.three) / (2 * s)))};
  }
  // The equation of motion, integrated twice and three times. With ωΔ > 0.45, few digits cancel.
  const double r = (step - S - 2 * decay * c) / omega / omega;
  return {r, (0.5 * step * step - c - 2 * decay * r) / omega / omega};
}

// Gauss–Legendre, 8 points.
constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                        0.9602898564975363};
constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                          0.1012285362903763};

// The next two functions leave cc at 0.

/// Close to ζ = 1, the closed forms are small differences of large numbers; S and S' themselves are not.
Squares squares_near_critical(double omega, double decay, double step) {
  // Panels of about 1/δ integrate e^{−2δt} with an error below 1e-18; beyond 50/δ, it is negligible.
  const double end = std::min(step, 50 / decay);
  const int panels = std::max(1, static_cast<int>(std::ceil(end * decay)));
  const double half = 0.5 * end / panels;
  Squares sum{};
  for (int p = panels - 1; p >= 0; --p)
    for (std::size_t k = 0; k < node.size(); ++k)
      for (const double side : {-1.0, 1.0}) {
        const auto [S, rate] = response(omega, decay, (2 * p + 1 + side * node[k]) * half);
        sum.ss += weight[k] * half * S * S;
        sum.rr += weight[k] * half * rate * rate;
      }
  return sum;
}

Squares squares(double omega, double decay, double step) {
  if (std::abs(decay - omega) < 0.1 * omega) return squares_near_critical(omega, decay, step);
  if (decay < omega) {
    // S² = e^{−2δt} (1 − cos 2ω_dt)/(2ω_d²);   S' = Re A e^{(−δ + iω_d)t} with A = 1 + iδ/ω_d
    const double wd = damped_frequency(omega, decay);
    const std::complex<double> A(1, decay / wd), turning = phi(2 * step * std::complex<double>(-decay, wd));
    const double decaying = phi(-2 * decay * step);
    return {0.5 * (step / wd) / wd * (decaying - turning.real()),
            0.5 * step * (std::norm(A) * decaying + (A * A * turning).real()), 0};
  }
  // S = (e^{slow t} − e^{fast t})/(2s), S' = (slow e^{slow t} − fast e^{fast t})/(2s)
  const auto [slow, fast, s] = roots(omega, decay);
  const double of_slow = phi(2 * slow * step), of_both = phi(-2 * decay * step),
               of_fast = phi(2 * fast * step);
  const double p = slow / (2 * s), q = fast / (2 * s);
  return {step / (2 * s) / (2 * s) * (of_slow - 2 * of_both + of_fast),
          step * (p * p * of_slow - 2 * p * q * of_both + q * q * of_fast), 0};
}

/// ∫c² if the slow root hardly decays in the step: beyond 40/|fast|, c is a polynomial to round-off.
double ramp_square_of_slow(double omega, double decay, double step) {
  const auto [slow, fast, s] = roots(omega, decay);
  const double width = -2 / fast;
  double sum = 0, from = 0;
  while (from < step) {
    const double to = from < 20 * width ? std::min(step, from + width) : step, half = 0.5 * (to - from);
    for (std::size_t k = 0; k < node.size(); ++k)
      for (const double side : {-1.0, 1.0}) {
        const double t = from + (1 + side * node[k]) * half,
                     c = t * (phi(slow * t) - phi(fast * t)) / (2 * s);
        sum += weight[k] * half * c * c;
      }
    from = to;
  }
  return sum;
}

/// ∫c² of a step that is not short, from c'' + 2δc' + ω²c = 1 multiplied by c.
double ramp_square(double omega, double decay, double step, const ModeResponse& m, double ss) {
  if (decay >= 1.1 * omega && -roots(omega, decay).slow * step < 0.5)
    return ramp_square_of_slow(omega, decay, step);
  return (m.r - m.c * m.S - decay * m.c * m.c + ss) / omega / omega;
}

bool is_short(double omega, double decay, double time) { return std::max(omega, decay) * time <= short_span; }

}  // namespace

ModeResponse mode_response(double omega, double decay, double time) noexcept {
  if (is_short(omega, decay, time)) return short_response(series(omega, decay, time), time);
  const auto [S, rate] = response(omega, decay, time);
  const double c = flexibility(omega, decay, time, S);
  const auto [r, w] = integrals(omega, decay, time, S, c);
  return {rate, S, c, r, w};
}

ModeStep mode_step(double omega, double decay, double step) noexcept {
  const ModeResponse m = mode_response(omega, decay, step);
  Squares by{};
  if (is_short(omega, decay, step)) {
    by = short_squares(series(omega, decay, step), step);
  } else {
    by = squares(omega, decay, step);
    by.cc = ramp_square(omega, decay, step, m, by.ss);
  }
  return {m, by.ss, 0.5 * m.S * m.S, by.rr, by.cc};
}

}  // namespace ricochet::contact
