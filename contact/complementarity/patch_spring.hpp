// SPDX-License-Identifier: BSD-2-Clause
// The spring of a contact point, which carries the bulge of its patches:
//
//   0 ≤ λ  ⟂  g − u + s(λ) ≥ 0,     s(λ) = b (3 x^(2/3) − 2x),   x = min(1, λ/λ_b),   λ_b = 2b/R_ii
//
// The gap g is the distance at one point of the patch, but the displacement u is a mean over the patch, and
// the patch bulges by b beyond its mean. A contact smaller than the patch follows Hertz's law, an approach
// that grows like λ^(2/3). R_ii λ lacks the part s of it, as if all of the patch were pressed. A contact that
// covers the patch lacks nothing: there s = b, and the gap is that of the mean. With λ_b = 2b/R_ii, s and its
// slope are continuous where the contact has grown to the size of the patch, and neither the modulus nor the
// curvature enters.
//
// R_ii is the residual flexibility of the kernels, without the modes that a step does not sample, so that the
// law does not depend on Δ. It is the flexibility under the patch itself. The modes add the motion of the
// body around it, such as the bending of a plate, by which a patch is not flattened. Where the modes resolve
// the patch, R_ii → 0 and s is too small by their part of the near field.
//
// The spring stores e(λ) = λ s − ∫ s dλ, and s does not decrease, so that λ⁺ (s⁺ − s) ≥ e⁺ − e: backward
// Euler cannot gain energy.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>

namespace ricochet::contact {

struct PatchSpring {
  double bulge = 0;  ///< b [m]; 0: no spring
  double limit = 0;  ///< λ_b > 0, the force beyond which s = b [N]

  /// @param flexibility  R_ii > 0 [m/N]
  static PatchSpring of(double bulge, double flexibility) { return {bulge, 2 * bulge / flexibility}; }

  /// s(λ) for λ ≥ 0 [m].
  double displacement(double force) const noexcept {
    if (!(force < limit)) return bulge;
    const double x = force / limit, root = std::cbrt(x);
    return bulge * (3 * root * root - 2 * x);
  }
  /// s'(λ) for λ > 0 [m/N].
  double slope(double force) const noexcept {
    return force < limit ? 2 * bulge / limit * (1 / std::cbrt(force / limit) - 1) : 0;
  }
  /// e(λ) = b λ_b (6/5 x^(5/3) − x²) [J].
  double energy(double force) const noexcept {
    const double x = force < limit ? force / limit : 1, root = std::cbrt(x);
    return bulge * limit * x * (1.2 * root * root - x);
  }
  void archive(auto& a) { a(bulge, limit); }
};

/// u −= s(λ). @param springs  of the first rows
template <class Forces, class Displacements>
void yield(std::span<const PatchSpring> springs, const Forces& force, Displacements& u) noexcept {
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (springs[k].bulge > 0 && force(i) > 0) u(i) -= springs[k].displacement(force(i));
  }
}

/// Σ e(λ) [J].
template <class Forces>
double energy_of(std::span<const PatchSpring> springs, const Forces& force) noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < springs.size(); ++k)
    if (const double f = force(static_cast<Eigen::Index>(k)); springs[k].bulge > 0 && f > 0)
      sum += springs[k].energy(f);
  return sum;
}

/// What the springs do in a step [J].
struct SpringWork {
  double stored = 0;   ///< Σ e⁺
  double removed = 0;  ///< Σ λ̄ (s⁺ − s) − (e⁺ − e)
};
/// @param start, end, mean  λ, λ⁺ and λ̄
template <class Start, class End, class Mean>
SpringWork work_of(std::span<const PatchSpring> springs, const Start& start, const End& end,
                   const Mean& mean) noexcept {
  SpringWork out;
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const PatchSpring& spring = springs[k];
    const auto i = static_cast<Eigen::Index>(k);
    if (!(spring.bulge > 0) || (start(i) == 0 && end(i) == 0)) continue;
    const double e = spring.energy(end(i));
    out.stored += e;
    out.removed +=
        mean(i) * (spring.displacement(end(i)) - spring.displacement(start(i))) - e + spring.energy(start(i));
  }
  return out;
}

}  // namespace ricochet::contact
