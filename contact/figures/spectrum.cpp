// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>

// Requires <cmath> before it.
#include <kissfft/kissfft.hh>

namespace ricochet::contact {
namespace {

/// Bands of third_octaves, by k.
constexpr int lowest_band = -17, highest_band = 13;

struct Spectrum {
  double spacing = 0;         ///< of the frequencies [Hz]
  std::vector<double> power;  ///< |F|² at k · spacing, without negative frequencies
};

Spectrum spectrum_of(const std::vector<double>& signal, double step) {
  const std::size_t n = std::bit_ceil(std::max<std::size_t>(2, signal.size()));
  std::vector<std::complex<double>> in(n), out(n);
  std::ranges::copy(signal, in.begin());
  kissfft<double>(n, false).transform(in.data(), out.data());
  Spectrum spectrum{1 / (static_cast<double>(n) * step), std::vector<double>(n / 2 + 1)};
  for (std::size_t k = 0; k <= n / 2; ++k) spectrum.power[k] = std::norm(out[k] * step);
  return spectrum;
}

}  // namespace

Hertz band_filled(const std::vector<double>& signal, double step, double rest) {
  const Spectrum spectrum = spectrum_of(signal, step);
  double all = 0, above = 0;
  for (const double power : spectrum.power) all += power;
  if (all == 0) return Hertz{0};
  std::size_t k = spectrum.power.size();
  while (k > 1 && above + spectrum.power[k - 1] <= rest * all) above += spectrum.power[--k];
  return Hertz{static_cast<double>(k) * spectrum.spacing};
}

Vector third_octaves(const std::vector<double>& signal, double step) {
  const Spectrum spectrum = spectrum_of(signal, step);
  Vector energy = Vector::Zero(highest_band - lowest_band + 1);
  for (std::size_t k = 1; k < spectrum.power.size(); ++k) {
    const double octaves = std::log2(static_cast<double>(k) * spectrum.spacing / 1000);
    const auto band = static_cast<Eigen::Index>(std::floor(3 * octaves + 0.5)) - lowest_band;
    if (band >= 0 && band < energy.size()) energy[band] += 2 * spectrum.power[k] * spectrum.spacing;
  }
  return energy.cwiseSqrt();
}

}  // namespace ricochet::contact
