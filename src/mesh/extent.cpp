// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/extent.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace ricochet::mesh {

namespace {

/// The axes in both senses, and a Fibonacci lattice on the sphere, whose neighbours are 0.2 apart.
std::vector<std::array<double, 3>> directions() {
  constexpr int lattice = 314;
  std::vector<std::array<double, 3>> out;
  for (std::size_t c = 0; c < 3; ++c)
    for (const double sign : {1.0, -1.0}) {
      out.push_back({});
      out.back()[c] = sign;
    }
  for (int k = 0; k < lattice; ++k) {
    const double z = 1 - (2 * k + 1.0) / lattice, radius = std::sqrt(1 - z * z);
    const double angle = 2 * std::numbers::pi * std::numbers::phi * k;
    out.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return out;
}

}  // namespace

std::vector<double> outline_of(const Mesh& mesh) {
  const auto towards = directions();
  const auto count = static_cast<int>(towards.size());
  constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  std::vector<double> farthest(towards.size(), -std::numeric_limits<double>::infinity());
  std::vector<std::int64_t> node(towards.size(), none), local(towards.size(), -1);
  const auto along = [&](std::size_t k, std::size_t i) {
    const double* x = &mesh.position[3 * i];
    return towards[k][0] * x[0] + towards[k][1] * x[1] + towards[k][2] * x[2];
  };
  mesh.for_each_owned([&](std::size_t i, std::int64_t) {
    for (std::size_t k = 0; k < towards.size(); ++k) farthest[k] = std::max(farthest[k], along(k, i));
  });
  MPI_Allreduce(MPI_IN_PLACE, farthest.data(), count, MPI_DOUBLE, MPI_MAX, mesh.comm);
  // The first of equally far nodes counts, so that the number of ranks has no effect.
  mesh.for_each_owned([&](std::size_t i, std::int64_t) {
    for (std::size_t k = 0; k < towards.size(); ++k)
      if (along(k, i) == farthest[k] && mesh.canonical[i] < node[k]) {
        node[k] = mesh.canonical[i];
        local[k] = static_cast<std::int64_t>(i);
      }
  });
  std::vector<std::int64_t> first = node;
  MPI_Allreduce(MPI_IN_PLACE, first.data(), count, MPI_INT64_T, MPI_MIN, mesh.comm);
  std::vector<double> position(3 * towards.size(), 0);
  std::set<std::int64_t> seen;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < towards.size(); ++k) {
    if (first[k] == none || !seen.insert(first[k]).second) continue;
    if (node[k] == first[k])
      for (std::size_t c = 0; c < 3; ++c)
        position[3 * kept + c] = mesh.position[3 * static_cast<std::size_t>(local[k]) + c];
    ++kept;
  }
  position.resize(3 * kept);
  parallel::sum(mesh.comm, position);
  return position;
}

std::int64_t held_on_lines(const Mesh& mesh) {
  if (mesh.dim != 3 || mesh.total_elements == 0) return 0;
  // Per component: number of fixed nodes, and number of faces with all corners fixed.
  std::array<double, 6> found{};
  mesh.for_each_owned([&](std::size_t i, std::int64_t) {
    for (int c = 0; c < 3; ++c) found[c] += mesh.is_fixed(i, c) ? 1 : 0;
  });
  for (const Block& block : mesh.blocks) {
    const ReferenceElement element = reference_element(block.gmsh_type);
    const auto faces = outward_faces(element.family);
    for (std::size_t at = 0; at < block.node.size(); at += block.nodes_per_element)
      for (int c = 0; c < 3; ++c) {
        const auto fixed = [&](int corner) {
          return mesh.is_fixed(static_cast<std::size_t>(block.node[at + corner]), c);
        };
        for (const auto& face : faces) found[3 + c] += std::ranges::all_of(face, fixed) ? 1 : 0;
      }
  }
  parallel::sum(mesh.comm, found.data(), found.size());
  std::int64_t bits = 0;
  for (int c = 0; c < 3; ++c)
    if (found[c] > 0 && found[3 + c] == 0) bits |= std::int64_t{1} << c;
  return bits;
}

double surface_of(const Mesh& mesh) {
  struct Face {
    std::array<std::int64_t, 4> corner;  // sorted; −1 before those of a triangle
    double area;
    auto operator<=>(const Face& other) const { return corner <=> other.corner; }
    bool operator==(const Face& other) const { return corner == other.corner; }
  };
  std::vector<Face> faces;
  const auto at = [&](std::int64_t node) {
    return Eigen::Map<const Eigen::Vector3d>(&mesh.position[3 * static_cast<std::size_t>(node)]);
  };
  for (const Block& block : mesh.blocks) {
    const auto shape = outward_faces(reference_element(block.gmsh_type).family);
    for (std::size_t first = 0; first < block.node.size(); first += block.nodes_per_element)
      for (const auto& corners : shape) {
        std::array<std::int64_t, 4> corner{-1, -1, -1, -1};
        for (std::size_t k = 0; k < corners.size(); ++k)
          corner[k] = block.node[first + static_cast<std::size_t>(corners[k])];
        const Eigen::Vector3d a = at(corner[2]) - at(corner[0]),
                              b = at(corner[corners.size() - 1]) - at(corner[1]);
        const Eigen::Vector3d side = corners.size() == 3 ? Eigen::Vector3d(at(corner[1]) - at(corner[0])) : b;
        std::ranges::sort(corner);
        // The rank that owns the first corner holds both elements of a face, if there are two.
        const auto lowest = static_cast<std::size_t>(corner[4 - corners.size()]);
        if (mesh.owned(mesh.node[lowest]) >= 0) faces.push_back({corner, a.cross(side).norm() / 2});
      }
  }
  std::ranges::sort(faces);
  std::vector<double> area{0};
  for (auto face = faces.begin(); face != faces.end();) {
    const auto next = std::find_if(face, faces.end(), [&](const Face& other) { return other != *face; });
    if (next - face == 1) area[0] += face->area;
    face = next;
  }
  parallel::sum(mesh.comm, area);
  return area[0];
}

}  // namespace ricochet::mesh
