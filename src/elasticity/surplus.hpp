// SPDX-License-Identifier: BSD-2-Clause
// The error of eigenvalues on a mesh, estimated on this mesh alone by the hierarchical surplus: what
// functions of the next order see of the residual of a mode.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "src/mesh/mesh.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::elasticity {

/// Returns estimates of λ − λ_exact > 0 on elements of order 2 or more.
///
///   λ − λ_exact ≈ 1.5 Σ_a r_aᵀ D_a⁻¹ r_a,   r_a = K(w_a, φ) − λ M(w_a, φ)
///
/// over the nodes a of the elements of the next order, with their shape functions N'_a less the interpolation
/// of these, w_a, and D_a = K(N'_a, N'_a). For modes, whose residual is orthogonal to the functions of the
/// mesh, r_a is K(N'_a, φ) − λ M(N'_a, φ). Of Ritz vectors, it leaves out what another vector on the same
/// mesh could add.
///
/// The factor is that of compact elements; the error of those that are stretched by 1:3 or more is
/// underestimated. Elements of order 1 give no usable estimate: their error is not small.
///
/// Collective on the ranks of the mesh. Needs a GmshSession.
/// @param shape   (local rows, n), M-orthonormal
/// @param lambda  (n) [rad²/s²], > 0
/// @return (n) [rad²/s²], the same on every rank
Eigen::VectorXd eigenvalue_errors(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials,
                                  const Eigen::Ref<const Eigen::MatrixXd>& shape,
                                  const Eigen::VectorXd& lambda, const parallel::Progress& progress = {});

}  // namespace ricochet::elasticity
