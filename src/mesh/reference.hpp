// SPDX-License-Identifier: BSD-2-Clause
// Reference elements with the shape functions of gmsh, and quadrature rules on them.
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

/// Returns the element of a gmsh type. Throws InputError unless it is a point, line, triangle, quadrangle,
/// tetrahedron, hexahedron or prism with all its Lagrange nodes, and its shape functions can be computed.
/// Pyramids and serendipity elements are refused.
ReferenceElement reference_element(int gmsh_type);

/// Returns the gmsh type of the complete Lagrange element of this order.
int type_of(Family family, int order);

/// Returns the corners of each face of a volume element, ordered such that the normal points outward; empty
/// for other families.
std::vector<std::vector<int>> outward_faces(Family family);

/// Local coordinates of the nodes of an element, three for each. (nodes,3)
std::vector<double> local_nodes(const ReferenceElement& element);

/// Shape functions at given points.
struct Basis {
  int points = 0, nodes = 0;
  std::vector<double> value;     ///< (points,nodes)
  std::vector<double> gradient;  ///< (points,nodes,3), in local coordinates
};
/// Evaluates the shape functions of an element.
/// @param local  (points,3) local coordinates
Basis basis_at(const ReferenceElement& element, const std::vector<double>& local);

struct Quadrature {
  std::vector<double> local;   ///< (points,3)
  std::vector<double> weight;  ///< (points)
  std::size_t size() const { return weight.size(); }
};
/// Returns a Gauss rule with positive weights, exact for polynomials of `degree`, on the reference domain of
/// the family in gmsh.
Quadrature quadrature_of(Family family, int degree);

}  // namespace ricochet::mesh
