// SPDX-License-Identifier: BSD-2-Clause
// Fewer contact points in place of those of a model, as kernels with a wider spacing would have them.
#pragma once

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// The model with its points at about twice their distance. A subset of each pair's points stays such that
/// every other point has some of them for neighbours and is distributed among these by linear hats, c_Ii ≥ 0,
/// Σ_I c_Ii = 1. The wider patch is
///
///   w_I = Σ_i c_Ii w_i,   A_I = Σ_i c_Ii A_i,   u_I = Σ_i T_Ii u_i  with  T_Ii = c_Ii A_i/A_I
///
/// so that B, R, gaps and static displacements follow with T: nothing but the choice of patches differs. The
/// normals of wide patches of a curved surface are means, a little shorter than 1. Pairs of one point stay.
Model coarsened(const Model& model);

/// The model coarsened `times` times.
Model coarsened(Model model, int times);

}  // namespace ricochet::contact
