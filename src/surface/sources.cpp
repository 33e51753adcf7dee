// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "src/mesh/faces.hpp"
#include "src/reduction/static_flexibility.hpp"
#include "src/surface/gauges.hpp"
#include "src/surface/locate.hpp"

namespace ricochet::surface {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<double> rows_of(const Matrix3d& matrix) {
  const Matrix3d columns = matrix.transpose();
  return {columns.data(), columns.data() + columns.size()};
}

/// Returns a load with its resultants. `total` is the sum of its weights by component, and column k of
/// `first` is the sum of those of component k times positions. A rod moves only along its axis.
kernels::Load load_of(const mesh::Mesh& mesh, const std::string& name, const char* unit,
                      const Vector3d& total, const Matrix3d& first) {
  const Vector3d axis(mesh.axis.data());
  const Matrix3d moved = mesh.dim == 3 ? Matrix3d(Matrix3d::Identity()) : Matrix3d(axis * axis.transpose());
  Matrix3d moment;
  for (int k = 0; k < 3; ++k) moment.col(k) = Vector3d(first.col(k)).cross(Vector3d(moved.col(k)));
  return {name, unit, {}, rows_of(moved * total.asDiagonal()), rows_of(moment), {}};
}

/// ∫ w ds and ∫ w x_k ds over a surface, for the weights w of a traction (1) or of a pressure (−n_k).
struct Integral {
  Vector3d total = Vector3d::Zero();
  Matrix3d first = Matrix3d::Zero();          ///< column k: of w_k x
  std::map<std::int64_t, Vector3d> weight{};  ///< by global node: ∫ N w ds

  void add(std::int64_t node, const Vector3d& position, const Vector3d& weights) {
    total += weights;
    first += position * weights.transpose();
    weight.try_emplace(node, Vector3d::Zero()).first->second += weights;
  }
};

/// Integrals over one surface.
struct Surface {
  Integral traction, pressure;
};

/// Integrates over the surfaces of RequestedGroups::loaded, by label.
std::vector<Surface> integrate(const mesh::FacetMesh& facets, std::size_t surfaces) {
  std::vector<Surface> sums(surfaces);
  const auto position = [&](std::int64_t node) {
    return Vector3d(&facets.position[3 * static_cast<std::size_t>(node)]);
  };
  const auto add = [&](std::int64_t label, std::int64_t node, double weight, const Vector3d& normal) {
    Surface& sum = sums[static_cast<std::size_t>(label)];
    const std::int64_t global = facets.node[static_cast<std::size_t>(node)];
    sum.traction.add(global, position(node), Vector3d::Constant(weight));
    sum.pressure.add(global, position(node), -weight * normal);
  };
  for (const mesh::Block& block : facets.blocks) {
    const auto n = static_cast<std::size_t>(block.nodes_per_element);
    if (n == 1) {  // the end of a rod
      for (std::size_t e = 0; e < block.size(); ++e) {
        const auto i = static_cast<std::size_t>(block.node[e]);
        const Vector3d end(&facets.end_normal[3 * i]);
        add(block.label[e], block.node[e], end.norm(), end.normalized());
      }
      continue;
    }
    const auto reference = mesh::reference_element(block.gmsh_type);
    // The integrand is shape function × measure. The measure of a curved facet is not a polynomial, which
    // requires a higher degree.
    const auto rule = mesh::quadrature_of(reference.family, 3 * reference.order + 1);
    const auto basis = mesh::basis_at(reference, rule.local);
    for (std::size_t e = 0; e < block.size(); ++e) {
      const std::int64_t* nodes = &block.node[e * n];
      for (std::size_t q = 0; q < rule.size(); ++q) {
        Vector3d along_u = Vector3d::Zero(), along_v = along_u;
        for (std::size_t a = 0; a < n; ++a) {
          along_u += basis.gradient[3 * (q * n + a)] * position(nodes[a]);
          along_v += basis.gradient[3 * (q * n + a) + 1] * position(nodes[a]);
        }
        const Vector3d normal = along_u.cross(along_v);
        const double measure = normal.norm() * rule.weight[q];
        for (std::size_t a = 0; a < n; ++a)
          add(block.label[e], nodes[a], measure * basis.value[q * n + a], normal.normalized());
      }
    }
  }
  return sums;
}

/// Returns the index of `name` in `list`. Appends it if it is missing.
std::size_t place_of(std::vector<std::string>& list, const std::string& name) {
  const auto found = std::find(list.begin(), list.end(), name);
  if (found == list.end()) list.push_back(name);
  return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin());
}

/// A point as a scene gives it. Its digits suffice to lie within `tolerance` of the point.
std::string digits(const Vector3& point, double tolerance) {
  const double unit = std::pow(10.0, std::floor(std::log10(tolerance)) - 1);
  std::string text;
  for (const double x : point) {
    const double rounded = std::round(x / unit) * unit;
    text += fmt::format("{}{:.15g}", text.empty() ? "" : ", ", std::abs(rounded) < unit / 2 ? 0 : rounded);
  }
  return '[' + text + ']';
}

