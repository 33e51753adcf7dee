// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/elasticity/element.hpp"
#include "src/elasticity/pattern.hpp"
#include "src/mesh/element_shape.hpp"
#include "src/mesh/extent.hpp"
#include "src/scene/elastic_law.hpp"

namespace ricochet::elasticity {

namespace {

using mesh::Block;
using mesh::Mesh;

/// Computes the element matrices of one block.
class Element {
 public:
  /// Degree 2p integrates the mass of straight elements exactly.
  Element(const Mesh& mesh, const Block& block)
      : points_(mesh, block, 2 * mesh::reference_element(block.gmsh_type).order) {}

  /// Fills K (cn, cn) and the scalar mass M (n, n); returns false if the Jacobian is not positive everywhere.
  bool compute(const std::int64_t* nodes, const Material& material) {
    if (!points_.move_to(nodes)) return false;
    M.noalias() = material.density * (shape().transpose() * measure().asDiagonal() * shape());
    points_.gradients(points_.shapes(), gradient_);
    integral_.compute(points_, material, gradient_, gradient_, K);
    return true;
  }

  ElementMatrix K, M;
  const Eigen::VectorXd& measure() const { return points_.measure(); }
  const Eigen::MatrixXd& shape() const { return points_.shapes().value; }
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& position() const { return points_.position(); }

 private:
  ElementPoints points_;
  ElementMatrix gradient_;  // (cn, q)
  StiffnessIntegral integral_;
};

/// Counts the entries of each row exactly, from the elements.
Pattern pattern_of(const Mesh& mesh) {
  std::vector<std::vector<std::int64_t>> columns(static_cast<std::size_t>(mesh.owned_nodes));
  for (const Block& block : mesh.blocks) {
    const auto n = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t e = 0; e < block.size(); ++e)
      for (std::size_t a = 0; a < n; ++a) {
        const std::int64_t row = mesh.owned(mesh.node[block.node[e * n + a]]);
        if (row < 0) continue;
        auto& list = columns[static_cast<std::size_t>(row)];
        for (std::size_t b = 0; b < n; ++b) {
          const std::int64_t column = mesh.node[block.node[e * n + b]];
          if (column >= row + mesh.first_node) list.push_back(column);
        }
        // Elements repeat columns. Removing duplicates from time to time keeps the list near its final size.
        if (list.size() > 512 && list.size() > 2 * list.capacity() / 3) mesh::sort_once(list);
      }
  }
  Pattern pattern;
  for (auto& list : columns) {
    mesh::sort_once(list);
    append_row(pattern, mesh, list);
    std::vector<std::int64_t>().swap(list);
  }
  return pattern;
}

Vector3 node_position(const Mesh& mesh, std::size_t local) {
  return {mesh.position[3 * local], mesh.position[3 * local + 1], mesh.position[3 * local + 2]};
}

/// Whether an element is inverted that would not be with straight edges.
bool only_bent(const Mesh& mesh, const Block& block, std::size_t element) {
  const mesh::ElementShape shape(block.gmsh_type);
  if (!shape.can_bend()) return false;
  mesh::Positions at(block.nodes_per_element, 3);
  for (int a = 0; a < block.nodes_per_element; ++a) {
    const auto node =
        block.node[element * static_cast<std::size_t>(block.nodes_per_element) + static_cast<std::size_t>(a)];
    const Vector3 x = node_position(mesh, static_cast<std::size_t>(node));
    at.row(a) << x[0], x[1], x[2];
  }
  return !shape.is_inverted(shape.straight(at));
}

}  // namespace

