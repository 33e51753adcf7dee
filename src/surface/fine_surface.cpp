// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/fine_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "src/mesh/lattice.hpp"

namespace ricochet::surface {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using mesh::Block;
using mesh::FacetMesh;

/// Linear or bilinear hats of a cell at the reference point (u, v): triangle on [0,1], quadrangle on [−1,1].
std::array<double, 4> hats(int corners, double u, double v) {
  if (corners == 3) return {1 - u - v, u, v, 0};
  return {(1 - u) * (1 - v) / 4, (1 + u) * (1 - v) / 4, (1 + u) * (1 + v) / 4, (1 - u) * (1 + v) / 4};
}

/// ∂x/∂u × ∂x/∂v of an element. @param gradient  (nodes,3)
template <class Position>
Vector3d surface_vector(int nodes, const double* gradient, const Position& position) {
  Vector3d along_u = Vector3d::Zero(), along_v = along_u;
  for (int a = 0; a < nodes; ++a) {
    const Vector3d& x = position(a);
    along_u += gradient[3 * a] * x;
    along_v += gradient[3 * a + 1] * x;
  }
  return along_u.cross(along_v);
}

/// Hats and shape functions at the quadrature points of one cell.
struct CellValues {
  std::vector<double> local;  ///< (q,3)
  std::vector<std::array<double, 4>> hat;
  mesh::Basis basis;
};

/// Quadrature over facets of one type. The lattice divides the reference facet into p² equal cells, each with
/// its own quadrature points.
struct FacetRule {
  mesh::ReferenceElement reference;
  mesh::Lattice lattice = mesh::lattice_of(reference);
  mesh::Quadrature rule;
  std::vector<CellValues> cells{};
  /// Of a quadrature point of a cell.
  double weight(std::size_t q) const {
    return rule.weight[q] / (static_cast<double>(reference.order) * reference.order);
  }
};

/// @param raise  q: the integrand is hat × function of order p + q × surface measure, of degree
/// 1 + p + q + 2(p − 1)
FacetRule facet_rule(int gmsh_type, int raise = 0) {
  const auto element = mesh::reference_element(gmsh_type);
  FacetRule facets{.reference = element,
                   .rule = mesh::quadrature_of(element.family, 3 * element.order + 1 + raise)};
  const auto& [reference, lattice, rule, cells] = facets;
  for (const auto& cell : lattice.cells) {
    CellValues values;
    for (std::size_t q = 0; q < rule.size(); ++q) {
      values.hat.push_back(hats(lattice.corners, rule.local[3 * q], rule.local[3 * q + 1]));
      std::array<double, 2> at{};
      for (int k = 0; k < lattice.corners; ++k)
        for (int d = 0; d < 2; ++d)
          at[d] += values.hat.back()[k] * reference.node[2 * static_cast<std::size_t>(cell[k]) + d];
      values.local.insert(values.local.end(), {at[0], at[1], 0});
    }
    values.basis = mesh::basis_at(reference, values.local);
    facets.cells.push_back(std::move(values));
  }
  return facets;
}

/// Adds the integrals of the hats of facet e, whose first part is `first`.
/// @param position  of node a of the facet
template <class Position>
void add_integrals(const FacetRule& facets, const Block& block, std::size_t e, std::size_t first,
                   const Position& position, FineSurface& fine) {
  const auto& [reference, lattice, rule, cells] = facets;
  const int n = reference.nodes;
  const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(n)];
  for (std::size_t t = 0; t < cells.size(); ++t)
    for (std::size_t q = 0; q < rule.size(); ++q) {
      const std::size_t row = q * static_cast<std::size_t>(n);
      const double* shape = &cells[t].basis.value[row];
      const Vector3d normal =
          surface_vector(n, &cells[t].basis.gradient[row * 3], position) * facets.weight(q);
      const double measure = normal.norm();
      Vector3d x = Vector3d::Zero();
      for (int a = 0; a < n; ++a) x += shape[a] * position(a);
      for (int k = 0; k < lattice.corners; ++k) {
        const auto corner = static_cast<std::size_t>(lattice.cells[t][static_cast<std::size_t>(k)]);
        const auto vertex = static_cast<std::size_t>(nodes[corner]);
        const double w = cells[t].hat[q][static_cast<std::size_t>(k)];
        fine.area[vertex] += w * measure;
        fine.normal[vertex] += w * normal;
        fine.group[vertex] = block.label[e];
        fine.part[first + corner].area += w * measure;
        fine.part[first + corner].moment += w * measure * x;
        for (int a = 0; a < n; ++a) fine.load[vertex][nodes[a]] += w * measure * shape[a];
      }
    }
}

