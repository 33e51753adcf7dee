// SPDX-License-Identifier: BSD-2-Clause
// The main results of one run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/error_estimate.hpp"
#include "contact/figures/impact_figures.hpp"
#include "contact/figures/stress_envelope.hpp"
#include "ricochet/scheme.hpp"

namespace ricochet::contact {

/// A WAV file of velocities of receivers.
struct Sound {
  std::string file;
  double full_scale_m_per_s = 0;  ///< velocity of a sample of 1
  double rate_hz = 0;             ///< of the file
};

/// The largest acceleration of a receiver, as a vector.
struct AccelerationPeaks {
  double peak_m_per_s2 = 0;  ///< of all steps
  double time_s = 0;         ///< when
  /// Behind the filter of each class of SAE J211-1 (shock.hpp); no value if the output samples are too few.
  std::map<int, std::optional<double>> by_class;
};

/// The largest von Mises stress at the gauges of a body and on its visualisation surface.
struct StressPeak {
  std::string gauge;                       ///< where; empty: a node of the surface
  Eigen::Vector3d at{0, 0, 0};             ///< its point, in the axes of the body [m]
  double von_mises_pa = 0;                 ///< of all steps
  double time_s = 0;                       ///< when
  std::optional<double> ratio_to_yield{};  ///< no value if the yield of the body is not known
};

/// The largest stress and strain at a gauge.
struct GaugePeaks {
  double von_mises_pa = 0;              ///< of all steps
  double von_mises_time_s = 0;          ///< when
  std::optional<double> strain_peak;    ///< magnitude, of all steps; no value if the gauge has no direction
  std::optional<double> strain_time_s;  ///< when; likewise
};

/// Sizes of what finite rotations neglect for a body, the largest of the run.
struct Neglected {
  std::optional<double> centrifugal_strain;  ///< (Ωr/c)², about; no value if the wave speed is not known
  double frequency_shift = 0;                ///< (Ω/ω)² of the lowest elastic mode, about
  /// Bound 2Ω/(ω_n − ω_m) on the share of amplitude that modes exchange which no Coriolis force couples.
  double mode_mixing = 0;
  double compression = 0;  ///< kernels::CompactFlexibility::error
};

struct Summary : ImpactFigures {
  /// Largest deviation of the ledger, relative to the largest of kinetic + strain + residual energy, work of
  /// loads, and energy lost in contact. No value with sampled responses.
  std::optional<double> energy_drift;
  /// Energy lost in contact, relative to the energy that was put in (FigureObserver::energy_put_in). No value
  /// with sampled responses, or if energy was lost and none put in.
  std::optional<double> energy_lost_contact;
  /// Energy that modes above the band would take (band_share.hpp), relative as energy_lost_contact, and the
  /// amount by which the restitution would fall. No values if unknown, as with sampled responses or impulses.
  std::optional<double> energy_above_band, rebound_above_band;
  // With friction; no values without it.
  std::optional<double> energy_lost_friction;  ///< heat of friction, relative as energy_lost_contact
  std::optional<double> friction_impulse_ns;  ///< |Σ τ_i Δ| of each pair as a vector, summed over the pairs
  std::optional<double> max_slip_m;           ///< longest path that a pressed point slipped
  std::optional<std::int64_t> ambiguous_steps;  ///< steps whose forces are known not to be the only solution
  std::int64_t limited_steps = 0;               ///< steps that max_pivots cut short
  double limited_residual = 0;  ///< largest ratio of SolveResidual::violation to scale in these steps
  std::map<std::string, int> modes;
  std::map<std::string, std::string> basis;  ///< by body, from kernels::Modes::kind
  int modes_in_residual = 0;             ///< modes above half the rate, which are quasi-static in this run
  Rotation rotation = Rotation::linear;  ///< of free bodies
  /// Whether rotations are linear for want of kernels although a body turns too far; set by the caller.
  bool needs_turning_kernels = false;
  std::map<std::string, Neglected> neglected;  ///< by free body, with finite rotations
  /// With finite rotations: when a second run, with speeds larger by half a per cent and another step, shows
  /// another motion; set by the caller. No value if it does not, or if there is none.
  std::optional<double> separation_s;
  double duration_s = 0;  ///< simulated time, also of a run that ends when bodies have parted
  /// When bodies that touch at the end have parted, in steps beyond the run; set by the caller. No value if
  /// contact ends in the run, or if this is not known.
  std::optional<double> parted_s;
  Precision precision = Precision::float64;  ///< precision of the products of steps
  int candidates = 0;                        ///< number of contact points, m
  int unpaired = 0;
  std::optional<ErrorEstimate> error_estimate;            ///< set by the caller; no value if not estimated
  std::map<std::string, AccelerationPeaks> acceleration;  ///< by receiver; empty with sampled responses
  std::map<std::string, StressPeak> stress;               ///< by body with gauges or stress of its surface
  std::map<std::string, GaugePeaks> gauges;               ///< by gauge
  std::map<std::string, StressEnvelope> stress_envelope;  ///< by body with stress of its surface
  std::map<std::string, Sound> sounds;                    ///< by receiver; set by the caller
  std::optional<Sound> sound;                             ///< for players; set by the caller
  std::vector<std::string> warnings;
  std::string run;              ///< identifier of the run, as in its other files; set by the caller
  double real_time_factor = 0;  ///< ratio of simulated time to time spent in steps
  double wall_s = 0;
};

}  // namespace ricochet::contact
