// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/element.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::elasticity {

namespace {

using mesh::Block;
using mesh::Mesh;
using mesh::ReferenceElement;

/// Whether every element of a block is an affine image of the reference element, so that its corners
/// determine its nodes.
bool all_affine(const Mesh& mesh, const Block& block, const ReferenceElement& reference) {
  if (reference.order == 1) return true;
  const auto n = static_cast<std::size_t>(block.nodes_per_element);
  for (std::size_t e = 0; e < block.size(); ++e) {
    const std::int64_t* nodes = &block.node[e * n];
    const auto at = [&](int a, int k) { return mesh.position[3 * static_cast<std::size_t>(nodes[a]) + k]; };
    double size = 0, off = 0;
    for (int k = 0; k < 3; ++k) {
      size = std::max(size, std::abs(at(1, k) - at(0, k)));
      for (int a = reference.corners; a < block.nodes_per_element; ++a) {
        double x = at(0, k);
        for (int d = 0; d < reference.dim; ++d) {
          const double xi = reference.node[static_cast<std::size_t>(a) * reference.dim + d];
          // Reference coordinates are in [−1, 1] for lines and in [0, 1] for tetrahedra. Other families never
          // use the affine rule.
          x += (reference.dim == 1 ? (xi + 1) / 2 : xi) *
               (at(std::min(d + 1, reference.corners - 1), k) - at(0, k));
        }
        off = std::max(off, std::abs(at(a, k) - x));
      }
    }
    if (off > 1e-10 * size) return false;
  }
  return true;
}

/// Turns ∫ ∂_j v_a ∂_l u_b at (ca + j, cb + l) into K where C is constant.
void to_stiffness(const Material& material, int components, ElementMatrix& product) {
  if (components == 1) {
    product *= material.lambda;
    return;
  }
  if (material.law) {
    const Eigen::Matrix<double, 9, 9> C = by_components(material.law->at(Eigen::Vector3d::Zero()));
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> h, k;
    for (Eigen::Index a = 0; a < product.rows(); a += 3)
      for (Eigen::Index b = 0; b < product.cols(); b += 3) {
        h = product.block<3, 3>(a, b);
        k.reshaped<Eigen::RowMajor>().noalias() = C * h.reshaped<Eigen::RowMajor>();
        product.block<3, 3>(a, b) = k;
      }
    return;
  }
  for (Eigen::Index a = 0; a < product.rows(); a += 3)
    for (Eigen::Index b = 0; b < product.cols(); b += 3) {
      const Eigen::Matrix3d h = product.block<3, 3>(a, b);
      Eigen::Matrix3d k = material.lambda * h + material.mu * h.transpose();
      k.diagonal().array() += material.mu * h.trace();
      product.block<3, 3>(a, b) = k;
    }
}

/// out = a bᵀ by BLAS. Libraries that do without BLAS also multiply plain matrices, and of two functions with
/// one name the linker keeps either, so these factors have a type of their own.
void multiply(const ElementMatrix& a, const ElementMatrix& b, ElementMatrix& out) {
  using View = Eigen::Map<const ElementMatrix>;
  const View left(a.data(), a.rows(), a.cols()), right(b.data(), b.rows(), b.cols());
  out.noalias() = left * right.transpose();
}

/// Straight simplices have constant Jacobians.
bool has_constant_jacobians(const Mesh& mesh, const Block& block, const ReferenceElement& reference) {
  const bool simplex =
      reference.family == mesh::Family::tetrahedron || reference.family == mesh::Family::line;
  return simplex && all_affine(mesh, block, reference);
}

}  // namespace

std::vector<Material> materials_of(const std::vector<scene::Material>& materials, int dim) {
  std::vector<Material> out;
  for (const scene::Material& m : materials)
    if (dim == 1)
      out.push_back({m.density * m.area, m.young * m.area, 0});
    else if (m.isotropic())
      out.push_back({m.density, m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)),
                     m.young / (2 * (1 + m.poisson))});
    else
      out.push_back({m.density, 0, 0, std::make_shared<const Law>(m)});
  return out;
}

Functions functions_of(const mesh::Basis& basis) {
  return {Eigen::Map<const ElementMatrix>(basis.value.data(), basis.points, basis.nodes), basis.gradient};
}

