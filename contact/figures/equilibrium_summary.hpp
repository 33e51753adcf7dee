// SPDX-License-Identifier: BSD-2-Clause
// The main results for bodies at rest.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/error_estimate.hpp"
#include "contact/figures/pressure_check.hpp"
#include "contact/figures/summary.hpp"
#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"

namespace ricochet::contact {

struct EquilibriumSummary {
  struct Pair {
    double force_n = 0;          ///< |Σ λ_i n_i|
    double approach_m = 0;       ///< of the centres of mass from the start, with supports, along Σ λ_i n_i
    int contact_points = 0;      ///< number of points with λ > 0
    double contact_area_m2 = 0;  ///< total area of their patches
    double peak_pressure_pa = 0;
    // With friction; no values without it.
    std::optional<double> friction_n;  ///< |Σ τ_i|
    std::optional<int> sticking_points, slipping_points;
  };
  std::vector<Pair> pairs;
  std::map<std::string, StressPeak> stress;               ///< as of Summary
  std::map<std::string, GaugePeaks> gauges;               ///< likewise
  std::map<std::string, StressEnvelope> stress_envelope;  ///< likewise; of this equilibrium
  double imbalance = 0;
  double max_penetration_m = 0;  ///< largest u − g
  std::map<std::string, int> modes;
  std::map<std::string, std::string> basis;
  int candidates = 0, unpaired = 0;
  /// Increments with friction whose forces are known not to be the only ones; no value without friction.
  std::optional<std::int64_t> ambiguous_increments;
  std::int64_t iterations = 0;
  std::optional<ErrorEstimate> error_estimate;  ///< set by the caller
  std::vector<std::string> warnings;
  std::string run;    ///< identifier of the run, as in its other files; set by the caller
  double wall_s = 0;  ///< set by the caller

  Figures quantities() const;  ///< force and approach of each pair
};

/// @param limits  by body, for warnings on pressure and stress; empty: unknown
EquilibriumSummary summarise(const Model& model, const Equilibrium& equilibrium,
                             std::vector<MaterialLimits> limits = {});

}  // namespace ricochet::contact
