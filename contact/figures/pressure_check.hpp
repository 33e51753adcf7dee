// SPDX-License-Identifier: BSD-2-Clause
// Checks whether the materials of the bodies bear the pressure of a run.
//
// The pressure at a pressed point is the mean over it and the pressed points next to it, Σ λ / Σ A. Forces of
// single points scatter where meshes do not match: on resolved balls, the largest λ_i / A_i is up to 2.8
// times Hertz's pressure, and the largest mean up to 1.5 times. A contact that is smaller than a patch has a
// larger pressure than this mean.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "ricochet/material_limits.hpp"

namespace ricochet::contact {

class PressureCheck {
 public:
  /// @param limits  by body; empty: unknown
  /// `model` must outlive the check.
  PressureCheck(const Model& model, std::vector<MaterialLimits> limits);

  /// @param force  (n) [N], @param time  [s]
  void observe(const Vector& force, double time);

  /// At most one line on strains and one on yielding.
  std::vector<std::string> warnings() const;

 private:
  struct Excess {
    double share = 0;  ///< of the limit
    std::string text;
  };
  double mean_around(Eigen::Index i, const Model::PairBlock& pair, const Vector& force);
  void compare(int body, double pressure, double time, Excess& strain, Excess& yielding) const;

  const Model& model_;
  std::vector<MaterialLimits> limits_;
  Vector per_area_;                     ///< (m) 1/A_i; 0 where A_i is 0
  Vector reach_;                        ///< (m) of the neighbours of a point [m]; 0: not known yet
  std::vector<Eigen::Index> pressed_;   ///< points of a pair
  std::vector<double> largest_, time_;  ///< by pair: largest pressure [Pa], and when [s]
};

}  // namespace ricochet::contact
