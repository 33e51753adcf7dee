// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/surplus.hpp"

#include <algorithm>
#include <map>

#include "src/elasticity/enriched.hpp"
#include "src/mesh/halo.hpp"

namespace ricochet::elasticity {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using mesh::Block;
using mesh::Mesh;

/// True errors over rᵀ D⁻¹ r, in the middle of those of modes of orders 2 and 3 on three bodies of compact
/// tetrahedra and hexahedra, none of which judges this code.
constexpr double of_compact_elements = 1.5;

/// An element of a rod has one new function, whose value at any inner node determines it. The sum over the
/// elements is then exact up to functions of even higher order.
constexpr int of_rods = 2;

/// Memory of the residuals of several modes [numbers], and the number of these modes.
constexpr Index most_numbers = Index{1} << 24, fewest_at_once = 32, most_at_once = 256;

/// The nodes of the next order that this rank owns: it holds all elements around them. A node belongs to the
/// rank that owns its lowest vertex.
class FinerNodes {
 public:
  /// @return −1 if another rank owns the node
  Index of(const mesh::NodeKey& key, const Mesh& mesh) {
    if (mesh.owned(key.corner[0]) < 0) return -1;
    return number_.try_emplace(key, std::ssize(number_)).first->second;
  }
  Index size() const { return std::ssize(number_); }

 private:
  std::map<mesh::NodeKey, Index> number_;
};

/// The elements of one block, with the functions of the next order.
struct EnrichedBlock {
  const Block* block;
  ElementPoints points;
  Enriched next;
  std::vector<Index> node{};  ///< (elements, m) as in FinerNodes
  GradientProducts products;  ///< of the surplus and the functions of the mesh
  ElementMatrix high{}, K{};

  EnrichedBlock(const Mesh& mesh, const Block& elements)
      : block(&elements),
        // ∫ w N ρ dV of straight elements has degree 2p + 1.
        points(mesh, elements, 2 * mesh::reference_element(elements.gmsh_type).order + 1),
        next(points, 1),
        products(points, next.surplus(), points.shapes()) {}

  const std::int64_t* nodes(std::size_t e) const {
    return &block->node[e * static_cast<std::size_t>(block->nodes_per_element)];
  }
};

void number_nodes(const Mesh& mesh, EnrichedBlock& of, FinerNodes& nodes) {
  const int corners = of.points.reference().corners;
  std::vector<std::int64_t> corner(static_cast<std::size_t>(corners));
  for (std::size_t e = 0; e < of.block->size(); ++e) {
    for (int c = 0; c < corners; ++c) corner[c] = mesh.node[of.nodes(e)[c]];
    for (int a = 0; a < of.next.nodes(); ++a) {
      const bool counts = mesh.dim == 3 || a == of_rods;
      of.node.push_back(counts ? nodes.of(of.next.keys().of(a, corner.data()), mesh) : -1);
    }
  }
}

/// Adds D, and marks fixed components. @param diagonal  by node, @param fixed  (c · nodes)
void add_diagonal(const Mesh& mesh, EnrichedBlock& of, std::size_t e, const Material& material,
                  std::vector<Eigen::Matrix3d>& diagonal, std::vector<char>& fixed) {
  const int c = mesh.components();
  of.points.gradients(c == 1 ? of.next.surplus() : of.next.shapes(), of.high);
  const std::vector<Matrix6> stiffness = of.points.stiffness(material);
  for (int a = 0; a < of.next.nodes(); ++a) {
    const Index node = of.node[e * static_cast<std::size_t>(of.next.nodes()) + static_cast<std::size_t>(a)];
    if (node < 0) continue;
    diagonal[static_cast<std::size_t>(node)] +=
        own_stiffness(material, c, of.high, a, of.points.measure(), stiffness);
    for (int k = 0; k < c; ++k)
      if (of.next.all_around(
              a, [&](int b) { return mesh.is_fixed(static_cast<std::size_t>(of.nodes(e)[b]), k); }))
        fixed[static_cast<std::size_t>(c * node + k)] = 1;
  }
}

}  // namespace

