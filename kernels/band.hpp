// SPDX-License-Identifier: BSD-2-Clause
// Contributions of modes or Ritz vectors to the flexibility of the contact surface over a band.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Modes restricted to the contact surface: H(s) = Σ B_n B_nᵀ / (λ_n + s²).
struct BandModes {
  std::span<const double> lambda;  ///< (N) ω² [rad²/s²], positive
  std::span<const double> trace;   ///< (N,c): mode n at point i is entry n·c + i [kg^-1/2]
};

/// Largest relative difference between the flexibilities H(s) of two sets of modes, in the Frobenius norm, on
/// the ray s = ω e^{iπ/4} with 0 < ω ≤ band. On this ray, a response decays within one period, like the
/// response to a contact force that changes; resonances that no impact lasts long enough to excite do not
/// count.
///
/// @param quasi_static  whether the coarse set gets the static flexibility of the fine one
/// @return ‖H_coarse − H_fine‖ / ‖H_fine‖; 0 if the fine set has no modes
double flexibility_error(const BandModes& coarse, const BandModes& fine, RadPerSecond band,
                         bool quasi_static);

/// Part of the modes of elements that are modes of the body: the upper half of those of a rod belong to the
/// elements, whatever their order.
constexpr double resolved_part = 0.5;

/// Number of the modes of a kernel that its elements resolve.
std::size_t resolved_modes(const Kernel& kernel);

/// The contribution of each mode beyond its static part, which the residual flexibility keeps if the mode is
/// truncated.
class Contributions {
 public:
  /// Keeps no reference to `modes`.
  Contributions(const BandModes& modes, RadPerSecond band);

  /// Indices of the modes, ordered by their contribution to H over the band beyond their static part,
  /// smallest first. @return (N)
  const std::vector<std::size_t>& ascending() const { return ascending_; }

  /// `flexibility_error` of truncating some of the modes. @param truncated  (N)
  double error_without(const std::vector<bool>& truncated) const;

  /// Bound on the error due to modes above `end` that are represented only by a static flexibility with the
  /// Frobenius norm `flexibility` [m/N]. The factor |1/(λ + s²) − 1/λ| = |s²/(λ + s²)|/λ is largest at `end`,
  /// and the terms B_n B_nᵀ have no negative inner products.
  double error_above(RadPerSecond end, double flexibility) const;

  /// Number of leading entries of `order` that can be truncated with at most this error. @param order  (≤ N)
  std::size_t dispensable(const std::vector<std::size_t>& order, double error) const;

 private:
  std::size_t count_;
  RadPerSecond band_;
  std::vector<double> gram_;  ///< (N,N) of the traces
  std::vector<std::vector<std::complex<double>>>
      moving_;                ///< per sample, (N): weights minus their static parts
  std::vector<double> norm_;  ///< per sample, norm of H
  std::vector<std::size_t> ascending_;
};

/// The modes on the components of the candidates that the static correction covers. (rM,N) [kg^-1/2]
std::vector<double> residual_trace(const Kernel& kernel);

/// Truncates the modes that are not kept and adds their static parts to the residual flexibility and to the
/// response to gravity, if the kernel has these. @param keep  (N); rigid modes must be kept
void truncate(Kernel& kernel, const std::vector<bool>& keep);

/// Truncates the elastic modes, or vectors, above `end`. In contrast to truncated_to_band, the kernel need
/// not contain all modes below `end`, and its certificate does not change.
Kernel truncated_above(Kernel kernel, RadPerSecond end);

/// `flexibility_error` of truncated_above if the static part of the truncated modes is kept.
double truncation_error(const Kernel& kernel, RadPerSecond end, RadPerSecond band);

/// `Contributions::error_above` of a kernel whose residual flexibility represents the modes above `end`.
double error_above(const Kernel& kernel, RadPerSecond band, RadPerSecond end);

/// Truncates the elastic modes that contribute least to the flexibility of the contact surface over [0,
/// band], as many as keep its error within `error`, and adds their static parts to the residual flexibility,
/// which the kernel must have. Returns the resulting error.
double truncate_least_contributing(Kernel& kernel, RadPerSecond band, double error);

}  // namespace ricochet::kernels
