// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/figure.hpp"

#include <limits>

namespace ricochet::contact {

double relative_error(const Vector& value, const Vector& reference, double scale) {
  const double apart = (value - reference).norm();
  if (apart == 0) return 0;
  return scale > 0 ? apart / scale : std::numeric_limits<double>::infinity();
}

}  // namespace ricochet::contact