MatrixXd stiffness_errors(const Mesh& mesh, const std::vector<scene::Material>& materials,
                          const Eigen::Ref<const MatrixXd>& shape, const Eigen::VectorXd& lambda,
                          const parallel::Progress& progress) {
  const Index c = mesh.components(), modes = shape.cols();
  FinerNodes nodes;
  std::vector<EnrichedBlock> blocks;
  blocks.reserve(mesh.blocks.size());
  for (const Block& block : mesh.blocks)
    if (block.size() > 0) number_nodes(mesh, blocks.emplace_back(mesh, block), nodes);
  const std::vector<Material> laws = materials_of(materials, mesh.dim);
  const auto for_each_element = [&](const auto& visit) {
    for (EnrichedBlock& of : blocks)
      for (std::size_t e = 0; e < of.block->size(); ++e) {
        of.points.move_to(of.nodes(e));
        visit(of, e, laws[static_cast<std::size_t>(of.block->label[e])]);
      }
  };

  std::vector<Eigen::Matrix3d> diagonal(static_cast<std::size_t>(nodes.size()), Eigen::Matrix3d::Zero());
  std::vector<char> fixed(static_cast<std::size_t>(c * nodes.size()), 0);
  for_each_element([&](EnrichedBlock& of, std::size_t e, const Material& material) {
    add_diagonal(mesh, of, e, material, diagonal, fixed);
  });
  std::vector<Eigen::Matrix3d> root;
  for (const Eigen::Matrix3d& block : diagonal) root.emplace_back(block.inverse().llt().matrixL());

  const mesh::Halo halo(mesh);
  MatrixXd out = MatrixXd::Zero(modes, modes);
  const Index at_once =
      std::clamp(most_numbers / std::max<Index>(c * nodes.size(), 1), fewest_at_once, most_at_once);
  for (Index from = 0; from < modes; from += at_once) {
    if (progress) progress(from, modes);
    const Index n = std::min(at_once, modes - from);
    const MatrixXd local = halo(shape.middleCols(from, n));
    MatrixXd residual = MatrixXd::Zero(c * nodes.size(), n);
    for_each_element([&](EnrichedBlock& of, std::size_t e, const Material& material) {
      of.products.compute(of.points, material, of.K);
      const Index low = of.points.shapes().size();
      const MatrixXd M = material.density * (of.next.surplus().value.transpose() *
                                             of.points.measure().asDiagonal() * of.points.shapes().value);
      MatrixXd u(c * low, n), accelerated(low, c * n);  // λ φ, whose components are columns of their own
      for (Index b = 0; b < low; ++b) u.middleRows(c * b, c) = local.middleRows(c * of.nodes(e)[b], c);
      for (Index m = 0; m < n; ++m)
        for (Index k = 0; k < c; ++k)
          accelerated.col(c * m + k) = lambda[from + m] * u.col(m)(Eigen::seqN(k, low, c));
      MatrixXd r(c * of.next.nodes(), n), inertia(of.next.nodes(), c * n);
      r.noalias() = of.K * u;
      inertia.noalias() = M * accelerated;
      for (Index m = 0; m < n; ++m)
        for (Index k = 0; k < c; ++k) r.col(m)(Eigen::seqN(k, inertia.rows(), c)) -= inertia.col(c * m + k);
      for (Index a = 0; a < of.next.nodes(); ++a) {
        const Index node =
            of.node[e * static_cast<std::size_t>(of.next.nodes()) + static_cast<std::size_t>(a)];
        if (node >= 0) residual.middleRows(c * node, c) += r.middleRows(c * a, c);
      }
    });
    for (Index row = 0; row < residual.rows(); ++row)
      if (fixed[static_cast<std::size_t>(row)] != 0) residual.row(row).setZero();
    // D⁻¹ = L Lᵀ, so that the products are those of Lᵀ r.
    for (Index a = 0; a < nodes.size(); ++a)
      residual.middleRows(c * a, c) =
          root[static_cast<std::size_t>(a)].topLeftCorner(c, c).transpose() * residual.middleRows(c * a, c);
    out.block(from, from, n, n).selfadjointView<Eigen::Lower>().rankUpdate(residual.transpose());
  }
  out.triangularView<Eigen::StrictlyUpper>() = out.transpose();
  parallel::sum(mesh.comm, out);
  return (c == 1 ? 1 : of_compact_elements) * out;
}

}  // namespace ricochet::elasticity
