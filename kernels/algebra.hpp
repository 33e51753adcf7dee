// SPDX-License-Identifier: BSD-2-Clause
// Kernels from kernels, without computing modes: of similar bodies, and cut to less.
//
// A body of another stiffness, density and size but the same form and Poisson's ratio moves in the same
// modes, in other units. With the factors e of Young's modulus, d of density and s of length, its stiffness
// grows by k and its mass by m:
//
//   k = e s,  m = d s³      a solid
//   k = e a/s,  m = d a s   a rod, the cross-section of which has a factor a of its own
//
//   ω   √(k/m)              φ   m^-1/2            φᵀM e_i        m^1/2
//   R   1/k                 A   s², of a rod a    φᵀM (e_i × x)  m^1/2 s
//   displacement of what was left out, under unit acceleration: m/k
//
// Cuts are exact too: modes that leave give their static part B_n B_nᵀ/ω_n² to the residual flexibility,
// where there is one, so static responses stay as they were. `hash` and `scene` are the caller's to set.
//
// InputErrors begin with `kernel of "body"`.
#pragma once

#include <optional>
#include <vector>

#include "kernels/damping.hpp"
#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// How one body compares with another of the same form and Poisson's ratio. All factors are positive.
struct Similarity {
  double young = 1, density = 1;  ///< common to all its materials
  double scale = 1;               ///< of length
  std::optional<double> area{};   ///< of the cross-section; rods alone have it
};

/// Factor of frequencies, √(k/m).
double frequency_factor(const Similarity& factors);

/// The kernel of a similar body with the law of damping given.
Kernel rescaled(Kernel kernel, const Similarity& factors, const Damping& damping);

/// Modes this close in ω², relatively, are one multiple mode, which a number of modes never splits.
inline constexpr double multiple_mode = 1e-6;

/// The modes up to `band`; the certificate then proves these. Throws InputError when the kernel does not have
/// them all: `band` lies above what its certificate proves, modes were left out, or its vectors are no modes.
Kernel cut_to_band(Kernel kernel, Hertz band);

/// The lowest `count` modes, rigid ones included; these all stay, and so does a multiple mode. Throws
/// InputError like cut_to_band, and when there are fewer.
Kernel cut_to_count(Kernel kernel, std::int64_t count);

/// The candidate points of these indices, in this order. Surface elements stay where all their corners do;
/// when none does, the points stand alone (one corner each). What they were cut from is forgotten. Throws
/// InputError when an index is not one of the candidates, comes twice, or there is none.
Kernel cut_to_points(Kernel kernel, const std::vector<std::int64_t>& points);

/// The same of the geometry alone: node to element, and no `whole`. `points` are indices of candidates, each
/// at most once.
void keep_candidates(Surface& surface, const std::vector<std::int64_t>& points);

/// Of a kernel with three components the one along this unit vector. Throws InputError when it has one
/// already.
Kernel cut_to_direction(Kernel kernel, const Vector3& direction);

/// The modes that contact needs: of a kernel that has them all up to its certificate's end, those that
/// contribute least over [0, band] are left to the residual flexibility, as many as keep the error of the
/// flexibility of the contact surface within `error` (above 0). What the modes above the end may add is
/// bounded by their static part and counts. The certificate holds the error and how many were left out.
/// Throws InputError like cut_to_band; without residual flexibility; and when the modes above the end alone
/// may make that error.
Kernel cut_to_flexibility_error(Kernel kernel, Hertz band, double error);

}  // namespace ricochet::kernels
