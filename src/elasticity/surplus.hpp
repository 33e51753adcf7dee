// SPDX-License-Identifier: BSD-2-Clause
// The error of modes on a mesh, estimated on this mesh alone by the hierarchical surplus: what functions of
// the next order see of the residual of a mode.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "src/mesh/mesh.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::elasticity {

/// Returns estimates of the stiffness G that elements of order 2 or more have in excess. In the modes, exact
/// elements have the stiffness diag(λ) − G: its eigenvalues are theirs, and its eigenvectors combine the
/// modes of this mesh to theirs.
///
///   G_mn ≈ 1.5 Σ_a r_amᵀ D_a⁻¹ r_an,   r_an = K(w_a, φ_n) − λ_n M(w_a, φ_n)
///
/// over the nodes a of the elements of the next order, with their shape functions N'_a less the interpolation
/// of these, w_a, and D_a = K(N'_a, N'_a). For modes, whose residual is orthogonal to the functions of the
/// mesh, r_an is K(N'_a, φ_n) − λ_n M(N'_a, φ_n). Of Ritz vectors, it leaves out what another vector on the
/// same mesh could add. Entries are known within groups of up to 256 columns in succession, fewer on large
/// meshes, and are 0 between them.
///
/// The factor is that of compact elements; the error of those that are stretched by 1:3 or more is
/// underestimated. Elements of order 1 give no usable estimate: their error is not small.
///
/// Collective on the ranks of the mesh. Needs a GmshSession.
/// @param shape   (local rows, n), M-orthonormal
/// @param lambda  (n) [rad²/s²], > 0
/// @return (n,n) G [rad²/s²], symmetric, the same on every rank; its diagonal is λ − λ_exact
Eigen::MatrixXd stiffness_errors(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials,
                                 const Eigen::Ref<const Eigen::MatrixXd>& shape,
                                 const Eigen::VectorXd& lambda, const parallel::Progress& progress = {});

}  // namespace ricochet::elasticity