ElementPoints::ElementPoints(const Mesh& mesh, const Block& block, int degree)
    : mesh_(mesh), n_(block.nodes_per_element), reference_(mesh::reference_element(block.gmsh_type)) {
  rule_ = mesh::quadrature_of(reference_.family,
                              degree + (has_constant_jacobians(mesh, block, reference_) ? 0 : 2));
  shapes_ = functions_of(mesh::basis_at(reference_, rule_.local));
  measure_.resize(std::ssize(rule_.weight));
  inverse_.assign(rule_.weight.size(), Eigen::Matrix3d::Zero());
  position_.resize(n_, 3);
}

bool ElementPoints::move_to(const std::int64_t* nodes) {
  for (int a = 0; a < n_; ++a)
    for (int k = 0; k < 3; ++k) position_(a, k) = mesh_.position[3 * static_cast<std::size_t>(nodes[a]) + k];
  for (std::size_t q = 0; q < inverse_.size(); ++q) {
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> local(
        &shapes_.gradient[q * static_cast<std::size_t>(n_) * 3], n_, 3);
    const double weight = rule_.weight[q];
    if (mesh_.dim == 1) {
      double slope = 0;
      for (int k = 0; k < 3; ++k) slope += local.col(0).dot(position_.col(k)) * mesh_.axis[k];
      // A line may point in either direction along the rod, so the slope may be negative.
      measure_[static_cast<Eigen::Index>(q)] = std::abs(slope) * weight;
      if (!(std::abs(slope) * weight > 0)) return false;
      inverse_[q](0, 0) = 1 / slope;
      continue;
    }
    const Eigen::Matrix3d jacobian = local.transpose() * position_;  // (∂x_k/∂ξ_d) at (d,k)
    const double determinant = jacobian.determinant();
    measure_[static_cast<Eigen::Index>(q)] = determinant * weight;
    if (!(determinant > 0)) return false;
    inverse_[q] = jacobian.inverse();
  }
  return true;
}

void ElementPoints::gradients(const Functions& functions, ElementMatrix& out) const {
  const Eigen::Index n = functions.size(), c = mesh_.components();
  out.resize(c * n, std::ssize(inverse_));
  for (std::size_t q = 0; q < inverse_.size(); ++q) {
    const auto column = static_cast<Eigen::Index>(q);
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> local(
        &functions.gradient[q * static_cast<std::size_t>(n) * 3], n, 3);
    if (c == 1)
      out.col(column) = local.col(0) * inverse_[q](0, 0);
    else
      for (Eigen::Index a = 0; a < n; ++a)
        out.block<3, 1>(3 * a, column) = inverse_[q] * local.row(a).transpose();
  }
}

std::vector<Matrix6> ElementPoints::stiffness(const Material& material) const {
  if (!material.law) return {};
  if (material.uniform()) return {material.law->at(Eigen::Vector3d::Zero())};
  const Eigen::Matrix<double, Eigen::Dynamic, 3> points = shapes_.value * position_;
  std::vector<Matrix6> out;
  for (Eigen::Index q = 0; q < points.rows(); ++q) out.push_back(material.law->at(points.row(q)));
  return out;
}

const Eigen::Matrix3d* ElementPoints::constant_inverse() const {
  if (mesh_.dim == 1) return nullptr;
  const Eigen::Matrix3d& first = inverse_.front();
  const double most = 1e-10 * first.cwiseAbs().maxCoeff();
  for (const Eigen::Matrix3d& inverse : inverse_)
    if (!((inverse - first).cwiseAbs().maxCoeff() <= most)) return nullptr;
  return &first;
}

void StiffnessIntegral::compute(const ElementPoints& points, const Material& material,
                                const ElementMatrix& of_v, const ElementMatrix& of_u, ElementMatrix& out) {
  if (!material.uniform()) return at_points(points, material, of_v, of_u, out);
  scaled_.noalias() = of_v * points.measure().asDiagonal();
  multiply(scaled_, of_u, out);
  to_stiffness(material, points.components(), out);
}

