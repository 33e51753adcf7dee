// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/rigid_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/format.hpp"
#include "kernels/crease_angle.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Cosine of the angle up to which faces that meet are smooth.
const double smooth_edge = std::cos(kernels::crease_angle);

/// Parts of a full circle, along a circle of revolution and along a meridian. They are to find points by; the
/// points are then taken to the closed form.
constexpr int around_axis = 64, along_meridian = 64;
/// Parts of a flat face along an edge or a radius, so that elements are not far longer than those of bodies.
constexpr int across_face = 8;
/// Share of a shape within which a node is on its closed form.
constexpr double on_form = 1e-9;

Vector3d facet_normal(const RigidMesh& mesh, const std::array<int, 3>& t) {
  const auto at = [&](std::size_t j) { return mesh.node[static_cast<std::size_t>(t[j])]; };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

/// The surface of revolution of a profile (ρ, z), anticlockwise in its half plane; from the axis to the axis,
/// or a loop.
RigidMesh revolve(const std::vector<std::array<double, 2>>& profile, bool is_loop) {
  RigidMesh out;
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  std::vector<std::array<int, around_axis>> ring;
  for (const auto& [rho, z] : profile) {
    auto& nodes = ring.emplace_back();
    for (int k = 0; k < around_axis; ++k) {
      if (rho > 0 || k == 0) {
        const double angle = 2 * std::numbers::pi * k / around_axis;
        out.node.emplace_back(rho * std::cos(angle), rho * std::sin(angle), z);
      }
      nodes[at(k)] = static_cast<int>(out.node.size()) - 1;
    }
  }
  const int rings = static_cast<int>(ring.size());
  for (int j = 0; j + (is_loop ? 0 : 1) < rings; ++j)
    for (int k = 0; k < around_axis; ++k) {
      const auto &low = ring[at(j)], &high = ring[at((j + 1) % rings)];
      const std::size_t next = at((k + 1) % around_axis), here = at(k);
      if (low[here] != low[next]) out.triangle.push_back({low[here], low[next], high[next]});
      if (high[here] != high[next]) out.triangle.push_back({low[here], high[next], high[here]});
    }
  return out;
}

/// Adds the points of a straight part of a profile, without its end.
void add_line(std::vector<std::array<double, 2>>& profile, const std::array<double, 2>& from,
              const std::array<double, 2>& to, int parts) {
  for (int k = 0; k < parts; ++k) {
    const double s = static_cast<double>(k) / parts;
    profile.push_back({from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1])});
  }
}

RigidMesh mesh_of(const RoundSurface& round) {
  std::vector<std::array<double, 2>> profile;
  const double half = round.length / 2;
  const auto add_arc = [&](double rho, double z, double radius, double from, double to) {
    const int parts = static_cast<int>(std::lround(along_meridian * (to - from) / (2 * std::numbers::pi)));
    for (int k = 0; k < parts; ++k) {
      const double angle = from + (to - from) * k / parts;
      profile.push_back({rho + radius * std::cos(angle), z + radius * std::sin(angle)});
    }
  };
  const double part = 2 * std::numbers::pi * std::max(round.radius, round.radius_small) / around_axis;
  const auto bands = [&](double slant) { return std::clamp(static_cast<int>(slant / (2 * part)), 1, 64); };
  if (round.form == RoundSurface::Form::torus) {
    add_arc(round.radius, 0, round.radius_small, 0, 2 * std::numbers::pi);
  } else if (round.form == RoundSurface::Form::capsule) {
    add_arc(0, -half, round.radius, -std::numbers::pi / 2, 0);
    profile.front()[0] = 0;
    if (half > 0) add_line(profile, {round.radius, -half}, {round.radius, half}, bands(round.length));
    add_arc(0, half, round.radius, 0, std::numbers::pi / 2);
    profile.push_back({0, half + round.radius});
  } else {
    const std::array<double, 2> low{round.radius, -half}, high{round.radius_small, half};
    if (round.radius > 0) add_line(profile, {0, -half}, low, across_face);
    add_line(profile, low, high, bands(std::hypot(round.length, round.radius - round.radius_small)));
    if (round.radius_small > 0) add_line(profile, high, {0, half}, across_face);
    profile.push_back({0, half});
  }
  RigidMesh out = revolve(profile, round.form == RoundSurface::Form::torus);
  out.inside = round.side < 0;
  return out;
}