/// Adds the facets of one block of a surface.
void add_facets(const Block& block, FineSurface& fine) {
  const FacetRule facets = facet_rule(block.gmsh_type);
  const int n = facets.reference.nodes;
  const mesh::Basis at_nodes = mesh::basis_at(facets.reference, mesh::local_nodes(facets.reference));
  const std::vector<int> triangles = facets.lattice.triangles();
  for (std::size_t e = 0; e < block.size(); ++e) {
    const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(n)];
    const auto position = [&](int a) -> const Vector3d& {
      return fine.position[static_cast<std::size_t>(nodes[a])];
    };
    const std::size_t first = fine.part.size();
    for (int a = 0; a < n; ++a)
      fine.part.push_back(
          {.vertex = nodes[a],
           .normal = surface_vector(n, &at_nodes.gradient[static_cast<std::size_t>(a * n) * 3], position)
                         .normalized(),
           .facet = fine.facet.size(),
           .sheet = first + static_cast<std::size_t>(a)});
    fine.facet.push_back({&block, e, first});
    add_integrals(facets, block, e, first, position, fine);
    for (int k : triangles) {
      fine.simplex.push_back(nodes[k]);
      fine.simplex_part.push_back(first + static_cast<std::size_t>(k));
    }
  }
}

/// One side of an edge between vertices `low` < `high`: the parts of one facet at both.
struct Side {
  std::int64_t low, high;
  std::size_t facet, low_part, high_part;
  auto key() const { return std::tie(low, high, facet); }
};

/// Joins the parts of each sheet, and finds the lines.
void find_sheets(FineSurface& fine) {
  const std::size_t n = fine.position.size();
  fine.parts_at.resize(n);
  fine.simplices_at.resize(n);
  fine.lines_at.resize(n);
  for (std::size_t p = 0; p < fine.part.size(); ++p)
    fine.parts_at[static_cast<std::size_t>(fine.part[p].vertex)].push_back(p);
  std::vector<Side> sides;
  for (std::size_t s = 0; s < fine.simplex.size(); s += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t low = fine.simplex_part[s + k], high = fine.simplex_part[s + (k + 1) % 3];
      fine.simplices_at[static_cast<std::size_t>(fine.simplex[s + k])].push_back(s / 3);
      if (fine.part[low].vertex > fine.part[high].vertex) std::swap(low, high);
      sides.push_back({fine.part[low].vertex, fine.part[high].vertex, fine.part[low].facet, low, high});
    }
  std::ranges::sort(sides, [](const Side& a, const Side& b) { return a.key() < b.key(); });
  const auto root = [&](std::size_t p) {
    while (fine.part[p].sheet != p) p = fine.part[p].sheet = fine.part[fine.part[p].sheet].sheet;
    return p;
  };
  const auto join = [&](std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    fine.part[std::max(a, b)].sheet = std::min(a, b);
  };
  for (std::size_t from = 0, end = 0; from < sides.size(); from = end) {
    while (end < sides.size() && sides[end].low == sides[from].low && sides[end].high == sides[from].high)
      ++end;
    const Side &one = sides[from], &other = sides[end - 1];
    if (end - from == 2 && one.facet == other.facet) continue;  // within a facet
    const auto cosine = [&](std::size_t a, std::size_t b) {
      return fine.part[a].normal.dot(fine.part[b].normal);
    };
    if (end - from == 2 && cosine(one.low_part, other.low_part) + cosine(one.high_part, other.high_part) >
                               2 * std::cos(crease_angle)) {
      join(one.low_part, other.low_part);
      join(one.high_part, other.high_part);
      continue;
    }
    fine.lines_at[static_cast<std::size_t>(one.low)].push_back({one.high, one.low_part, one.high_part});
    fine.lines_at[static_cast<std::size_t>(one.high)].push_back({one.low, one.high_part, one.low_part});
  }
  for (std::size_t p = 0; p < fine.part.size(); ++p) fine.part[p].sheet = root(p);
}

}  // namespace

