// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/gauges.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
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

/// Of an isotropic material.
Rows stress_of(const mesh::Mesh& mesh, const scene::Material& material, const Vector3d& weight) {
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

using Entries = std::vector<Eigen::Triplet<double>>;

/// Calls put(entry, fixed) for each entry of the columns of the points. Collective.
template <class Put>
void for_each_entry(const mesh::Mesh& mesh, const std::vector<scene::Material>& materials,
                    const std::vector<Point>& points, const std::vector<Located>& at, Put&& put) {
  const int c = mesh.components();
  const std::vector<elasticity::Material> laws = elasticity::materials_of(materials, mesh.dim);
  elasticity::Matrix6 C;  // at the last point; shares are ordered by point
  std::int64_t last = -1;
  for (const GradientShare& share : recover_gradients(mesh, at)) {
    const Index row = mesh.owned(share.node);
    if (row < 0) continue;
    const auto local = static_cast<std::size_t>(
        std::lower_bound(mesh.node.begin(), mesh.node.end(), share.node) - mesh.node.begin());
    const Point& point = points[static_cast<std::size_t>(share.point)];
    const Located& place = at[static_cast<std::size_t>(share.point)];
    const auto label = static_cast<std::size_t>(place.label);
    const scene::Material& material = materials[label];
    const elasticity::Law* const law = laws[label].law.get();
    if (law != nullptr && std::exchange(last, share.point) != share.point)
      C = law->at(Vector3d(place.place.data()));
    const Vector3d weight(share.weight.data());
    const auto add = [&](const Rows& rows, Index first) {
      for (Index k = 0; k < rows.rows(); ++k)
        for (int d = 0; d < c; ++d)
          put(Eigen::Triplet<double>(static_cast<int>(row * c + d), static_cast<int>(first + k), rows(k, d)),
              mesh.is_fixed(local, d));
    };
    if (point.stress)
      add(law != nullptr ? Rows(C * elasticity::strain_of(weight)) : stress_of(mesh, material, weight),
          point.first);
    if (point.strain > 0)
      add(point.strain * strain_of(mesh, material, weight, point.direction), point.first + stress_rows);
  }
}

}  // namespace

Eigen::SparseMatrix<double> stress_columns(const mesh::Mesh& mesh,
                                           const std::vector<scene::Material>& materials,
                                           const std::vector<Located>& places) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < places.size(); ++i) points.push_back({static_cast<Index>(i) * stress_rows});
  Entries entries;
  for_each_entry(mesh, materials, points, places,
                 [&](const Eigen::Triplet<double>& entry, bool) { entries.push_back(entry); });
  Eigen::SparseMatrix<double> out(mesh.owned_nodes * mesh.components(), std::ssize(places) * stress_rows);
  out.setFromTriplets(entries.begin(), entries.end());
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
  Entries all, held;
  for_each_entry(
      mesh, request.body.materials, points, at,
      [&](const Eigen::Triplet<double>& entry, bool fixed) { (fixed ? held : all).push_back(entry); });
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
