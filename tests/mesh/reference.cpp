// SPDX-License-Identifier: BSD-2-Clause
// Reference elements compared with closed forms.
#include "src/mesh/reference.hpp"

#include <gmsh.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>

#include "src/mesh/lattice.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace reference_test {

using mesh::Family;

struct Kind {
  Family family;
  const char* name;  ///< name in gmsh
  int dim;
  bool simplex;  ///< polynomials of total degree p; otherwise of degree p along each axis
  int orders;    ///< largest order tested
};
constexpr Kind kinds[] = {{Family::line, "line", 1, false, 4},
                          {Family::triangle, "triangle", 2, true, 4},
                          {Family::quadrangle, "quadrangle", 2, false, 4},
                          {Family::tetrahedron, "tetrahedron", 3, true, 4},
                          {Family::hexahedron, "hexahedron", 3, false, 4},
                          {Family::prism, "prism", 3, false, 4}};

double factorial(int n) { return std::tgamma(n + 1.0); }
double over_line(int a) { return a % 2 == 1 ? 0 : 2.0 / (a + 1); }  // ∫ x^a on [−1, 1]

/// ∫ x^a y^b z^c over the reference domain of gmsh.
double exact_integral(Family family, int a, int b, int c) {
  const double triangle = factorial(a) * factorial(b) / factorial(a + b + 2);
  switch (family) {
    case Family::point:
      return 1;
    case Family::line:
      return over_line(a);
    case Family::triangle:
      return triangle;
    case Family::quadrangle:
      return over_line(a) * over_line(b);
    case Family::tetrahedron:
      return factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
    case Family::hexahedron:
      return over_line(a) * over_line(b) * over_line(c);
    case Family::prism:
      return triangle * over_line(c);
  }
  return NAN;
}

class Reference : public testing::TestWithParam<Kind> {};

TEST_P(Reference, quadrature_integrates_every_monomial_of_its_degree_with_positive_weights) {
  const mesh::GmshSession gmsh;
  const auto [family, name, dim, simplex, orders] = GetParam();
  // 31 and 32 are the degrees that facets of order 10 need.
  for (int degree : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, dim < 3 ? 31 : 14, dim < 3 ? 32 : 22}) {
    const mesh::Quadrature rule = mesh::quadrature_of(family, degree);
    ASSERT_EQ(rule.local.size(), 3 * rule.size());
    for (double w : rule.weight) EXPECT_GT(w, 0);
    for (int a = 0; a <= degree; ++a)
      for (int b = 0; b <= (dim > 1 ? degree - a : 0); ++b)
        for (int c = 0; c <= (dim > 2 ? degree - a - b : 0); ++c) {
          double sum = 0;
          for (std::size_t q = 0; q < rule.size(); ++q)
            sum += rule.weight[q] * std::pow(rule.local[3 * q], a) * std::pow(rule.local[3 * q + 1], b) *
                   std::pow(rule.local[3 * q + 2], c);
          // Round-off of thousands of terms with a sum of at most 8.
          EXPECT_NEAR(sum, exact_integral(family, a, b, c), 2e-13) << degree << ": " << a << b << c;
        }
  }
}

/// Points inside every reference domain and off all symmetry planes.
const std::vector<double> inside = {0.11, 0.23, 0.31, 0.47, 0.05, 0.21, 0.02, 0.61, 0.34, 0.3, 0.3, 0.05};