std::size_t FineSurface::sheets(std::int64_t vertex) const {
  const auto& here = parts_at[static_cast<std::size_t>(vertex)];
  return static_cast<std::size_t>(
      std::ranges::count_if(here, [&](std::size_t p) { return part[p].sheet == p; }));
}

bool FineSurface::on_line(std::int64_t vertex) const {
  const auto& lines = lines_at[static_cast<std::size_t>(vertex)];
  if (lines.size() != 2 || sheets(vertex) > 2) return false;
  const Vector3d& x = position[static_cast<std::size_t>(vertex)];
  const auto way = [&](const Line& line) {
    return (position[static_cast<std::size_t>(line.to)] - x).normalized();
  };
  return way(lines[0]).dot(way(lines[1])) < -std::cos(crease_angle);
}

FineSurface fine_surface(const FacetMesh& facets) {
  FineSurface fine;
  const std::size_t n = facets.node.size();
  for (std::size_t i = 0; i < n; ++i)
    fine.position.emplace_back(facets.position[3 * i], facets.position[3 * i + 1],
                               facets.position[3 * i + 2]);
  fine.normal.assign(n, Vector3d::Zero());
  fine.area.assign(n, 0);
  fine.group.assign(n, 0);
  fine.load.resize(n);
  for (const Block& block : facets.blocks) {
    if (block.nodes_per_element > 1) {
      add_facets(block, fine);
      continue;
    }
    fine.corners = 1;
    for (std::size_t e = 0; e < block.size(); ++e) {
      const auto i = static_cast<std::size_t>(block.node[e]);
      fine.normal[i] = Eigen::Map<const Vector3d>(&facets.end_normal[3 * i]);
      fine.area[i] = fine.normal[i].norm();
      fine.load[i][block.node[e]] = fine.area[i];
      fine.group[i] = block.label[e];
      fine.simplex.push_back(block.node[e]);
    }
  }
  if (fine.corners == 3) find_sheets(fine);
  return fine;
}

CurvedFacets::CurvedFacets(const FineSurface& fine) : fine_(fine) {
  for (const FineSurface::Facet& facet : fine.facet) {
    const int type = facet.block->gmsh_type;
    if (!reference_.contains(type)) reference_.emplace(type, mesh::reference_element(type));
  }
}

