// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/damping.hpp"

namespace ricochet::kernels {

double decay_rate(const Damping& damping, RadPerSecond omega) {
  using Law = Damping::Law;
  const double square = omega.value * omega.value;
  switch (damping.law) {
    case Law::none:
      return 0;
    case Law::ratio:
      return damping.first * omega.value;
    case Law::loss_factor:
      return damping.first / 2 * omega.value;
    case Law::rayleigh:
      return (damping.first + damping.second * square) / 2;
    case Law::viscosity:
      return damping.first * square / 2;
  }
  return 0;
}

}  // namespace ricochet::kernels
