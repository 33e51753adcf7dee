// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/reference.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

/// A family and its name in gmsh.
struct Kind {
  Family family;
  const char* name;
  int dim, corners;
};
constexpr Kind kinds[] = {{Family::point, "point", 0, 1},
                          {Family::line, "line", 1, 2},
                          {Family::triangle, "triangle", 2, 3},
                          {Family::quadrangle, "quadrangle", 2, 4},
                          {Family::tetrahedron, "tetrahedron", 3, 4},
                          {Family::hexahedron, "hexahedron", 3, 8},
                          {Family::prism, "prism", 3, 6}};

/// Whether the shape functions are computed as products. gmsh 4.8 creates prisms of order above 2, but has no
/// shape functions and no node table for them.
bool is_product(const ReferenceElement& element) {
  return element.family == Family::prism && element.order > 2;
}

/// Returns the order if the type is a prism without a node table in gmsh, otherwise 0.
int product_order(int gmsh_type) {
  for (int order = 3; order <= 9; ++order)
    if (type_of(Family::prism, order) == gmsh_type) return order;
  return 0;
}

/// Returns such a prism. To obtain its nodes, gmsh raises the order of the reference prism.
ReferenceElement product_prism(int gmsh_type, int order) {
  std::string model;
  gmsh::model::getCurrent(model);
  gmsh::model::add("reference prism");
  const int volume = gmsh::model::addDiscreteEntity(3);
  gmsh::model::mesh::addNodes(3, volume, {1, 2, 3, 4, 5, 6},
                              {0, 0, -1, 1, 0, -1, 0, 1, -1, 0, 0, 1, 1, 0, 1, 0, 1, 1});
  gmsh::model::mesh::addElementsByType(volume, type_of(Family::prism, 1), {1}, {1, 2, 3, 4, 5, 6});
  gmsh::model::mesh::setOrder(order);
  std::vector<std::size_t> nodes;
  std::vector<double> at, parametric;
  gmsh::model::mesh::getNodesByElementType(gmsh_type, nodes, at, parametric, -1, false);
  const ReferenceElement element{gmsh_type, Family::prism, 3, order, static_cast<int>(nodes.size()), 6, at};
  gmsh::model::remove();
  gmsh::model::setCurrent(model);
  return element;
}

}  // namespace

int type_of(Family family, int order) {
  return gmsh::model::mesh::getElementType(std::ranges::find(kinds, family, &Kind::family)->name, order);
}

ReferenceElement reference_element(int gmsh_type) {
  if (const int order = product_order(gmsh_type); order > 0) return product_prism(gmsh_type, order);
  ReferenceElement element;
  element.gmsh_type = gmsh_type;
  std::string name;
  try {
    gmsh::model::mesh::getElementProperties(gmsh_type, name, element.dim, element.order, element.nodes,
                                            element.node, element.corners);
  } catch (const std::string& message) {
    throw InputError(fmt::format(
        "gmsh cannot compute with these elements ({}): lower the order, or mesh with tetrahedra or hexahedra",
        message));
  }
  const auto kind = std::ranges::find_if(kinds, [&](const Kind& candidate) {
    return candidate.dim == element.dim && candidate.corners == element.corners;
  });
  if (kind == std::end(kinds))
    throw InputError(fmt::format(
        "elements of type \"{}\" are not supported: mesh with tetrahedra, hexahedra, prisms or lines", name));
  element.family = kind->family;
  if (gmsh_type != type_of(element.family, element.order))
    throw InputError(fmt::format(
        "elements of type \"{}\" lack the inner nodes of order {}: set Mesh.SecondOrderIncomplete = 0 "
        "in gmsh and mesh again",
        name, element.order));
  return element;
}

std::vector<double> local_nodes(const ReferenceElement& element) {
  std::vector<double> local(3 * static_cast<std::size_t>(element.nodes), 0.0);
  for (int n = 0; n < element.nodes; ++n)
    for (int d = 0; d < element.dim; ++d) local[3 * n + d] = element.node[n * element.dim + d];
  return local;
}