/// Locates a load, a receiver or a gauge of `request` under `key` of the scene. Throws InputError if it is
/// not on the body. Collective.
template <class S>
Located on_body(const mesh::Mesh& mesh, const scene::Body& body, const char* key, const S& source,
                double tolerance) {
  const Located found = locate(mesh, source.at);
  if (found.distance <= tolerance) return found;
  const bool own = source.at_axes == Axes::body;
  const auto given = [&](const Vector3& at) {
    return (own ? "at_body = " : "at = ") + digits(own ? at : point_in_world(body, at), tolerance);
  };
  const std::string what =
      fmt::format("{}: {} \"{}\" lies {:.4g} m off bodies.{}, {}", body.mesh.filename().string(), key,
                  source.name, found.distance, body.name, given(source.at));
  // The coordinates of a drawing may be in its own unit, and are then far off. A point that is hardly off may
  // also lie in the body after `scale`, near the origin.
  Vector3 drawn = source.at;
  for (double& x : drawn) x *= body.scale;
  if (own && found.distance > size_of(mesh) && locate(mesh, drawn).distance <= tolerance)
    throw InputError(
        fmt::format("{}: points are in metres, after scale = {}: write {}", what, body.scale, given(drawn)));
  throw InputError(fmt::format("{}: move it to the nearest point, {}", what, given(found.place)));
}

}  // namespace

mesh::RequestedGroups requested_groups(const scene::KernelRequest& request) {
  mesh::RequestedGroups asked;
  for (const scene::Forcing& traction : request.loads.tractions) place_of(asked.loaded, traction.group);
  for (const scene::Forcing& motion : request.loads.motions) place_of(asked.moved, motion.group);
  return asked;
}

Sources make_sources(const mesh::Mesh& mesh, const scene::KernelRequest& request) {
  Sources sources;
  std::vector<Weight> at_loads;
  mesh::RequestedGroups asked = requested_groups(request);
  const std::vector<Surface> surfaces = integrate(mesh.loaded, asked.loaded.size());
  for (const scene::Forcing& traction : request.loads.tractions) {
    const Surface& surface = surfaces[place_of(asked.loaded, traction.group)];
    const Integral& sum = traction.pressure ? surface.pressure : surface.traction;
    for (const auto& [node, weight] : sum.weight)
      at_loads.push_back(
          {node, static_cast<int>(sources.loads.size()), 1, {weight[0], weight[1], weight[2]}});
    sources.loads.push_back(load_of(mesh, traction.name, "Pa", sum.total, sum.first));
    sources.loads.back().inward = traction.pressure.has_value();
  }
  const double tolerance = request.loads.points.empty() && request.receivers.empty() && request.gauges.empty()
                               ? 0
                               : 1e-6 * size_of(mesh);
  const auto put = [&](const Located& place, std::size_t number, std::vector<Weight>& weights) {
    for (std::size_t a = 0; a < place.node.size(); ++a)
      weights.push_back({place.node[a], static_cast<int>(number), place.weight[a]});
  };
  for (const scene::Forcing& point : request.loads.points) {
    const Located place = on_body(mesh, request.body, "loads.point", point, tolerance);
    put(place, sources.loads.size(), at_loads);
    const Vector3d ones = Vector3d::Ones();
    sources.loads.push_back(
        load_of(mesh, point.name, "N", ones, Vector3d(place.place.data()) * ones.transpose()));
  }
  std::vector<Weight> at_receivers;
  for (const scene::Receiver& receiver : request.receivers) {
    const Located place = on_body(mesh, request.body, "output.receiver", receiver, tolerance);
    put(place, sources.receivers.size(), at_receivers);
    sources.receivers.emplace_back();
    sources.receivers.back().name = receiver.name;
    sources.receivers.back().point = place.place;
  }
  std::vector<Located> at_gauges;
  for (const scene::Gauge& gauge : request.gauges) {
    at_gauges.push_back(on_body(mesh, request.body, "output.gauge", gauge, tolerance));
    sources.gauges.push_back({gauge.name, at_gauges.back().place, {}});
    if (gauge.direction) sources.gauges.back().strain.emplace();
  }
  GaugeColumns gauges = gauge_columns(mesh, request, at_gauges);
  for (const std::string& support : asked.moved) sources.motions.push_back({support, {}, {}, {}});
  sources.load = spread(mesh, at_loads, sources.loads.size(), {}, FixedRows::zero);
  const auto seen = [&](FixedRows fixed, const reduction::Loads& by_gauges) {
    return reduction::beside({spread(mesh, at_receivers, sources.receivers.size(), {}, fixed), by_gauges});
  };
  sources.receiver = seen(FixedRows::zero, gauges.free);
  sources.receiver_filled = seen(FixedRows::filled, gauges.filled);
  sources.gauge_unit = std::move(gauges.unit);
  return sources;
}

}  // namespace ricochet::surface
