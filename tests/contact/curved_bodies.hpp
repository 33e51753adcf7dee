// SPDX-License-Identifier: BSD-2-Clause
// Rigid bodies with curved surfaces: balls, and what a map makes of them.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "tests/contact/rigid_body.hpp"

namespace ricochet::contact::test {

/// Makes triangles the elements of a rigid body, with a residual flexibility that decays over a length.
/// @param normals  of the corners of each triangle
inline void cover(kernels::Kernel& kernel, const std::vector<std::array<int, 3>>& triangles,
                  const std::vector<std::array<Vector3d, 3>>& normals, double flexibility, double decay,
                  double bulge) {
  kernels::Surface& surface = kernel.surface;
  surface.element_corners = 3;
  surface.element.clear();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t j = 0; j < 3; ++j) {
      surface.element.push_back(triangles[t][j]);
      surface.element_normal.insert(surface.element_normal.end(), normals[t][j].begin(), normals[t][j].end());
    }
  surface.centroid = surface.node;
  surface.bulge.assign(surface.size(), bulge);
  const std::size_t n = 3 * surface.size();
  const auto at = [&](std::size_t i) { return Eigen::Map<const Vector3d>(&surface.node[3 * i]); };
  for (std::size_t i = 0; i < surface.size(); ++i)
    for (std::size_t j = 0; j < surface.size(); ++j)
      for (std::size_t axis = 0; axis < 3; ++axis)
        surface.residual_flexibility[(3 * i + axis) * n + 3 * j + axis] =
            flexibility * std::exp(-(at(i) - at(j)).norm() / decay);
}

struct Sphere {
  std::vector<Vector3d> node;
  std::vector<std::array<int, 3>> triangles;
};

/// A unit sphere of an icosahedron whose triangles have been divided twice: 162 nodes.
inline Sphere unit_sphere() {
  Sphere sphere;
  auto& [node, triangles] = sphere;
  const double golden = std::numbers::phi;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-golden, golden})
      for (int axis = 0; axis < 3; ++axis) {
        Vector3d at = Vector3d::Zero();
        at[axis] = x;
        at[(axis + 1) % 3] = y;
        node.push_back(at.normalized());
      }
  const auto beside = [&](int i, int j) {
    return (node[static_cast<std::size_t>(i)] - node[static_cast<std::size_t>(j)]).norm() < 1.1;
  };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        if (!beside(i, j) || !beside(j, k) || !beside(i, k)) continue;
        const auto at = [&](int of) { return node[static_cast<std::size_t>(of)]; };
        const bool outward = (at(j) - at(i)).cross(at(k) - at(i)).dot(at(i)) > 0;
        triangles.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
  for (int round = 0; round < 2; ++round) {
    std::map<std::array<int, 2>, int> middle;
    const auto between = [&](int i, int j) {
      const auto [known, is_new] =
          middle.try_emplace({std::min(i, j), std::max(i, j)}, static_cast<int>(node.size()));
      if (is_new)
        node.push_back((node[static_cast<std::size_t>(i)] + node[static_cast<std::size_t>(j)]).normalized());
      return known->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [i, j, k] : triangles) {
      const int p = between(i, j), q = between(j, k), r = between(k, i);
      for (const auto& one : {std::array{i, p, r}, {p, j, q}, {r, q, k}, {p, q, r}}) finer.push_back(one);
    }
    triangles = finer;
  }
  return sphere;
}

/// A rigid body whose surface is a sphere that a map deforms.
/// @param outward  at a node of the unit sphere  @param bulge  of its patches [m]
template <class Place, class Outward>
kernels::Kernel deformed_sphere(double mass, const Vector3d& moments, Place place, Outward outward,
                                double flexibility, double decay, double bulge) {
  const Sphere sphere = unit_sphere();
  std::vector<Vector3d> node;
  for (const Vector3d& x : sphere.node) node.push_back(place(x));
  std::vector<std::array<Vector3d, 3>> normals;
  for (const auto& [i, j, k] : sphere.triangles) {
    const auto at = [&](int of) -> Vector3d { return outward(sphere.node[static_cast<std::size_t>(of)]); };
    normals.push_back({at(i), at(j), at(k)});
  }
  kernels::Kernel kernel = rigid_body(mass, moments, node, flexibility);
  cover(kernel, sphere.triangles, normals, flexibility, decay, bulge);
  return kernel;
}

inline kernels::Kernel ball(double mass, double radius, double flexibility, double bulge = 0) {
  return deformed_sphere(
      mass, Vector3d::Constant(0.4 * mass * radius * radius),
      [&](const Vector3d& x) -> Vector3d { return radius * x; }, [](const Vector3d& x) { return x; },
      flexibility, 0.3 * radius, bulge);
}

}  // namespace ricochet::contact::test
