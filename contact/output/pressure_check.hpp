// SPDX-License-Identifier: BSD-2-Clause
// Checks whether the materials of the bodies bear the pressure of a run.
//
// The pressure of a patch is the mean λ_i / A_i. A contact that is smaller than its patch has a larger one,
// so the check finds too little there, never too much.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Of the weakest material of a body.
struct MaterialLimits {
  double young = 0;  ///< smallest E [Pa]; 0: unknown
  double yield = 0;  ///< smallest stress at which one yields [Pa]; 0: unknown
};

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
  void compare(int body, double pressure, double time, Excess& strain, Excess& yielding) const;

  const Model& model_;
  std::vector<MaterialLimits> limits_;
  Vector per_area_;                     ///< (m) 1/A_i; 0 where A_i is 0
  std::vector<double> largest_, time_;  ///< by pair: largest pressure [Pa], and when [s]
};

}  // namespace ricochet::contact