std::vector<std::vector<int>> outward_faces(Family family) {
  switch (family) {
    case Family::tetrahedron:
      return {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}};
    case Family::hexahedron:
      return {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};
    case Family::prism:
      return {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}};
    default:
      return {};
  }
}

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Evaluates the Lagrange functions of a gmsh type at `local` (points,3).
Basis gmsh_functions(int type, const std::vector<double>& local) {
  Basis basis;
  basis.points = static_cast<int>(local.size() / 3);
  int components = 0, orientations = 0;
  gmsh::model::mesh::getBasisFunctions(type, local, "Lagrange", components, basis.value, orientations);
  gmsh::model::mesh::getBasisFunctions(type, local, "GradLagrange", components, basis.gradient, orientations);
  basis.nodes = basis.points > 0 ? static_cast<int>(basis.value.size()) / basis.points : 0;
  return basis;
}

/// Evaluates the shape functions of a prism: products of functions on its triangle (u, v) and along its axis
/// (w).
Basis product_functions(const ReferenceElement& element, const std::vector<double>& local) {
  const ReferenceElement triangle = reference_element(type_of(Family::triangle, element.order)),
                         line = reference_element(type_of(Family::line, element.order));
  std::vector<double> across = local, along = local;
  for (std::size_t q = 0; q < local.size(); q += 3) {
    across[q + 2] = 0;
    along[q] = local[q + 2];
    along[q + 1] = along[q + 2] = 0;
  }
  const Basis in_plane = gmsh_functions(triangle.gmsh_type, across),
              in_depth = gmsh_functions(line.gmsh_type, along);
  Basis basis;
  basis.points = in_plane.points;
  basis.nodes = element.nodes;
  const auto n = static_cast<std::size_t>(element.nodes), points = static_cast<std::size_t>(basis.points);
  basis.value.resize(points * n);
  basis.gradient.resize(points * n * 3);
  const auto nearest = [&](const ReferenceElement& part, const double* at) {
    std::size_t best = 0;
    double least = 1e300;
    for (std::size_t k = 0; k < static_cast<std::size_t>(part.nodes); ++k) {
      double distance = 0;
      for (std::size_t d = 0; d < static_cast<std::size_t>(part.dim); ++d)
        distance += std::abs(part.node[k * static_cast<std::size_t>(part.dim) + d] - at[d]);
      if (distance < least) {
        least = distance;
        best = k;
      }
    }
    return best;
  };
  for (std::size_t a = 0; a < n; ++a) {
    const std::size_t t = nearest(triangle, &element.node[3 * a]),
                      l = nearest(line, &element.node[3 * a + 2]);
    for (std::size_t q = 0; q < points; ++q) {
      const std::size_t in = q * static_cast<std::size_t>(triangle.nodes) + t,
                        up = q * static_cast<std::size_t>(line.nodes) + l, out = q * n + a;
      basis.value[out] = in_plane.value[in] * in_depth.value[up];
      basis.gradient[3 * out] = in_plane.gradient[3 * in] * in_depth.value[up];
      basis.gradient[3 * out + 1] = in_plane.gradient[3 * in + 1] * in_depth.value[up];
      basis.gradient[3 * out + 2] = in_plane.value[in] * in_depth.gradient[3 * up];
    }
  }
  return basis;
}

Basis functions_of(const ReferenceElement& element, const std::vector<double>& local) {
  return is_product(element) ? product_functions(element, local) : gmsh_functions(element.gmsh_type, local);
}

/// Returns the shape functions at the nodes of the element: the identity, except for round-off in gmsh, which
/// reaches 4e-12 for hexahedra of order 4.
RowMajor at_own_nodes(const ReferenceElement& element) {
  return Eigen::Map<const RowMajor>(functions_of(element, local_nodes(element)).value.data(), element.nodes,
                                    element.nodes);
}

