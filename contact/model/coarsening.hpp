// SPDX-License-Identifier: BSD-2-Clause
// Replaces the contact points of a model by fewer ones, as kernels with a wider spacing would have them.
#pragma once

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Distance up to which the neighbours of point i lie, 1.4 times that of the second nearest one [m]; infinite
/// without another point.
/// @param at  (m,3), @param first, count  the points that may be neighbours
double reach_of_neighbours(const Matrix& at, Eigen::Index i, Eigen::Index first, Eigen::Index count);

/// Returns the model with its points at about twice their distance. A subset of the points of each pair is
/// kept such that every other point has neighbours in it. Each other point is distributed among these
/// neighbours by linear hats, c_Ii ≥ 0 with Σ_I c_Ii = 1. The wider patch is
///
///   w_I = Σ_i c_Ii w_i,   A_I = Σ_i c_Ii A_i,   u_I = Σ_i T_Ii u_i  with  T_Ii = c_Ii A_i/A_I
///
/// B, R, static displacements and, without bulges, gaps follow with T, so only the choice of patches differs.
/// On a curved surface, the normals of wide patches are means and slightly shorter than 1. Pairs with one
/// point do not change.
///
/// In models with bulges, the gap of a wide patch is that of the point that was kept, g_I. A linear function
/// plus ½ κ |d|² is fitted to the gaps of its parts, at distances d from that point. The bulge is
///
///   b_I = Σ_i T_Ii (b_i + max(0, κ) |d_i|²/2)
///
/// so that on a smooth surface g_I + b_I is the mean gap of the parts, and the edge of a flat face, where
/// gaps are linear on either side, has no bulge.
Model coarsened(const Model& model);

/// Returns the model coarsened `times` times.
Model coarsened(Model model, int times);

}  // namespace ricochet::contact