TEST_P(Reference, shape_functions_reproduce_the_polynomials_of_their_order_and_their_gradients) {
  const mesh::GmshSession gmsh;
  const auto [family, name, dim, simplex, orders] = GetParam();
  for (int p = 1; p <= orders; ++p) {
    const auto element = mesh::reference_element(gmsh::model::mesh::getElementType(name, p));
    EXPECT_EQ(element.family, family);
    EXPECT_EQ(element.order, p);
    EXPECT_EQ(element.dim, dim);
    std::vector<double> local = inside;
    for (std::size_t q = 0; q < local.size() / 3; ++q)
      for (int d = dim; d < 3; ++d) local[3 * q + d] = 0;
    const mesh::Basis basis = mesh::basis_at(element, local);
    ASSERT_EQ(basis.points, 4);
    const auto power = [](double x, int n) { return n < 0 ? 0.0 : std::pow(x, n); };
    for (int a = 0; a <= p; ++a)
      for (int b = 0; b <= (dim > 1 ? p : 0); ++b)
        for (int c = 0; c <= (dim > 2 ? p : 0); ++c) {
          if (simplex && a + b + c > p) continue;
          if (family == Family::prism && a + b > p) continue;
          const std::array<int, 3> n{a, b, c};
          for (int q = 0; q < basis.points; ++q) {
            const double* x = &local[3 * static_cast<std::size_t>(q)];
            double value = 0;
            std::array<double, 3> gradient{}, exact{};
            for (int k = 0; k < element.nodes; ++k) {
              double f = 1;
              for (int d = 0; d < dim; ++d) f *= power(element.node[k * dim + d], n[d]);
              value += f * basis.value[q * element.nodes + k];
              for (int d = 0; d < dim; ++d)
                gradient[d] += f * basis.gradient[(q * element.nodes + k) * 3 + d];
            }
            for (int d = 0; d < dim; ++d) {
              exact[d] = n[d] * power(x[d], n[d] - 1);
              for (int e = 0; e < dim; ++e)
                if (e != d) exact[d] *= power(x[e], n[e]);
            }
            // a = b = c = 0 checks that the functions sum to one and their gradients to
            // zero. The coefficients come from a system with gmsh's functions at up to
            // 125 nodes, which costs two digits.
            EXPECT_NEAR(value, power(x[0], a) * power(x[1], b) * power(x[2], c), 1e-13) << p << a << b << c;
            for (int d = 0; d < dim; ++d) EXPECT_NEAR(gradient[d], exact[d], 2e-12) << p << a << b << c;
          }
        }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Reference, testing::ValuesIn(kinds),
                         [](const auto& it) { return std::string(it.param.name); });

TEST(Faces, close_each_volume_element_and_point_outward) {
  const mesh::GmshSession gmsh;
  for (const auto& [family, name, dim, simplex, orders] : kinds) {
    const auto faces = mesh::outward_faces(family);
    EXPECT_EQ(faces.empty(), dim < 3) << name;
    if (dim < 3) continue;
    const auto element = mesh::reference_element(gmsh::model::mesh::getElementType(name, 1));
    const auto corner = [&](int k) { return Eigen::Map<const Eigen::Vector3d>(&element.node[3 * k]); };
    // Each edge is traversed once in each direction. V = ⅓ ∫ x·n ds over fans of triangles.
    std::map<std::pair<int, int>, int> walked;
    double volume = 0;
    for (const std::vector<int>& face : faces)
      for (std::size_t c = 0; c < face.size(); ++c) {
        const int a = face[c], b = face[(c + 1) % face.size()];
        ++walked[{a, b}];
        volume += corner(face[0]).dot(corner(a).cross(corner(b))) / 6;
      }
    for (const auto& [edge, count] : walked) {
      EXPECT_EQ(count, 1) << name;
      EXPECT_EQ(walked.count({edge.second, edge.first}), 1U) << name;
    }
    EXPECT_NEAR(volume, exact_integral(family, 0, 0, 0), 1e-14) << name;
  }
}

TEST(Lattice, cells_are_equal_parts_of_the_facet_with_its_orientation) {
  const mesh::GmshSession gmsh;
  for (const char* name : {"triangle", "quadrangle"})
    for (int p = 1; p <= 5; ++p) {
      const auto facet = mesh::reference_element(gmsh::model::mesh::getElementType(name, p));
      const mesh::Lattice lattice = mesh::lattice_of(facet);
      EXPECT_EQ(lattice.cells.size(), static_cast<std::size_t>(p * p)) << name << p;
      const std::vector<int> flat = lattice.triangles();
      const double whole = facet.family == Family::triangle ? 0.5 : 4;
      for (std::size_t s = 0; s < flat.size(); s += 3) {
        const auto x = [&](int k, int d) { return facet.node[flat[s + k] * facet.dim + d]; };
        const double measure =
            ((x(1, 0) - x(0, 0)) * (x(2, 1) - x(0, 1)) - (x(2, 0) - x(0, 0)) * (x(1, 1) - x(0, 1))) / 2;
        EXPECT_NEAR(measure, whole * 3 / static_cast<double>(flat.size()), 1e-14) << name << p;
      }
    }
}

TEST(Unsupported, elements_are_refused_by_name) {
  const mesh::GmshSession gmsh;
  const auto complaint = [](int type) -> std::string {
    try {
      mesh::reference_element(type);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(
      complaint(gmsh::model::mesh::getElementType("pyramid", 1)).find("\"Pyramid 5\" are not supported"),
      std::string::npos);
  EXPECT_NE(complaint(gmsh::model::mesh::getElementType("hexahedron", 2, /*serendip=*/true))
                .find("lack the inner nodes of order 2"),
            std::string::npos);
}

}  // namespace reference_test
}  // namespace ricochet
