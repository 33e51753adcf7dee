// SPDX-License-Identifier: BSD-2-Clause
// The contact surface, subdivided to the element order: hats on its vertices, its smooth sheets and its
// creases.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "kernels/crease_angle.hpp"
#include "src/elasticity/local_problem.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::surface {

using kernels::crease_angle;

/// Hats on every vertex of the subdivided surface, before merging.
///
/// A facet has a part for each of its nodes: the share of the node's hat on this facet. Around each vertex,
/// the facets whose normals differ by less than the crease angle across their common edge form a sheet.
/// Lines are creases and the ends of the surface.
struct FineSurface {
  struct Part {
    std::int64_t vertex = 0;
    Eigen::Vector3d normal;                            ///< of the facet at the vertex, unit
    double area = 0;                                   ///< ∫ w ds [m²]
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< ∫ w x ds [m³]
    std::size_t facet = 0;                             ///< index into `facet`
    std::size_t sheet = 0;                             ///< a part of the same sheet, which identifies it
  };
  struct Facet {
    const mesh::Block* block = nullptr;
    std::size_t element = 0;     ///< in the block
    std::size_t first_part = 0;  ///< parts are in the order of the element's nodes
  };
  struct Line {  ///< a piece of a line from a vertex to a neighbour
    std::int64_t to = 0;
    std::size_t from_part = 0, to_part = 0;  ///< of one facet at both ends
  };

  std::vector<Eigen::Vector3d> position, normal;  ///< normal: ∫ w n ds
  std::vector<double> area;
  std::vector<std::int64_t> group;
  std::vector<std::map<std::int64_t, double>> load;  ///< per vertex: node index → ∫ w N ds
  std::vector<std::int64_t> simplex;                 ///< flat list of vertices
  int corners = 3;
  // Empty for points (corners = 1):
  std::vector<Part> part;
  std::vector<Facet> facet;
  std::vector<std::size_t> simplex_part;               ///< part of each entry of `simplex`
  std::vector<std::vector<std::size_t>> parts_at;      ///< per vertex
  std::vector<std::vector<std::size_t>> simplices_at;  ///< per vertex
  std::vector<std::vector<Line>> lines_at;             ///< per vertex

  /// Number of sheets around a vertex.
  std::size_t sheets(std::int64_t vertex) const;
  /// Whether a vertex lies on a line that passes through it smoothly, rather than at a corner or the end of a
  /// crease.
  bool on_line(std::int64_t vertex) const;
};

/// A force that is spread over a surface like (Σ share_v w_v)/A with the hats w_v, as functions of higher
/// orders see it. Needs a GmshSession.
/// @param share  by vertex, as in FineSurface, @param area  A [m²], @param force  [N]
elasticity::PatchLoad raised_load(const mesh::FacetMesh& facets, const std::map<std::int64_t, double>& share,
                                  double area, const Vector3& force);

/// Needs a GmshSession.
FineSurface fine_surface(const mesh::FacetMesh& facets);

/// A point of the curved surface and its unit normal there.
struct SurfacePoint {
  Eigen::Vector3d point, normal;
};

/// Positions on the elements of a surface. Needs a GmshSession.
class CurvedFacets {
 public:
  explicit CurvedFacets(const FineSurface& fine);

  /// Returns the intersection of the line x + t n with the elements of these simplices, near the one that is
  /// seen along n around x; no value if Newton's method fails.
  std::optional<SurfacePoint> along(const Eigen::Vector3d& x, const Eigen::Vector3d& n,
                                    const std::vector<std::size_t>& simplices) const;

  /// Returns the point of a line between its ends, at the share t of its parameter.
  Eigen::Vector3d on_line(const FineSurface::Line& line, double t) const;

 private:
  struct At {
    Eigen::Vector3d x, along_u, along_v;
  };
  At at(const FineSurface::Facet& facet, const Eigen::Vector2d& local) const;
  Eigen::Vector2d local_of(std::size_t part) const;

  const FineSurface& fine_;
  std::map<int, mesh::ReferenceElement> reference_;
};

}  // namespace ricochet::surface
