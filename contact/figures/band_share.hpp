// SPDX-License-Identifier: BSD-2-Clause
// The energy that modes above the band would take, from one run.
#pragma once

#include <optional>
#include <vector>

#include "contact/motion/turning.hpp"

namespace ricochet::contact {

/// A mode above the band with the participation b = Σ_i w_i B_i of the pattern w of the force keeps, after
/// the impact, the energy ½ b² |F(ω)|², with the spectrum F(ω) = ∫ F e^(−iωt) dt of the recorded force. Of
/// these modes, the density n and the mean of b² are known from the top of the band, so that
///
///   E = Σ ½ ⟨b²⟩ ∫_{ω_c}^{π/Δ} n(ω) |F(ω)|² dω      over bodies and their pairs
///
/// with the end ω_c of the certified band and steps Δ. The number of modes up to ω, N (ω/ω_c)^p, is that of
/// the two top octaves of the band: p = 1 for rods, and up to 3 for solids. Patterns narrower than the
/// shortest wave have a constant ⟨b²⟩; for wider ones it falls, and E is an upper bound.
///
/// No force falls more slowly than that of a wave front, |F|² ∝ 1/ω². Where ripple, caused by the end of the
/// band, makes the recorded force fall more slowly, |F|² follows from the top octave by this law.
///
/// F is sampled at frequencies that are spread evenly over the logarithm and off the period of a touch, which
/// leaves an error of about a tenth. This takes constant memory and the time of about four modes in each step
/// with a force.
class BandShare {
 public:
  /// `model` must outlive the share.
  BandShare(const Model& model, double step);

  /// Call it after each step with a force, in the order of time.
  /// @param time  end of the step [s]. @param force  (n) λ̄, of which the first m are normal ones [N]
  /// @param turning  of the stepper; null unless bodies turn
  void observe(double time, const Vector& force, const Turning* turning = nullptr);

  /// E [J]. No value if a pressed body has no elastic mode in its band, so that nothing is known of those
  /// above, or if steps do not sample frequencies above a band.
  std::optional<double> energy() const;

 private:
  /// Figures of the top of a band, which represent the modes above.
  struct Band {
    double end = 0;          ///< ω_c [rad/s]; 0: no elastic mode
    double modes = 0;        ///< N
    double power = 1;        ///< p
    std::vector<int> top{};  ///< modes of the top octave, as columns of B
  };
  static Band band_of(const Model& model, const Bodies::Block& body);
  double mode_under_impulse(int body, int mode, std::size_t pair) const;
  std::optional<double> energy(int body, std::size_t pair) const;

  const Model& model_;
  double step_, time_ = 0;
  std::vector<Band> bands_;                ///< by body
  Eigen::ArrayXd low_, high_;              ///< ln of the bounds of each sample's interval
  Eigen::ArrayXd omega_;                   ///< sampled frequencies [rad/s]
  Eigen::ArrayXcd phase_, turn_;           ///< e^(−iωt) at time_, and its change over a step
  std::vector<Eigen::ArrayXcd> of_force_;  ///< Σ F Δ e^(−iωt) by pair
  Vector impulse_;                         ///< (m) Σ λ̄ Δ
  std::vector<Vector> on_candidates_;      ///< by body (3M), if bodies turn: Σ of forces · Δ, in its axes
};

}  // namespace ricochet::contact