/// Returns Gauss points and weights on [0, 1], exact to `degree`, computed by Newton's method on the Legendre
/// polynomial P_n. The line rules of gmsh do not suffice: it crashes beyond degree 31, and facets of order 10
/// need 32.
std::vector<std::array<double, 2>> unit_line(int degree) {
  const int n = degree / 2 + 1;
  std::vector<std::array<double, 2>> rule;
  for (int k = 0; k < n; ++k) {
    double x = -std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5)), slope = 1, step = 1;
    for (int i = 0; i < 50 && std::abs(step) > 1e-16; ++i) {
      double before = 1, value = x;
      for (int j = 2; j <= n; ++j)
        before = std::exchange(value, ((2 * j - 1) * x * value - (j - 1) * before) / j);
      slope = n * (x * value - before) / (x * x - 1);
      x -= step = value / slope;
    }
    rule.push_back({(x + 1) / 2, 1 / ((1 - x * x) * slope * slope)});
  }
  return rule;
}

}  // namespace

Basis basis_at(const ReferenceElement& element, const std::vector<double>& local) {
  Basis basis = functions_of(element, local);
  if (element.nodes == 1) return basis;
  // N V⁻¹ are the exact Lagrange functions of the same space, where N are the functions of gmsh and V their
  // values at the nodes, which take longer than N at one point.
  thread_local std::map<int, Eigen::PartialPivLU<RowMajor>> corrections;
  auto known = corrections.find(element.gmsh_type);
  if (known == corrections.end())
    known = corrections.emplace(element.gmsh_type, at_own_nodes(element).transpose()).first;
  const Eigen::PartialPivLU<RowMajor>& correction = known->second;
  Eigen::Map<RowMajor> value(basis.value.data(), basis.points, basis.nodes);
  value = correction.solve(value.transpose()).transpose().eval();
  for (int q = 0; q < basis.points; ++q) {
    Eigen::Map<RowMajor> gradient(basis.gradient.data() + static_cast<std::ptrdiff_t>(q) * basis.nodes * 3,
                                  basis.nodes, 3);
    gradient = correction.solve(gradient).eval();
  }
  return basis;
}

Quadrature quadrature_of(Family family, int degree) {
  // gmsh tabulates its rules for simplices with only 12 digits. Products of line rules have full precision.
  // For a simplex they are collapsed, and each collapse raises the degree by one.
  const auto line = unit_line(degree), collapsed = unit_line(degree + 1), twice = unit_line(degree + 2);
  Quadrature rule;
  const auto add = [&](double u, double v, double w, double weight) {
    rule.local.insert(rule.local.end(), {u, v, w});
    rule.weight.push_back(weight);
  };
  switch (family) {
    case Family::point:
      add(0, 0, 0, 1);
      break;
    case Family::line:
      for (auto [x, a] : line) add(2 * x - 1, 0, 0, 2 * a);
      break;
    case Family::triangle:
      for (auto [x, a] : collapsed)
        for (auto [y, b] : line) add(x, y * (1 - x), 0, a * b * (1 - x));
      break;
    case Family::quadrangle:
      for (auto [x, a] : line)
        for (auto [y, b] : line) add(2 * x - 1, 2 * y - 1, 0, 4 * a * b);
      break;
    case Family::tetrahedron:
      for (auto [x, a] : twice)
        for (auto [y, b] : collapsed)
          for (auto [z, c] : line) {
            const double v = y * (1 - x), w = z * (1 - x) * (1 - y);
            add(x, v, w, a * b * c * (1 - x) * (1 - x) * (1 - y));
          }
      break;
    case Family::hexahedron:
      for (auto [x, a] : line)
        for (auto [y, b] : line)
          for (auto [z, c] : line) add(2 * x - 1, 2 * y - 1, 2 * z - 1, 8 * a * b * c);
      break;
    case Family::prism:
      for (auto [x, a] : collapsed)
        for (auto [y, b] : line)
          for (auto [z, c] : line) add(x, y * (1 - x), 2 * z - 1, 2 * a * b * c * (1 - x));
      break;
  }
  return rule;
}

}  // namespace ricochet::mesh
