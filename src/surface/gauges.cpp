// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/gauges.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "ricochet/kernel.hpp"
#include "src/elasticity/element.hpp"
#include "src/surface/recovery.hpp"

namespace ricochet::surface {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Largest distance of a place of a gauge from a curved surface, as a share of its length.
constexpr double most_off = 0.05;

/// Gauss points of a length from −½ to ½, and their weights.
const std::array<std::pair<double, double>, 3> along_length{
    {{-std::sqrt(0.15), 5.0 / 18}, {0, 8.0 / 18}, {std::sqrt(0.15), 5.0 / 18}}};

/// Rows of a stress; a strain has one more.
constexpr auto stress_rows = static_cast<Index>(kernels::stress_rows);

/// A point at which the gradient is recovered.
struct Point {
  Index first;                  ///< row of its gauge
  bool stress = true;           ///< whether the stress is taken here
  double strain = 0;            ///< share of this point in the strain
  Vector3d direction{0, 0, 0};  ///< of the strain
};

/// What one share of a node gives: (rows of the gauge, components of the mesh).
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

/// @param weight  of the node in the gradient
/// @param C  null if the material is isotropic
Rows stress_of(const mesh::Mesh& mesh, const scene::Material& material, const elasticity::Matrix6* C,
               const Vector3d& weight) {
  if (C != nullptr) return *C * elasticity::strain_of(weight);
  Rows out = Rows::Zero(stress_rows, mesh.components());
  const Vector3d axis(mesh.axis.data());
  const double mu = material.young / (2 * (1 + material.poisson)),
               lambda = 2 * mu * material.poisson / (1 - 2 * material.poisson);
  for (Index row = 0; row < stress_rows; ++row) {
    const auto [i, j] = elasticity::stress_order[static_cast<std::size_t>(row)];
    if (mesh.dim != 3) {
      out(row, 0) = material.young * axis[i] * axis[j] * axis.dot(weight);
      continue;
    }
    if (i == j) out.row(row) = lambda * weight.transpose();
    out(row, i) += mu * weight[j];
    out(row, j) += mu * weight[i];
  }
  return out;
}

Rows strain_of(const mesh::Mesh& mesh, const scene::Material& material, const Vector3d& weight,
               const Vector3d& direction) {
  if (mesh.dim == 3) return direction.dot(weight) * direction.transpose();
  const Vector3d axis(mesh.axis.data());
  const double share = std::pow(axis.dot(direction), 2);  // a rod contracts sideways
  return Rows::Constant(1, 1, (share - material.poisson * (1 - share)) * axis.dot(weight));
}

/// The points of all gauges and their places. Collective.
std::pair<std::vector<Point>, std::vector<Located>> points_of(const mesh::Mesh& mesh,
                                                              const scene::KernelRequest& request,
                                                              const std::vector<Located>& places) {
  std::vector<Point> points;
  std::vector<Located> at;
  Index first = 0;
  for (std::size_t g = 0; g < places.size(); ++g) {
    const scene::Gauge& gauge = request.gauges[g];
    const Vector3d direction = gauge.direction ? Vector3d(gauge.direction->data()) : Vector3d::Zero();
    points.push_back({first, true, gauge.direction && !(gauge.length > 0) ? 1.0 : 0.0, direction});
    at.push_back(places[g]);
    for (const auto& [along, share] : along_length) {
      if (!(gauge.length > 0)) break;
      Vector3 place = places[g].place;
      for (std::size_t c = 0; c < 3; ++c) place[c] += along * gauge.length * (*gauge.direction)[c];
      const Located found = locate(mesh, place);
      if (found.distance > most_off * gauge.length)
        throw InputError(
            fmt::format("{}: output.gauge \"{}\": its length leaves bodies.{} by {:.4g} m, more than 5 % of "
                        "its length of {:g} "
                        "m: shorten it, or turn its direction",
                        request.body.mesh.filename().string(), gauge.name, request.body.name, found.distance,
                        gauge.length));
      points.push_back({first, false, share, direction});
      at.push_back(found);
    }
    first += stress_rows + (gauge.direction ? 1 : 0);
  }
  return {points, at};
}

/// The materials of a body, and their laws at places.
class Materials {
 public:
  Materials(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials)
      : mesh_(mesh), materials_(materials), laws_(elasticity::materials_of(materials, mesh.dim)) {}

  const scene::Material& at(const Located& place) const {
    return materials_[static_cast<std::size_t>(place.label)];
  }
  /// The stress at a place by each gradient: column lc + k is that of ∂u_k/∂x_l. (6, 3 components)
  Rows stress(const Located& place) const {
    std::optional<elasticity::Matrix6> C;
    if (const elasticity::Law* const law = laws_[static_cast<std::size_t>(place.label)].law.get())
      C = law->at(Vector3d(place.place.data()));
    const Index c = mesh_.components();
    Rows out(stress_rows, 3 * c);
    for (Index l = 0; l < 3; ++l)
      out.middleCols(l * c, c) = stress_of(mesh_, at(place), C ? &*C : nullptr, Vector3d::Unit(l));
    return out;
  }