/// Numbers the groups of corners between which the surface is smooth: corners at one node are in one group if
/// a chain of smooth edges joins their triangles.
class SmoothCorners {
 public:
  explicit SmoothCorners(const RigidMesh& mesh) : parent_(3 * mesh.triangle.size()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    std::vector<Vector3d> normal;
    for (const auto& t : mesh.triangle) normal.push_back(facet_normal(mesh, t).normalized());
    std::map<std::pair<int, int>, std::size_t> corner;  // that begins a directed edge
    for (std::size_t f = 0; f < mesh.triangle.size(); ++f)
      for (std::size_t j = 0; j < 3; ++j)
        corner[{mesh.triangle[f][j], mesh.triangle[f][(j + 1) % 3]}] = 3 * f + j;
    for (const auto& [edge, begin] : corner) {
      const auto other = corner.find({edge.second, edge.first});
      if (other == corner.end() || !(normal[begin / 3].dot(normal[other->second / 3]) > smooth_edge))
        continue;
      join(begin, next(other->second));
      join(next(begin), other->second);
    }
  }

  std::size_t group(std::size_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

 private:
  static std::size_t next(std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  void join(std::size_t one, std::size_t other) { parent_[group(one)] = group(other); }

  std::vector<std::size_t> parent_;
};

/// The normals at the corners of all triangles: means of the facets around them, by their angles.
std::vector<Vector3d> corner_normals(const RigidMesh& mesh) {
  SmoothCorners smooth(mesh);
  std::vector<Vector3d> sum(3 * mesh.triangle.size(), Vector3d::Zero()), out;
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    const Vector3d normal = facet_normal(mesh, mesh.triangle[f]).normalized();
    for (std::size_t j = 0; j < 3; ++j) {
      const auto at = [&](std::size_t k) {
        return mesh.node[static_cast<std::size_t>(mesh.triangle[f][k % 3])];
      };
      const Vector3d one = at(j + 1) - at(j), other = at(j + 2) - at(j);
      sum[smooth.group(3 * f + j)] += std::atan2(one.cross(other).norm(), one.dot(other)) * normal;
    }
  }
  for (std::size_t corner = 0; corner < sum.size(); ++corner)
    out.push_back(sum[smooth.group(corner)].normalized());
  return out;
}

WorldSurface assemble(const RigidMesh& mesh, const std::optional<RoundSurface>& round) {
  WorldSurface out;
  out.is_rigid = true;
  out.round = round;
  out.node = out.crest = mesh.node;
  out.normal.assign(mesh.node.size(), Vector3d::Zero());
  out.area.assign(mesh.node.size(), 0);
  out.bulge.assign(mesh.node.size(), 0);
  out.on_crease.assign(mesh.node.size(), 0);
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : mesh.node) {
    box.extend(x);
    out.farthest = std::max(out.farthest, x.cwiseAbs().maxCoeff());
  }
  out.extent = box.diagonal().norm();
  std::vector<Vector3d> normal = corner_normals(mesh);
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    const std::array<int, 3>& t = mesh.triangle[f];
    const Vector3d facet = facet_normal(mesh, t);
    WorldSurface::Element element;
    element.corner = t;
    if (mesh.inside) std::swap(element.corner[1], element.corner[2]);
    const auto is_on_form = [&](int node) {
      return std::abs(round->closest(mesh.node[static_cast<std::size_t>(node)]).distance) <
             on_form * out.extent;
    };
    element.round = round && std::ranges::all_of(t, is_on_form);
    out.add(element);
    for (std::size_t j = 0; j < 3; ++j) {
      const auto node = static_cast<std::size_t>(out.element.back().corner[j]);
      const std::size_t corner = mesh.inside && j > 0 ? 3 - j : j;
      Vector3d n = (mesh.inside ? -1 : 1) * normal[3 * f + corner];
      if (element.round) {
        // The tip of a cone has no normal of its own.
        const bool is_tip = std::hypot(mesh.node[node].x(), mesh.node[node].y()) == 0 &&
                            round->form == RoundSurface::Form::cone;
        n = round->closest(is_tip ? out.element.back().centre : mesh.node[node]).normal;
      } else if (round) {
        n = (mesh.inside ? -1 : 1) * facet.normalized();
      }
      out.element.back().normal[j] = n;
      out.normal[node] += n;
      out.area[node] += facet.norm() / 6;
    }
  }
  for (Vector3d& n : out.normal) n.normalize();
  bend_elements(out);
  const auto is_on_axis = [&](int node) {
    return out.node[static_cast<std::size_t>(node)].head<2>().isZero(0);
  };
  if (round)  // the lines from the tip of a cone are no creases
    std::erase_if(out.crease, [&](const WorldSurface::Crease& crease) {
      return is_on_axis(crease.node[0]) || is_on_axis(crease.node[1]);
    });
  return out;
}

}  // namespace

