// SPDX-License-Identifier: BSD-2-Clause
// The estimated errors of one run, by quantity of interest and by cause.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "contact/figures/figure.hpp"

namespace ricochet::contact {

enum class Cause {
  mesh,         ///< order and size of the elements
  modes,        ///< end of the band of modes or Ritz vectors
  basis,        ///< error of the Ritz vectors within the band
  step,         ///< time step of contact
  eigensolver,  ///< residuals of the modes
  precision,    ///< single precision
  spacing,      ///< distance of the contact points
  zone,         ///< candidates beyond the reach
  rotation,     ///< finite rotations, in place of the linear ones whose errors the other causes are
};

struct ErrorEstimate {
  std::vector<Quantity> requested;                  ///< not empty
  std::map<Cause, std::optional<Errors>> by_cause;  ///< no value if unknown
  /// Whether the bodies meet with a front, as the ends of rods do.
  bool front = false;
  /// With finite rotations: end of the first touch, up to which the errors are estimated [s]. No value: to
  /// the end of the run.
  std::optional<double> until_s{};

  /// The error of several causes together. Their signs are unrelated, so that squares add up; but all of them
  /// blur a front, so that there the errors themselves do.
  double combined(const std::vector<double>& shares) const;
  /// Factor by which the error often exceeds its estimate, because changes of truncated fronts fluctuate.
  double scatter() const { return front ? 2 : 1; }
  /// The error of a quantity by the causes that are known.
  double total(Quantity quantity) const;
  /// The requested quantity with the largest error.
  Quantity worst() const;
  /// The largest error of the requested quantities.
  double total() const { return total(worst()); }
  /// Whether the error is probably below an accuracy: all shares are known, and scatter() times total() is
  /// below it.
  bool meets(double accuracy) const;
  /// The share of a cause in total(); no value if unknown.
  std::optional<double> share(Cause cause) const;
  /// The quantities with an error of any cause.
  std::vector<Quantity> quantities() const;
};

/// The name of a cause in summaries.
const char* name_of(Cause cause);

/// How to reduce the error of a cause.
const char* advice_on(Cause cause);

}  // namespace ricochet::contact
