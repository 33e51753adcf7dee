// SPDX-License-Identifier: BSD-2-Clause
// Gradients of the displacement at points of a body, recovered from the nodes around them (polynomial
// preserving recovery).
//
//   ∂u/∂x_l (x) = Σ_v λ_v(x) ∂P_v/∂x_l (x),   P_v: the polynomial with least Σ_a w_a |P_v(x_a) − u(x_a)|²
//
// v are the corners of the element that contains x, and λ_v their linear shape functions. a are the nodes of
// the elements of order p and of the same material around v, with weights that fall with the distance from v.
// P_v has the degree p + 2, without monomials that the nodes hardly determine. The result is linear in the
// displacement of the nodes and continuous within a material. It is exact for displacements of degree p + 1
// on any mesh, so its order is p + 1 at least, one more than that of the gradient itself.
// Source: Zhang & Naga 2005; blended over the corners, so that an edge has the mean of both its ends there;
// weighted as in moving least squares, Lancaster & Salkauskas 1981.
#pragma once

#include <cstdint>
#include <vector>

#include "src/surface/locate.hpp"

namespace ricochet::surface {

/// The share of one node in the gradient at a point: ∂u_k/∂x_l = Σ weight_l u_k(node).
struct GradientShare {
  std::int64_t point = 0;  ///< index into the points
  std::int64_t node = 0;   ///< global
  Vector3 weight{};        ///< [1/m]
};

/// Recovers the gradient at points that have been located on the mesh, which must have elements. A patch with
/// too few nodes, or with nodes that do not determine degree p + 1, takes the next elements, up to three
/// times, unless they determine no more monomials. Monomials that are not determined then are left out, and
/// with too few nodes those of degree p + 2, so that a mesh of one element has a gradient.
/// Needs a GmshSession. Collective.
/// @return shares of the nodes that this rank owns, by point and then by node
std::vector<GradientShare> recover_gradients(const mesh::Mesh& mesh, const std::vector<Located>& points);

}  // namespace ricochet::surface
