// SPDX-License-Identifier: BSD-2-Clause
// Derives kernels from other kernels without computing modes: rescaled to a similar body, truncated, or
// restricted to fewer candidates.
//
// A body of another stiffness, density and size but the same shape and Poisson's ratio has the same modes, in
// other units. With the factors e of Young's modulus, d of density and s of length, its stiffness is
// multiplied by k and its mass by m:
//
//   k = e s,  m = d s³      a solid
//   k = e a/s,  m = d a s   a rod whose cross-section is multiplied by a
//
//   ω   √(k/m)              φ   m^-1/2            φᵀM e_i        m^1/2
//   R   1/k                 A   s², of a rod a    φᵀM (e_i × x)  m^1/2 s
//   static correction under unit acceleration: m/k
//
// Truncation keeps static responses exact: each truncated mode adds its static part B_n B_nᵀ/ω_n² to the
// residual flexibility, if the kernel has one. The caller must set `hash` and `scene`.
//
// InputErrors begin with `kernel of "body"`.
#pragma once

#include <optional>
#include <vector>

#include "kernels/damping.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// The ratios of one body to another of the same shape, whose elastic laws are proportional. All factors are
/// positive.
struct Similarity {
  double young = 1, density = 1;  ///< of stiffness and density, common to all its materials
  double scale = 1;               ///< of length
  std::optional<double> area{};   ///< of the cross-section; rods only
};

/// Factor of frequencies, √(k/m).
double frequency_factor(const Similarity& factors);

/// Returns the kernel of a similar body with the given law of damping.
Kernel rescaled(Kernel kernel, const Similarity& factors, const Damping& damping);

/// Modes whose ω² have a relative difference below this form one multiple mode. Truncation to a number of
/// modes never splits it.
inline constexpr double multiple_mode = 1e-6;

/// Keeps the modes up to `band`, for which the certificate then holds. Throws InputError if the kernel may
/// lack some of them: `band` exceeds the end of its certificate, modes were truncated before, or its vectors
/// are not modes.
Kernel truncated_to_band(Kernel kernel, Hertz band);

/// Keeps the lowest `count` modes, rigid ones included; rigid modes and multiple modes are kept whole. Throws
/// InputError like truncated_to_band, and if there are fewer modes.
Kernel truncated_to_count(Kernel kernel, std::int64_t count);

/// Keeps the candidates with these indices, in this order. A surface element is kept if all its corners are
/// kept. If no element remains, each point becomes an element with one corner. The record of the whole
/// surface is dropped. Throws InputError if an index is not a candidate or occurs twice, or if `points` is
/// empty.
Kernel restricted_to_points(Kernel kernel, const std::vector<std::int64_t>& points);

/// Restricts only the geometry, `node` to `element`, and drops `whole`. `points` are indices of candidates,
/// each at most once.
void restrict_candidates(Surface& surface, const std::vector<std::int64_t>& points);

/// Keeps only the component along this unit vector. Throws InputError if the kernel has only one component.
Kernel restricted_to_direction(Kernel kernel, const Vector3& direction);

/// Keeps static corrections only along the normal of each candidate, as (M,M), (M,3) and so on. Throws
/// InputError if the kernel has no residual flexibility in three components.
Kernel restricted_to_normals(Kernel kernel);

/// Keeps the residual flexibility in single precision, and compresses that of many candidates, as the steps
/// of bodies that turn need it (kernels/compression.hpp). A kernel without residual flexibility in three
/// components, or with a compact one, stays as it is.
Kernel compacted(Kernel kernel);

/// Keeps the modes that contact needs. The modes that contribute least over [0, band] are truncated and
/// represented by the residual flexibility. Their number is the largest that keeps the error of the
/// flexibility of the contact surface within `error` (above 0). The possible contribution of the modes above
/// the certificate's end is bounded by their static part and counts towards the error. The certificate
/// records the error and the number of truncated modes. Throws InputError like truncated_to_band, if the
/// kernel has no residual flexibility, or if the modes above the end alone may exceed the error.
Kernel truncated_to_flexibility_error(Kernel kernel, Hertz band, double error);

}  // namespace ricochet::kernels
