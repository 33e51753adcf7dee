// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/elasticity: integrals over one element.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <vector>

#include "src/elasticity/law.hpp"
#include "src/mesh/mesh.hpp"
#include "src/mesh/reference.hpp"

namespace ricochet::elasticity {

using ElementMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Material {
  double density, lambda, mu;        ///< rods: ρA, EA, 0
  std::shared_ptr<const Law> law{};  ///< of an anisotropic material, without λ and μ; null: isotropic
  bool uniform() const { return !law || law->uniform(); }
};

/// In the order of the labels of elements.
std::vector<Material> materials_of(const std::vector<scene::Material>& materials, int dim);

/// Functions on an element, by their values and gradients at the quadrature points.
struct Functions {
  Eigen::MatrixXd value;           ///< (q, n)
  std::vector<double> gradient{};  ///< (q, n, 3) in local coordinates
  Eigen::Index size() const { return value.cols(); }
};

Functions functions_of(const mesh::Basis& basis);

/// Quadrature points of the elements of one block, and their Jacobians in one element after another.
class ElementPoints {
 public:
  /// @param block  of the mesh, which must outlive this
  /// @param degree  of the polynomials that the rule integrates in elements with constant Jacobians; others
  /// get two more, which keeps the patch test exact up to order 4 (cofactors have degree 2(p − 1), gradients
  /// p − 1)
  ElementPoints(const mesh::Mesh& mesh, const mesh::Block& block, int degree);

  int components() const { return mesh_.components(); }
  const mesh::ReferenceElement& reference() const { return reference_; }
  const std::vector<double>& local() const { return rule_.local; }  ///< (q,3)
  /// The shape functions of the elements.
  const Functions& shapes() const { return shapes_; }

  /// Goes to an element. @param nodes  local numbers in the mesh
  /// @return false if the Jacobian is not positive everywhere
  bool move_to(const std::int64_t* nodes);

  const Eigen::VectorXd& measure() const { return measure_; }  ///< (q) weight × Jacobian
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& position() const { return position_; }  ///< (n,3) of nodes

  /// C of an anisotropic material at the points, or one that serves for all of them; empty if it is
  /// isotropic.
  std::vector<Matrix6> stiffness(const Material& material) const;

  /// Gradients of functions in space: (c n, q); along the axis of rods, c = 1.
  void gradients(const Functions& functions, ElementMatrix& out) const;

  const std::vector<double>& weight() const { return rule_.weight; }  ///< (q)
  /// The inverse of the Jacobian of a solid if it is the same at all points, as in a straight simplex;
  /// otherwise null.
  const Eigen::Matrix3d* constant_inverse() const;

 private:
  const mesh::Mesh& mesh_;
  int n_;
  mesh::ReferenceElement reference_;
  mesh::Quadrature rule_;
  Functions shapes_;
  Eigen::VectorXd measure_;
  std::vector<Eigen::Matrix3d> inverse_;  ///< (q) of the Jacobian; rods: 1/slope in the first entry
  Eigen::Matrix<double, Eigen::Dynamic, 3> position_;
};

/// K_ab = ∫ ∂_j v_a C_ijkl ∂_l u_b at (ca + i, cb + k) from the gradients of functions v and u at the points
/// of one element after another. Isotropic: K_ab = ∫ λ ∇v_a ∇u_bᵀ + μ ∇u_b ∇v_aᵀ + μ (∇v_a·∇u_b) I.
class StiffnessIntegral {
 public:
  /// @param of_v, of_u  (c n, q) gradients in the element to which the points have moved
  void compute(const ElementPoints& points, const Material& material, const ElementMatrix& of_v,
               const ElementMatrix& of_u, ElementMatrix& out);

 private:
  /// Takes C at each point.
  void at_points(const ElementPoints& points, const Material& material, const ElementMatrix& of_v,
                 const ElementMatrix& of_u, ElementMatrix& out);

  ElementMatrix scaled_, strain_, stress_;
};

/// The same of functions that stay the same. Where the Jacobian and C are constant, the integrals are
/// combinations of those over the reference element, which takes a small part of the time of a sum over the
/// points.
class GradientProducts {
 public:
  /// @param v, u  at these points
  GradientProducts(const ElementPoints& points, Functions v, Functions u);

  /// K_ab of the element to which the points have moved.
  void compute(const ElementPoints& points, const Material& material, ElementMatrix& out);

 private:
  Functions v_, u_;
  ElementMatrix reference_;  ///< (9, v·u) ∫ ∂_d v_a ∂_e u_b at (3d + e, a·u + b)
  ElementMatrix straight_, of_v_, of_u_;
  StiffnessIntegral integral_;
};

/// The block K_aa of functions v_a with these gradients. Rods use its first entry alone, and have 1 on the
/// rest of its diagonal.
/// @param gradient  (c n, q), @param measure  (q), @param stiffness  as ElementPoints gives it
Eigen::Matrix3d own_stiffness(const Material& material, int components, const ElementMatrix& gradient, int a,
                              const Eigen::VectorXd& measure, const std::vector<Matrix6>& stiffness);

}  // namespace ricochet::elasticity
