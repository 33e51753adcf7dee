// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/elasticity/pattern.hpp"

namespace ricochet::elasticity {

namespace {

using mesh::Basis;
using mesh::Block;
using mesh::Mesh;

/// Quadrature degree. Straight simplices have constant Jacobians, so that degree 2p integrates the mass
/// exactly. In other elements the Jacobian raises the degree; 2p + 2 keeps the patch test exact up to order 4
/// (cofactors have degree 2(p − 1), gradients p − 1).
int degree_of(const mesh::ReferenceElement& element, bool affine) {
  const bool simplex = element.family == mesh::Family::tetrahedron || element.family == mesh::Family::line;
  return 2 * element.order + (simplex && affine ? 0 : 2);
}

struct Material {
  double density, lambda, mu;  ///< rods: ρA, EA, 0
};

Material material_of(const scene::Material& m, int dim) {
  if (dim == 1) return {m.density * m.area, m.young * m.area, 0};
  return {m.density, m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)),
          m.young / (2 * (1 + m.poisson))};
}

/// Computes the element matrices of one block. Shape functions are tabulated once.
class Element {
 public:
  Element(const Mesh& mesh, const Block& block)
      : mesh_(mesh), n_(block.nodes_per_element), reference_(mesh::reference_element(block.gmsh_type)) {
    const auto rule = mesh::quadrature_of(reference_.family, degree_of(reference_, all_affine(block)));
    basis_ = mesh::basis_at(reference_, rule.local);
    weight_ = rule.weight;
    const int q = basis_.points, c = mesh.components();
    gradient_.resize(static_cast<Eigen::Index>(c) * n_, q);
    shape_ = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        basis_.value.data(), q, n_);
    position_.resize(n_, 3);
    measure_.resize(q);
    K.resize(c * n_, c * n_);
    M.resize(n_, n_);
  }

  /// Fills K (cn, cn) and the scalar mass M (n, n); returns false if the Jacobian is not positive everywhere.
  bool compute(const std::int64_t* nodes, const Material& material) {
    for (int a = 0; a < n_; ++a)
      for (int k = 0; k < 3; ++k)
        position_(a, k) = mesh_.position[3 * static_cast<std::size_t>(nodes[a]) + k];
    const int points = basis_.points;
    for (int q = 0; q < points; ++q) {
      const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> local(
          basis_.gradient.data() + static_cast<std::ptrdiff_t>(q) * n_ * 3, n_, 3);
      if (mesh_.dim == 1) {
        double slope = 0;
        for (int k = 0; k < 3; ++k) slope += local.col(0).dot(position_.col(k)) * mesh_.axis[k];
        // A line may point in either direction along the rod, so the slope may be negative.
        measure_(q) = std::abs(slope) * weight_[q];
        if (!(measure_(q) > 0)) return false;
        gradient_.col(q) = local.col(0) / slope;
        continue;
      }
      const Eigen::Matrix3d jacobian = local.transpose() * position_;  // (∂x_k/∂ξ_d) at (d,k)
      const double determinant = jacobian.determinant();
      measure_(q) = determinant * weight_[q];
      if (!(determinant > 0)) return false;
      const Eigen::Matrix3d inverse = jacobian.inverse();
      for (int a = 0; a < n_; ++a) gradient_.block<3, 1>(3 * a, q) = inverse * local.row(a).transpose();
    }
    M.noalias() = material.density * (shape_.transpose() * measure_.asDiagonal() * shape_);
    scaled_.noalias() = gradient_ * measure_.asDiagonal();
    product_.noalias() = scaled_ * gradient_.transpose();  // ∫ ∂_i N_a ∂_j N_b at (ca + i, cb + j)
    if (mesh_.dim == 1) {
      K = material.lambda * product_;
      return true;
    }
    // K_ab = λ ∇N_a ∇N_bᵀ + μ ∇N_b ∇N_aᵀ + μ (∇N_a·∇N_b) I
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b < n_; ++b) {
        const Eigen::Matrix3d h = product_.block<3, 3>(3 * a, 3 * b);
        Eigen::Matrix3d k = material.lambda * h + material.mu * h.transpose();
        k.diagonal().array() += material.mu * h.trace();
        K.block<3, 3>(3 * a, 3 * b) = k;
      }
    return true;
  }

  ElementMatrix K, M;
  const Eigen::VectorXd& measure() const { return measure_; }
  const Eigen::MatrixXd& shape() const { return shape_; }
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& position() const { return position_; }

 private:
  /// Whether every element of the block is an affine image of the reference element, so that its corners
  /// determine its nodes.
  bool all_affine(const Block& block) const {
    if (reference_.order == 1) return true;
    for (std::size_t e = 0; e < block.size(); ++e) {
      const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(n_)];
      const auto at = [&](int a, int k) {
        return mesh_.position[3 * static_cast<std::size_t>(nodes[a]) + k];
      };
      double size = 0, off = 0;
      for (int k = 0; k < 3; ++k) {
        size = std::max(size, std::abs(at(1, k) - at(0, k)));
        for (int a = reference_.corners; a < n_; ++a) {
          double x = at(0, k);
          for (int d = 0; d < reference_.dim; ++d) {
            const double xi = reference_.node[static_cast<std::size_t>(a) * reference_.dim + d];
            // Reference coordinates are in [−1, 1] for lines and in [0, 1] for tetrahedra. Other families
            // never use the affine rule.
            x += (reference_.dim == 1 ? (xi + 1) / 2 : xi) *
                 (at(std::min(d + 1, reference_.corners - 1), k) - at(0, k));
          }
          off = std::max(off, std::abs(at(a, k) - x));
        }
      }
      if (off > 1e-10 * size) return false;
    }
    return true;
  }

  const Mesh& mesh_;
  int n_;
  mesh::ReferenceElement reference_;
  Basis basis_;
  std::vector<double> weight_;
  Eigen::MatrixXd shape_;           // (q, n)
  ElementMatrix gradient_;          // (cn, q)
  ElementMatrix scaled_, product_;  // (cn, q), (cn, cn)
  Eigen::VectorXd measure_;         // (q) weight × Jacobian
  Eigen::Matrix<double, Eigen::Dynamic, 3> position_;
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
      const scene::Material& given = materials[static_cast<std::size_t>(block.label[e])];
      if (!element.compute(nodes, material_of(given, mesh.dim))) {
        const Vector3 x = node_position(mesh, static_cast<std::size_t>(nodes[0]));
        complaint = fmt::format(
            "{}: element {} near ({:.4g}, {:.4g}, {:.4g}) m is inverted or flat (its Jacobian is not "
            "positive): repair the "
            "mesh (gmsh: Tools > Optimize, or a smaller element size) or lower the element order",
            file, block.tag[e], x[0], x[1], x[2]);
        break;
      }
      body.wave_speed = std::max(body.wave_speed, std::sqrt(given.young / given.density));
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
      const double density = material_of(given, mesh.dim).density;
      const Eigen::MatrixXd points = element.shape() * element.position();  // (q,3)
      for (Eigen::Index q = 0; q < points.rows(); ++q) {
        const double w = density * element.measure()(q);
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
  body.wave_speed = parallel::largest(mesh.comm, body.wave_speed);

  finish_rows(mesh, stiffest, body);
  return body;
}

}  // namespace ricochet::elasticity
