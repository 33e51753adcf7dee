// SPDX-License-Identifier: BSD-2-Clause
// Static correction: the quasi-static response of the modes that a mode set does not contain.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Selected local rows of a field on the mesh.
struct Rows {
  std::vector<Eigen::Index> row;
  Eigen::MatrixXd value;  ///< (rows, columns of the field)
};

/// Computes the quasi-static response to loads of the modes outside the set, Cᵀ Pᵀ (K − σM)⁻¹ P L, corrected
/// to σ = 0. C are the first `seen` columns of L, the loads at the output points.
///
/// @param loads  L (local rows, b) [N], held components 0, the same in every team
/// @param field  if given, receives its rows of the response Pᵀ (K − σM)⁻¹ P L, corrected to σ = 0 with an
/// error of 1e-6, which is enough for pictures
/// @return (seen, b) [m/N for unit loads], the same on every rank. Collective on all ranks of `teams`.
/// Source: MacNeal 1971, Rubin 1975. The series Σ (−σ)^k Cᵀ X_k, up to relative terms of 1e-12, removes the
/// shift.
Eigen::MatrixXd residual_response(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                  const elasticity::Body& body, Factorisation& factor, const ModeSet& modes,
                                  const Eigen::MatrixXd& loads, Eigen::Index seen, Rows* field = nullptr);

}  // namespace ricochet::modes
