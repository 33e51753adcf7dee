// SPDX-License-Identifier: BSD-2-Clause
// The figures of one run, gathered step by step, and summary.json.
//
// λ_k acts over (t_{k−1}, t_k]: contact starts at the beginning of the first step with a force and ends at
// the end of the last one. An episode is a run of steps with a force; a step without one ends it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/static/equilibrium.hpp"

namespace ricochet::contact {

struct Episode {
  double start_s = 0;
  std::optional<double> end_s;  ///< none: touching in the last step of the run
  double impulse_ns = 0;        ///< Σ λ_i Δ
  double peak_force_n = 0;      ///< largest Σ_i λ_i of a step
};

/// Contributions to the relative error of the quantities of interest (quantities.hpp); none: unknown.
struct ErrorEstimate {
  std::optional<double> mesh, modes, step, eigensolver, precision, spacing;
  struct Cause {
    const char* name;
    std::optional<double> share;
    const char* advice;  ///< how to reduce it
  };
  std::array<Cause, 6> causes() const;
  double total() const;  ///< sum of those known
};

/// A WAV file of a receiver's velocity.
struct Sound {
  std::string file;
  double full_scale_m_per_s = 0;  ///< velocity of a sample of 1
  double rate_hz = 0;             ///< of the file
};

struct Summary {
  std::optional<double> contact_start_s;
  std::optional<double> contact_end_s;  ///< none: never touched, or touching in the last step
  std::int64_t contact_steps = 0;       ///< steps with a force
  std::vector<Episode> episodes;
  double peak_force_n = 0;  ///< largest Σ_i λ_i of a step
  double impulse_ns = 0;    ///< Σ λ_i Δ over the run
  /// Mass-mean, when contact last ended [m/s]; empty where contact_end_s is.
  std::map<std::string, Eigen::Vector3d> exit_velocity;
  /// Minus exit over approach relative velocity along the impulse, supported bodies and obstacles at 0.
  /// None without an end, without an approach, or when more than one pair touched.
  std::optional<double> restitution;
  /// Largest departure of the ledger over the largest kinetic + strain + residual, work of loads or energy
  /// taken by contact; none with table kernels.
  std::optional<double> energy_drift;
  /// Taken by contact over kinetic + strain when contact started; none with table kernels, or where bodies at
  /// rest lost what loads gave them later.
  std::optional<double> energy_lost_contact;
  double max_penetration_m = 0;    ///< largest u − g at the end of a step
  std::int64_t limited_steps = 0;  ///< steps that max_pivots cut short
  double limited_residual = 0;     ///< worst of them: SolveResidual violation over scale
  std::map<std::string, int> modes;
  std::map<std::string, std::string> basis;  ///< by body, as by kernels::Modes::kind
  int modes_in_residual = 0;                 ///< above half the rate: quasi-static in this run
  Precision precision = Precision::float64;  ///< of the products of steps
  int candidates = 0;                        ///< paired points m
  int unpaired = 0;
  int max_active = 0;
  std::optional<ErrorEstimate> error_estimate;  ///< none: not estimated; the caller's to fill
  std::map<std::string, Sound> sounds;          ///< by receiver; the caller's to fill
  std::vector<std::string> warnings;
  double real_time_factor = 0;  ///< simulated over elapsed time of the stepping
  double wall_s = 0;
};

/// The figures of bodies at rest.
struct EquilibriumSummary {
  struct Pair {
    double force_n = 0;          ///< |Σ λ_i n_i|
    double approach_m = 0;       ///< of the centres of mass since the start, along Σ λ_i n_i
    int contact_points = 0;      ///< with λ > 0
    double contact_area_m2 = 0;  ///< of their patches
    double peak_pressure_pa = 0;
  };
  std::vector<Pair> pairs;
  double imbalance = 0;
  double max_penetration_m = 0;  ///< largest u − g
  std::map<std::string, int> modes;
  std::map<std::string, std::string> basis;
  int candidates = 0, unpaired = 0;
  std::int64_t iterations = 0;
  std::optional<ErrorEstimate> error_estimate;  ///< the caller's to fill
  std::vector<std::string> warnings;
  double wall_s = 0;  ///< the caller's to fill
};

EquilibriumSummary summarise(const Model& model, const Equilibrium& equilibrium);

/// The text of summary.json.
std::string json_text(const Summary& summary);

/// Writes a temporary file and renames it to `path`. Throws InputError if the place cannot be written.
void write_json(const Summary& summary, const std::filesystem::path& path);
std::string json_text(const EquilibriumSummary& summary);
void write_json(const EquilibriumSummary& summary, const std::filesystem::path& path);

}  // namespace ricochet::contact
