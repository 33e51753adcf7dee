// SPDX-License-Identifier: BSD-2-Clause
// Sampled responses of the contact points, for sources that are not modal: closed forms, measurements, other
// solvers. docs/formats/responses.md defines the file format and the meaning of a sample.
//
//   u_k = ũ_k − Σ_l N_l P_{k−l}     impulses P at the instants t_k = kΔ
//   u_k = ũ_k − Σ_l S_l λ_{k−l}     forces λ, each constant over the step that ends at t_k
//
// L samples, K instants of the free motion ũ, m points. All arrays are row-major, in SI units, with the signs
// of model.hpp.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "contact/pairing/types.hpp"
#include "contact/table/convolution.hpp"

namespace ricochet::contact {

/// A body without supports. Its mass-mean motion follows from the contact forces.
struct FreeBody {
  std::string name;
  double mass = 0;                                     ///< [kg]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< initial, mass-mean [m/s]
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();   ///< [m/s²]
  Matrix push;  ///< (m,3) force on the body of λ_i = 1: −n_i on side a, n_i on side b, 0 elsewhere
};

struct Table {
  double step = 0;                   ///< Δ [s]
  std::vector<double> displacement;  ///< (L,m,m) N_l = N(lΔ⁻) [m/(N s)]; N_0 = 0
  /// (L,m,m) Ṅ_l = Ṅ(lΔ⁺) [1/kg]; where N itself jumps, the mean rate (N_{l+1} − N_l)/Δ of the step after lΔ.
  std::vector<double> velocity;
  /// (L,m,m) S_l = ∫ N dt from lΔ to (l+1)Δ [m/N], with the instantaneous flexibility added to S_0. If empty,
  /// Δ (N_l + N_{l+1})/2 is used, a quadrature of second order.
  std::vector<double> flexibility;
  /// (m,m) R, the instantaneous part of S_0 [m/N]; empty if S_0 has none. Conserving steps need it.
  std::vector<double> residual;
  Tail tail = Tail::none;             ///< continuation of N, Ṅ and S beyond the samples
  std::vector<double> free;           ///< (K,m) ũ_k [m]; if empty, the rigid motion of `bodies`
  std::vector<double> free_velocity;  ///< (K,m) [m/s]; if empty, (ũ_{k+1} − ũ_k)/Δ
  Vector gap;                         ///< (m) [m]
  Vector area;                        ///< (m) [m²]; empty if unknown
  std::vector<FreeBody> bodies;

  int points() const { return static_cast<int>(gap.size()); }
  std::int64_t samples() const;   ///< L
  std::int64_t instants() const;  ///< K; 0 for rigid motion, which has no end
};

/// Advice at the end of messages about a table.
inline constexpr const char* table_advice = "docs/formats/responses.md describes the format.";

/// Throws an InputError that names `origin` if shapes disagree, a value is not finite, N_0 is not 0, points
/// overlap at the start, a mass is not positive, or a response with a linear tail does not end in a straight
/// line.
void validate(const Table& table, const std::string& origin);

}  // namespace ricochet::contact
