// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/damping.hpp"

#include <algorithm>
#include <cmath>

#include "ricochet/units.hpp"

namespace ricochet::kernels {
namespace {

/// T60 [s] at a frequency: linear in log f and log T60 between rows, constant beyond the first and the last.
double decay_time(const std::vector<std::array<double, 2>>& table, Hertz frequency) {
  const auto above = std::ranges::find_if(table, [&](const auto& row) { return row[0] > frequency.value; });
  if (above == table.begin()) return table.front()[1];
  if (above == table.end()) return table.back()[1];
  const auto [f0, t0] = *(above - 1);
  const auto [f1, t1] = *above;
  return t0 * std::pow(t1 / t0, std::log(frequency.value / f0) / std::log(f1 / f0));
}

/// @param elastic  index of the mode among those with ω > 0
double decay_rate(const Damping& damping, double omega, std::size_t elastic) {
  using Law = Damping::Law;
  const double square = omega * omega;
  switch (damping.law) {
    case Law::none:
      return 0;
    case Law::ratio:
      return damping.first * omega;
    case Law::loss_factor:
      return damping.first / 2 * omega;
    case Law::rayleigh:
      return (damping.first + damping.second * square) / 2;
    case Law::viscosity:
      return damping.first * square / 2;
    case Law::t60:  // e^(−δ T60) = 10⁻³; rigid motion does not decay
      return omega > 0 ? std::log(1e3) / decay_time(damping.table, to_hertz(RadPerSecond{omega})) : 0;
    case Law::by_mode:
      return omega > 0 ? damping.by_mode[std::min(elastic, damping.by_mode.size() - 1)] / 2 * omega : 0;
  }
  return 0;
}

}  // namespace

std::vector<double> decay_rates(const Damping& damping, const std::vector<double>& omega) {
  const auto rigid = static_cast<std::size_t>(std::ranges::count(omega, 0.0));
  std::vector<double> out;
  for (std::size_t n = 0; n < omega.size(); ++n)
    out.push_back(decay_rate(damping, omega[n], n < rigid ? 0 : n - rigid));
  return out;
}

}  // namespace ricochet::kernels
