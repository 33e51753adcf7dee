// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ricochet/units.hpp"

namespace ricochet::scene {

enum class Basis { modes, contact };

struct Modes {
  Basis basis = Basis::modes;
  /// With basis `modes`, exactly one of up_to and count is set. With basis `contact`, up_to is set together
  /// with one of count and flexibility_error. If neither up_to nor count is set, ricochet-kernel chooses them
  /// for the accuracy of the scene.
  std::optional<Hertz> up_to;
  std::optional<std::int64_t> count;  ///< including rigid modes
  /// Allowed error of the flexibility of the contact surface over [0, up_to]. With basis `modes`, modes that
  /// contact does not need are truncated.
  std::optional<double> flexibility_error;
  bool residual_flexibility = true;
  /// Whether the residual flexibility is always stored in all components, and not along the normals alone
  /// where these suffice.
  bool all_components = false;
  double relative_residual = 1e-8;  ///< bound on each mode's residual
  std::string solver = "ricochet";  ///< basis `modes`: type of SLEPc's EPS
  double low_rank = 0;              ///< basis `contact`: threshold of block low-rank factors; 0: full rank
  bool open() const { return !up_to && !count; }
  bool operator==(const Modes&) const = default;
};

}  // namespace ricochet::scene