WorldSurface rigid_surface(const RigidMesh& mesh) { return assemble(mesh, std::nullopt); }

WorldSurface rigid_surface(const RoundSurface& round) { return assemble(mesh_of(round), round); }

WorldSurface rigid_box(const Vector3d& size, bool inside) {
  RigidMesh mesh;
  mesh.inside = inside;
  std::map<std::array<int, 3>, int> number;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = number.emplace(at, static_cast<int>(mesh.node.size()));
    if (is_new)
      mesh.node.push_back(
          size.cwiseProduct(Vector3d(at[0], at[1], at[2]) / across_face - Vector3d::Constant(0.5)));
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true})
      for (int i = 0; i < across_face; ++i)
        for (int j = 0; j < across_face; ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> at{};
            at[axis] = high ? across_face : 0;
            at[(axis + 1) % 3] = i + u;
            at[(axis + 2) % 3] = j + v;
            return node(at);
          };
          std::array<int, 4> quad{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (!high) std::swap(quad[1], quad[3]);
          mesh.triangle.push_back({quad[0], quad[1], quad[2]});
          mesh.triangle.push_back({quad[0], quad[2], quad[3]});
        }
  return rigid_surface(mesh);
}

std::string flaw_of(RigidMesh& mesh) {
  if (mesh.triangle.empty()) return "has no triangles";
  std::map<std::pair<int, int>, int> edges;
  double volume = 0;
  for (const auto& t : mesh.triangle) {
    for (const int node : t)
      if (node < 0 || node >= static_cast<int>(mesh.node.size()))
        return base::format("has a triangle with the node {}, but {} nodes, counted from 0", node,
                            mesh.node.size());
    if (!(facet_normal(mesh, t).norm() > 0)) return "has a triangle without area";
    volume += mesh.node[static_cast<std::size_t>(t[0])].dot(
        mesh.node[static_cast<std::size_t>(t[1])].cross(mesh.node[static_cast<std::size_t>(t[2])]));
    for (std::size_t j = 0; j < 3; ++j) ++edges[{t[j], t[(j + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (count == 1 && other != edges.end() && other->second == 1) continue;
    const Vector3d x =
        (mesh.node[static_cast<std::size_t>(edge.first)] + mesh.node[static_cast<std::size_t>(edge.second)]) /
        2;
    return base::format(
        "is not closed at [{:.6g}, {:.6g}, {:.6g}]: an edge there does not belong to two triangles "
        "with the same sense",
        x.x(), x.y(), x.z());
  }
  if (volume < 0)
    for (auto& t : mesh.triangle) std::swap(t[1], t[2]);
  return "";
}

}  // namespace ricochet::contact
