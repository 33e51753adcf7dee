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
/// kept such that every other point has neighbours in it, where most faces meet first: corners, then creases.
/// Each other point is distributed among these neighbours by linear hats, c_Ii ≥ 0 with Σ_I c_Ii = 1. The
/// wider patch is
///
///   w_I = Σ_i c_Ii w_i,   A_I = Σ_i c_Ii A_i,   u_I = Σ_i T_Ii u_i  with  T_Ii = c_Ii A_i/A_I
///
/// B of elastic modes, R and static displacements follow with T, so only the choice of patches differs. Gaps,
/// points, normals and B of rigid modes are means over those parts alone whose gap is that of the point that
/// was kept: all of a face that lies flat, so that its pressure has the same moment, and points along the
/// edge of a tilted one. The mean of both sides of an edge would lie inside the body. On a curved surface,
/// normals of wide patches may be slightly shorter than 1. Pairs with one point do not change.
///
/// A linear function plus ½ κ |d|² is fitted to the gaps of the parts, at distances d from the point that was
/// kept. The bulge is
///
///   b_I = Σ_i T_Ii (b_i + max(0, κ) |d_i|²/2)
///
/// so that on a smooth surface g_I + b_I is the mean gap of the parts, and the edge of a flat face, where
/// gaps are linear on either side, has no bulge. In models without bulges, it is added to the gap.
Model coarsened(const Model& model);

/// Returns the model coarsened `times` times.
Model coarsened(Model model, int times);

}  // namespace ricochet::contact