Body assemble(const Mesh& mesh, const std::vector<scene::Material>& materials, const std::string& file,
              const parallel::Progress& progress, const std::vector<std::string>& moved) {
  Body body;
  const int c = mesh.components();
  body.local_rows = mesh.owned_nodes * c;
  body.total_rows = mesh.total_nodes * c;
  const Pattern pattern = pattern_of(mesh);
  body.stiffness = create(mesh, pattern);
  body.mass = create(mesh, pattern);
  body.rigid_load = Eigen::MatrixXd::Zero(body.local_rows, 6);

  const std::vector<Material> laws = materials_of(materials, mesh.dim);
  std::vector<double> waves, poisson;
  for (const scene::Material& material : materials) {
    waves.push_back(scene::wave_speeds(material).mean);
    poisson.push_back(mesh.dim == 1 ? 0 : scene::mean_poisson(material));
  }
  std::array<double, 3> means{};  // ∫ dV, ∫ c⁻³ dV, ∫ ν dV
  Imposing imposing(mesh, moved);
  std::array<double, 10> moments{};
  std::string complaint;
  double stiffest = 0;
  std::int64_t all = 0, done = 0;
  for (const Block& block : mesh.blocks) all += static_cast<std::int64_t>(block.size());
  for (std::size_t b = 0; b < mesh.blocks.size() && complaint.empty(); ++b) {
    const Block& block = mesh.blocks[b];
    const int n = block.nodes_per_element;
    if (block.size() == 0) continue;
    Element element(mesh, block);
    ElementMatrix mass(c * n, c * n);
    Eigen::MatrixXd rigid(c * n, 6);
    std::vector<PetscInt> rows(static_cast<std::size_t>(n)), columns(static_cast<std::size_t>(n));
    for (std::size_t e = 0; e < block.size(); ++e) {
      if (progress && ++done % 256 == 0) progress(done, all);
      const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(n)];
      const auto label = static_cast<std::size_t>(block.label[e]);
      if (!element.compute(nodes, laws[label])) {
        const Vector3 x = node_position(mesh, static_cast<std::size_t>(nodes[0]));
        complaint = fmt::format(
            "{}: element {} near ({:.4g}, {:.4g}, {:.4g}) m is inverted or flat (its Jacobian is not "
            "positive): repair the mesh (gmsh: Tools > Optimize, or a smaller element size){}",
            file, block.tag[e], x[0], x[1], x[2],
            only_bent(mesh, block, e) ? " or lower the element order" : "");
        break;
      }
      mass.setZero();
      for (int a = 0; a < n; ++a)
        for (int d = 0; d < n; ++d)
          for (int k = 0; k < c; ++k) mass(c * a + k, c * d + k) = element.M(a, d);
      for (int a = 0; a < n; ++a) {
        const Vector3 x = node_position(mesh, static_cast<std::size_t>(nodes[a]));
        for (int k = 0; k < c; ++k)
          for (int m = 0; m < 6; ++m) rigid(c * a + k, m) = rigid_value(mesh, m, x, k);
      }
      const Eigen::MatrixXd load = mass * rigid;
      imposing.add(nodes, n, element.K, mass, load);
      for (int a = 0; a < n; ++a)
        for (int k = 0; k < c; ++k) {
          if (!mesh.is_fixed(static_cast<std::size_t>(nodes[a]), k)) continue;
          const int row = c * a + k;
          stiffest = std::max(stiffest, element.K(row, row));
          element.K.row(row).setZero();
          element.K.col(row).setZero();
          mass.row(row).setZero();
          mass.col(row).setZero();
        }
      for (int a = 0; a < n; ++a) {
        const std::int64_t own = mesh.owned(mesh.node[nodes[a]]);
        columns[a] = static_cast<PetscInt>(mesh.node[nodes[a]]);
        rows[a] = own < 0 ? -1 : columns[a];
        for (int k = 0; k < c && own >= 0; ++k)
          if (!mesh.is_fixed(static_cast<std::size_t>(nodes[a]), k))
            body.rigid_load.row(own * c + k) += load.row(c * a + k);
      }
      parallel::check(MatSetValuesBlocked(body.stiffness, n, rows.data(), n, columns.data(), element.K.data(),
                                          ADD_VALUES));
      parallel::check(
          MatSetValuesBlocked(body.mass, n, rows.data(), n, columns.data(), mass.data(), ADD_VALUES));
      if (mesh.own[b][e] == 0) continue;
      const double volume = element.measure().sum();
      means[0] += volume;
      means[1] += volume * std::pow(waves[label], -3);
      means[2] += volume * poisson[label];
      const Eigen::MatrixXd points = element.shape() * element.position();  // (q,3)
      for (Eigen::Index q = 0; q < points.rows(); ++q) {
        const double w = laws[label].density * element.measure()(q);
        const Eigen::Vector3d x = points.row(q);
        const std::array<double, 10> values{1,           x[0],        x[1],        x[2],        x[0] * x[0],
                                            x[0] * x[1], x[0] * x[2], x[1] * x[1], x[1] * x[2], x[2] * x[2]};
        for (std::size_t m = 0; m < values.size(); ++m) moments[m] += w * values[m];
      }
    }
  }
  parallel::agree(mesh.comm, complaint);
  finish_inertia(mesh.comm, moments, body);
  body.imposed = imposing.take();
  parallel::sum(mesh.comm, means.data(), means.size());
  body.wave_speed = std::cbrt(means[0] / means[1]);
  body.poisson = means[2] / means[0];
  if (mesh.dim == 3) {
    body.volume = means[0];
    body.surface = mesh::surface_of(mesh);
  }

  finish_rows(mesh, stiffest, body);
  return body;
}

}  // namespace ricochet::elasticity