void StiffnessIntegral::at_points(const ElementPoints& points, const Material& material,
                                  const ElementMatrix& of_v, const ElementMatrix& of_u, ElementMatrix& out) {
  const std::vector<Matrix6> C = points.stiffness(material);
  const Eigen::Index each = 6, n = std::ssize(C);
  strain_.resize(of_v.rows(), each * n);  // of v, and the stress of u
  stress_.resize(of_u.rows(), each * n);
  for (Eigen::Index q = 0; q < n; ++q) {
    const Matrix6 weighted = points.measure()[q] * C[static_cast<std::size_t>(q)];
    for (Eigen::Index a = 0; a < of_v.rows(); a += 3)
      strain_.block<3, 6>(a, each * q) = strain_of(of_v.block<3, 1>(a, q)).transpose();
    for (Eigen::Index b = 0; b < of_u.rows(); b += 3)
      stress_.block<3, 6>(b, each * q) = (weighted * strain_of(of_u.block<3, 1>(b, q))).transpose();
  }
  multiply(strain_, stress_, out);
}

GradientProducts::GradientProducts(const ElementPoints& points, Functions v, Functions u)
    : v_(std::move(v)), u_(std::move(u)), reference_(ElementMatrix::Zero(9, v_.size() * u_.size())) {
  const Eigen::Index n = v_.size(), m = u_.size();
  for (std::size_t q = 0; q < points.weight().size(); ++q) {
    const double *of_v = &v_.gradient[q * static_cast<std::size_t>(3 * n)],
                 *of_u = &u_.gradient[q * static_cast<std::size_t>(3 * m)];
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        for (Eigen::Index k = 0; k < 9; ++k)
          reference_(k, a * m + b) += points.weight()[q] * of_v[3 * a + k / 3] * of_u[3 * b + k % 3];
  }
}

void GradientProducts::compute(const ElementPoints& points, const Material& material, ElementMatrix& out) {
  const Eigen::Matrix3d* const inverse = material.uniform() ? points.constant_inverse() : nullptr;
  if (inverse == nullptr) {
    points.gradients(v_, of_v_);
    points.gradients(u_, of_u_);
    integral_.compute(points, material, of_v_, of_u_, out);
    return;
  }
  Eigen::Matrix<double, 9, 9> combination;  // ∂_i ∂_j of ∂_d ∂_e
  for (int k = 0; k < 9; ++k)
    for (int l = 0; l < 9; ++l) combination(k, l) = (*inverse)(k / 3, l / 3) * (*inverse)(k % 3, l % 3);
  combination *= points.measure()[0] / points.weight()[0];
  straight_.noalias() = combination * reference_;
  const Eigen::Index n = v_.size(), m = u_.size();
  out.resize(3 * n, 3 * m);
  for (Eigen::Index k = 0; k < 9; ++k) {
    const double* from = &straight_(k, 0);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < m; ++b) out(3 * a + k / 3, 3 * b + k % 3) = *from++;
  }
  to_stiffness(material, 3, out);
}

Eigen::Matrix3d own_stiffness(const Material& material, int components, const ElementMatrix& gradient, int a,
                              const Eigen::VectorXd& measure, const std::vector<Matrix6>& stiffness) {
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  if (components == 1) {
    for (Eigen::Index q = 0; q < measure.size(); ++q)
      out(0, 0) += measure[q] * material.lambda * gradient(a, q) * gradient(a, q);
    out(1, 1) = out(2, 2) = 1;
    return out;
  }
  double square = 0;
  for (Eigen::Index q = 0; q < measure.size(); ++q) {
    const Eigen::Vector3d g(gradient(3 * a, q), gradient(3 * a + 1, q), gradient(3 * a + 2, q));
    if (material.law) {
      const Eigen::Matrix<double, 6, 3> strain = strain_of(g);
      const Matrix6& C = stiffness[material.uniform() ? 0 : static_cast<std::size_t>(q)];
      out += measure[q] * strain.transpose() * C * strain;
      continue;
    }
    out += measure[q] * (material.lambda + material.mu) * g * g.transpose();
    square += measure[q] * g.squaredNorm();
  }
  out.diagonal().array() += material.mu * square;
  return out;
}

}  // namespace ricochet::elasticity