CurvedFacets::At CurvedFacets::at(const FineSurface::Facet& facet, const Vector2d& local) const {
  const mesh::Basis basis = mesh::basis_at(reference_.at(facet.block->gmsh_type), {local[0], local[1], 0});
  At out{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (std::size_t a = 0; a < static_cast<std::size_t>(basis.nodes); ++a) {
    const Vector3d& x = fine_.position[static_cast<std::size_t>(fine_.part[facet.first_part + a].vertex)];
    out.x += basis.value[a] * x;
    out.along_u += basis.gradient[3 * a] * x;
    out.along_v += basis.gradient[3 * a + 1] * x;
  }
  return out;
}

Vector2d CurvedFacets::local_of(std::size_t part) const {
  const FineSurface::Facet& facet = fine_.facet[fine_.part[part].facet];
  return Vector2d(&reference_.at(facet.block->gmsh_type).node[2 * (part - facet.first_part)]);
}

std::optional<SurfacePoint> CurvedFacets::along(const Vector3d& x, const Vector3d& n,
                                                const std::vector<std::size_t>& simplices) const {
  // The flat simplex that contains x, seen along n, is the start of Newton's method.
  double most = -std::numeric_limits<double>::infinity();
  std::size_t facet = 0;
  Vector2d local;
  for (const std::size_t s : simplices) {
    const auto corner = [&](std::size_t k) -> const Vector3d& {
      return fine_.position[static_cast<std::size_t>(fine_.simplex[3 * s + k])];
    };
    const Vector3d e1 = corner(1) - corner(0), e2 = corner(2) - corner(0), r = x - corner(0);
    const double determinant = n.dot(e1.cross(e2));
    if (!(determinant > 1e-6 * e1.norm() * e2.norm())) continue;
    const double u = n.dot(r.cross(e2)) / determinant, v = n.dot(e1.cross(r)) / determinant;
    const double inside = std::min({u, v, 1 - u - v});
    if (inside <= most) continue;
    most = inside;
    facet = fine_.part[fine_.simplex_part[3 * s]].facet;
    const auto at_corner = [&](std::size_t k) { return local_of(fine_.simplex_part[3 * s + k]); };
    local = (1 - u - v) * at_corner(0) + u * at_corner(1) + v * at_corner(2);
  }
  if (most < -1) return std::nullopt;
  // X(u, v) − x − t n = 0
  constexpr int rounds = 20;
  for (int round = 0; round < rounds; ++round) {
    const At on = at(fine_.facet[facet], local);
    const Vector3d normal = on.along_u.cross(on.along_v), off = x - on.x;
    const double determinant = n.dot(normal);
    if (!(determinant > 1e-3 * normal.norm())) return std::nullopt;
    const Vector2d step(n.dot(off.cross(on.along_v)) / determinant,
                        n.dot(on.along_u.cross(off)) / determinant);
    if (step.norm() < 1e-12) return SurfacePoint{on.x, normal.normalized()};
    local += step;
  }
  return std::nullopt;
}

Vector3d CurvedFacets::on_line(const FineSurface::Line& line, double t) const {
  const Vector2d local = (1 - t) * local_of(line.from_part) + t * local_of(line.to_part);
  return at(fine_.facet[fine_.part[line.from_part].facet], local).x;
}

elasticity::PatchLoad raised_load(const FacetMesh& facets, const std::map<std::int64_t, double>& share,
                                  double area, const Vector3& force) {
  elasticity::PatchLoad out{.force = force, .facet = {}, .share = {}};
  constexpr int highest = 2;
  for (const Block& block : facets.blocks) {
    const FacetRule rule = facet_rule(block.gmsh_type, highest);
    const mesh::ReferenceElement& reference = rule.reference;
    const auto n = static_cast<std::size_t>(reference.nodes);
    std::vector<std::size_t> pressed;
    for (std::size_t e = 0; e < block.size(); ++e)
      if (std::any_of(&block.node[e * n], &block.node[e * n] + n,
                      [&](std::int64_t vertex) { return share.contains(vertex); }))
        pressed.push_back(e);
    std::vector<std::int64_t> corner(static_cast<std::size_t>(reference.corners));
    for (int raise = 1; raise <= highest && !pressed.empty(); ++raise) {
      const auto high = mesh::reference_element(mesh::type_of(reference.family, reference.order + raise));
      const mesh::NodeKeys keys(high);
      std::vector<mesh::Basis> basis;
      for (const CellValues& cell : rule.cells) basis.push_back(mesh::basis_at(high, cell.local));
      for (const std::size_t e : pressed) {
        const std::int64_t* nodes = &block.node[e * n];
        const auto position = [&](int a) -> Vector3d {
          return Eigen::Map<const Vector3d>(&facets.position[3 * static_cast<std::size_t>(nodes[a])]);
        };
        std::vector<double> sums(static_cast<std::size_t>(high.nodes), 0.0);
        for (std::size_t t = 0; t < rule.cells.size(); ++t)
          for (std::size_t q = 0; q < rule.rule.size(); ++q) {
            double w = 0;
            for (int k = 0; k < rule.lattice.corners; ++k)
              if (const auto own = share.find(nodes[rule.lattice.cells[t][static_cast<std::size_t>(k)]]);
                  own != share.end())
                w += own->second * rule.cells[t].hat[q][static_cast<std::size_t>(k)];
            w *= surface_vector(reference.nodes, &rule.cells[t].basis.gradient[q * n * 3], position).norm() *
                 rule.weight(q) / area;
            for (std::size_t a = 0; a < sums.size(); ++a) sums[a] += w * basis[t].value[q * sums.size() + a];
          }
        for (std::size_t k = 0; k < corner.size(); ++k)
          corner[k] = facets.node[static_cast<std::size_t>(nodes[k])];
        for (std::size_t a = 0; a < sums.size(); ++a)
          out.share[static_cast<std::size_t>(raise - 1)][keys.of(static_cast<int>(a), corner.data())] +=
              sums[a];
        if (raise > 1) continue;
        out.facet.push_back(corner);
        std::ranges::sort(out.facet.back());
      }
    }
  }
  return out;
}

}  // namespace ricochet::surface
