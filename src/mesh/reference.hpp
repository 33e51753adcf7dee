// SPDX-License-Identifier: BSD-2-Clause
// Reference elements, from gmsh's own shape functions and quadrature.
#pragma once

#include <vector>

namespace ricochet::mesh {

enum class Family { point, line, triangle, quadrangle, tetrahedron, hexahedron, prism };

/// A Lagrange element of one gmsh type. Needs a GmshSession.
struct ReferenceElement {
  int gmsh_type = 0;
  Family family = Family::point;
  int dim = 0, order = 0, nodes = 0, corners = 0;
  std::vector<double> node;  ///< (nodes,dim) local coordinates
};

/// Throws InputError unless the type is a point, line, triangle, quadrangle, tetrahedron, hexahedron or prism
/// with all its Lagrange nodes (pyramids and serendipity elements are refused) for which gmsh has shape
/// functions.
ReferenceElement reference_element(int gmsh_type);

/// The type of gmsh with all Lagrange nodes of an order.
int type_of(Family family, int order);

/// Corners of each face of a volume element, in the order that points outward; empty for other families.
std::vector<std::vector<int>> outward_faces(Family family);

/// Shape functions at given points.
struct Basis {
  int points = 0, nodes = 0;
  std::vector<double> value;     ///< (points,nodes)
  std::vector<double> gradient;  ///< (points,nodes,3), in local coordinates
};
/// @param local  (points,3) local coordinates
Basis basis_at(const ReferenceElement& element, const std::vector<double>& local);

struct Quadrature {
  std::vector<double> local;   ///< (points,3)
  std::vector<double> weight;  ///< (points)
  std::size_t size() const { return weight.size(); }
};
/// Gauss rule with positive weights, exact for polynomials of `degree` on gmsh's reference domain of the
/// family.
Quadrature quadrature_of(Family family, int degree);

}  // namespace ricochet::mesh
