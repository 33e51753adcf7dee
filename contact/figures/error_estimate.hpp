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
};

struct ErrorEstimate {
  std::vector<Quantity> requested;                  ///< not empty
  std::map<Cause, std::optional<Errors>> by_cause;  ///< no value if unknown
  /// Factor by which the error often exceeds its estimate: 2 for rods, whose ends meet with a front, since
  /// the changes of truncated fronts fluctuate by as much.
  double scatter = 1;

  /// The error of a quantity: the sum over the causes that are known.
  double total(Quantity quantity) const;
  /// The requested quantity with the largest error.
  Quantity worst() const;
  /// The largest error of the requested quantities.
  double total() const { return total(worst()); }
  /// Whether the error is probably below an accuracy: all shares are known, and `scatter` times total() is
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
