// SPDX-License-Identifier: BSD-2-Clause
// What a set of modes, or of Ritz vectors, is worth to contact in a band of frequencies.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Modes as contact sees them: H(s) = Σ B_n B_nᵀ / (λ_n + s²).
struct BandModes {
  std::span<const double> lambda;  ///< (N) ω² [rad²/s²], positive
  std::span<const double> trace;   ///< (N,c): of mode n the component n·c + i at place i [kg^-1/2]
};

/// Largest relative difference, in the Frobenius norm, of the flexibilities H(s) of two sets of modes, over
/// s = ω e^{iπ/4} with 0 < ω ≤ band: there a response dies away within one period, as that to a force that
/// contact is about to change does, and resonances that no impact lasts long enough to feel don't count.
///
/// @param quasi_static  the coarse set is given the static flexibility of the fine one
/// @return ‖H_coarse − H_fine‖ / ‖H_fine‖; 0 when the fine one has no modes
double flexibility_error(const BandModes& coarse, const BandModes& fine, RadPerSecond band,
                         bool quasi_static);

/// What modes are worth when those left out stay in the residual flexibility.
class Contributions {
 public:
  /// Keeps no reference to `modes`.
  Contributions(const BandModes& modes, RadPerSecond band);

  /// The modes by what they contribute to H over the band beyond their static part, least first. @return (N)
  const std::vector<std::size_t>& ascending() const { return ascending_; }

  /// `flexibility_error` of leaving out some of them. @param left_out  (N)
  double error_without(const std::vector<bool>& left_out) const;

  /// Bound on the error that modes above `end` make whose static flexibility has the Frobenius norm
  /// `flexibility` [m/N] and is all that stands for them: |1/(λ + s²) − 1/λ| = |s²/(λ + s²)|/λ, largest at
  /// the end, and terms B_n B_nᵀ have no angle above 90° with each other.
  double error_above(RadPerSecond end, double flexibility) const;

  /// How many of `order`, from its first on, can be left out with at most this error. @param order  (≤ N)
  std::size_t dispensable(const std::vector<std::size_t>& order, double error) const;

 private:
  std::size_t count_;
  RadPerSecond band_;
  std::vector<double> gram_;  ///< (N,N) of the traces
  std::vector<std::vector<std::complex<double>>>
      moving_;                ///< per sample, (N): weights less their static parts
  std::vector<double> norm_;  ///< per sample, of H
  std::vector<std::size_t> ascending_;
};

/// Takes the modes that are not to be kept out of a kernel and adds what they give statically to its residual
/// flexibility and response to gravity, where it has these. @param keep  (N); rigid modes have to be kept
void leave_out(Kernel& kernel, const std::vector<bool>& keep);

/// The kernel without its elastic modes, or vectors, above `end`, by `leave_out`; unlike a cut it need not
/// have had all modes below, and its certificate stays as it was.
Kernel up_to(Kernel kernel, RadPerSecond end);

/// `flexibility_error` of `up_to`, where the static part of what goes stays.
double error_up_to(const Kernel& kernel, RadPerSecond end, RadPerSecond band);

/// `Contributions::error_above` of a kernel whose residual flexibility stands for modes above `end`.
double error_above(const Kernel& kernel, RadPerSecond band, RadPerSecond end);

/// Leaves out the elastic modes that contribute least to the flexibility of the contact surface over
/// [0, band], as many as keep its error within `error`, and adds their static parts to the residual
/// flexibility, which the kernel must have. Returns the error made.
double keep_contributing(Kernel& kernel, RadPerSecond band, double error);

}  // namespace ricochet::kernels