 private:
  const mesh::Mesh& mesh_;
  const std::vector<scene::Material>& materials_;
  std::vector<elasticity::Material> laws_;
};

/// The shares that this rank owns, by point.
struct OwnShare {
  std::size_t point;
  std::size_t local;  ///< among the nodes of this rank
  Index own;          ///< among those that it owns
  Vector3d weight;
};

/// Collective.
std::vector<OwnShare> own_shares(const mesh::Mesh& mesh, const std::vector<Located>& places) {
  std::vector<OwnShare> out;
  for (const GradientShare& share : recover_gradients(mesh, places))
    if (const std::int64_t own = mesh.owned(share.node); own >= 0)
      out.push_back(
          {static_cast<std::size_t>(share.point),
           static_cast<std::size_t>(std::ranges::lower_bound(mesh.node, share.node) - mesh.node.begin()), own,
           Vector3d(share.weight.data())});
  return out;
}

}  // namespace

reduction::GradientRows surface_stress(const mesh::Mesh& mesh,
                                       const std::vector<scene::Material>& materials) {
  std::vector<std::int64_t> nodes = mesh.visualisation.node;
  parallel::broadcast(mesh.comm, nodes);
  const std::vector<Located> places = at_nodes(mesh, nodes);
  const Materials of(mesh, materials);
  reduction::GradientRows out;
  for (const OwnShare& share : own_shares(mesh, places)) {
    if (out.point.empty() || out.point.back() != share.point) {
      out.point.push_back(share.point);
      out.start.push_back(out.start.back());
    }
    ++out.start.back();
    out.node.push_back(static_cast<int>(share.own));
    out.weight.insert(out.weight.end(), share.weight.begin(), share.weight.end());
  }
  const Index width = 3 * mesh.components();
  out.law.resize(stress_rows, width * std::ssize(out.point));
  for (std::size_t p = 0; p < out.point.size(); ++p)
    out.law.middleCols(width * static_cast<Index>(p), width) = of.stress(places[out.point[p]]);
  return out;
}

GaugeColumns gauge_columns(const mesh::Mesh& mesh, const scene::KernelRequest& request,
                           const std::vector<Located>& places) {
  Index count = 0;
  for (const scene::Gauge& gauge : request.gauges) count += stress_rows + (gauge.direction ? 1 : 0);
  const int c = mesh.components();
  GaugeColumns out{{mesh.owned_nodes * c, count}, {mesh.owned_nodes * c, count}, {}};
  if (count == 0) return out;
  if (mesh.total_elements == 0)
    throw InputError(
        fmt::format("{}: output.gauge \"{}\": bodies.{} has no elements, from which stresses follow: give it "
                    "a mesh, or leave "
                    "the gauge out",
                    request.body.mesh.filename().string(), request.gauges.front().name, request.body.name));
  const auto [points, at] = points_of(mesh, request, places);
  const Materials of(mesh, request.body.materials);
  std::vector<Eigen::Triplet<double>> all, held;
  Rows law;  // at the last point; shares are ordered by point
  std::size_t last = points.size();
  for (const OwnShare& share : own_shares(mesh, at)) {
    const Point& point = points[share.point];
    if (std::exchange(last, share.point) != share.point) law = of.stress(at[share.point]);
    const auto add = [&](const Rows& rows, Index first) {
      for (Index k = 0; k < rows.rows(); ++k)
        for (int d = 0; d < c; ++d)
          (mesh.is_fixed(share.local, d) ? held : all)
              .emplace_back(static_cast<int>(share.own * c + d), static_cast<int>(first + k), rows(k, d));
    };
    if (point.stress)
      add(share.weight[0] * law.leftCols(c) + share.weight[1] * law.middleCols(c, c) +
              share.weight[2] * law.rightCols(c),
          point.first);
    if (point.strain > 0)
      add(point.strain * strain_of(mesh, of.at(at[share.point]), share.weight, point.direction),
          point.first + stress_rows);
  }
  out.free.setFromTriplets(all.begin(), all.end());
  all.insert(all.end(), held.begin(), held.end());
  out.filled.setFromTriplets(all.begin(), all.end());
  // Columns of length 1, like those of receivers, so that neither dominates the round-off of the other.
  out.unit = Eigen::VectorXd::Zero(count);
  for (Index k = 0; k < count; ++k) out.unit[k] = out.filled.col(k).squaredNorm();
  parallel::sum(mesh.comm, out.unit);
  out.unit = (out.unit.array() > 0).select(out.unit.cwiseSqrt(), 1.0);
  const Eigen::VectorXd scale = out.unit.cwiseInverse();
  out.free = (out.free * scale.asDiagonal()).eval();
  out.filled = (out.filled * scale.asDiagonal()).eval();
  return out;
}

}  // namespace ricochet::surface
