// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/local_problem.hpp"

#include <algorithm>
#include <set>

#include "src/elasticity/enriched.hpp"
#include "src/mesh/halo.hpp"

namespace ricochet::elasticity {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using mesh::Block;
using mesh::Mesh;

using Corners = std::vector<std::int64_t>;  ///< global numbers, ascending

/// The elements around a patch, complete on the first rank.
struct Neighbourhood {
  Mesh mesh;
  VectorXd solution, inertia;    ///< at the nodes of `mesh`
  std::vector<Corners> outside;  ///< elements that share a corner with these
};

/// All that is known of the elements of a rank.
class Elements {
 public:
  Elements(const Mesh& mesh, const VectorXd& solution, const VectorXd& inertia)
      : mesh_(mesh), solution_(solution), inertia_(inertia) {
    for (const Block& block : mesh.blocks) reference_.push_back(mesh::reference_element(block.gmsh_type));
  }

  /// Calls visit(block, element) for each own element.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b)
      for (std::size_t e = 0; e < mesh_.blocks[b].size(); ++e)
        if (mesh_.own[b][e] != 0) visit(b, e);
  }

  std::int64_t node(std::size_t b, std::size_t e, int a) const {
    const Block& block = mesh_.blocks[b];
    return block.node[e * static_cast<std::size_t>(block.nodes_per_element) + static_cast<std::size_t>(a)];
  }

  Corners corners(std::size_t b, std::size_t e) const {
    Corners out;
    for (int a = 0; a < reference_[b].corners; ++a)
      out.push_back(mesh_.node[static_cast<std::size_t>(node(b, e, a))]);
    std::ranges::sort(out);
    return out;
  }

  bool has_face(std::size_t b, std::size_t e, const std::set<Corners>& faces) const {
    for (const std::vector<int>& face : mesh::outward_faces(reference_[b].family)) {
      Corners corners;
      for (const int a : face) corners.push_back(mesh_.node[static_cast<std::size_t>(node(b, e, a))]);
      std::ranges::sort(corners);
      if (faces.contains(corners)) return true;
    }
    return false;
  }

  /// Appends an element to what is sent to the first rank.
  void describe(std::size_t b, std::size_t e, std::vector<std::int64_t>& numbers,
                std::vector<double>& values) const {
    const Block& block = mesh_.blocks[b];
    numbers.insert(numbers.end(), {block.gmsh_type, block.nodes_per_element, block.label[e]});
    const Index c = mesh_.components();
    for (int a = 0; a < block.nodes_per_element; ++a) {
      const auto at = static_cast<std::size_t>(node(b, e, a));
      numbers.insert(numbers.end(), {mesh_.node[at], mesh_.fixed[at]});
      for (std::size_t k = 0; k < 3; ++k) values.push_back(mesh_.position[3 * at + k]);
      for (Index k = 0; k < c; ++k) values.push_back(solution_[c * static_cast<Index>(at) + k]);
      for (Index k = 0; k < c; ++k) values.push_back(inertia_[c * static_cast<Index>(at) + k]);
    }
  }

 private:
  const Mesh& mesh_;
  const VectorXd &solution_, &inertia_;
  std::vector<mesh::ReferenceElement> reference_;
};

/// A set of numbers of all ranks, on every rank. Collective.
Corners joined(MPI_Comm comm, Corners mine) {
  mesh::sort_once(mine);
  Corners all = parallel::gather(comm, mine);
  parallel::broadcast(comm, all);
  mesh::sort_once(all);
  return all;
}

bool touches(const Corners& element, const Corners& corners) {
  return std::ranges::any_of(element, [&](auto c) { return std::ranges::binary_search(corners, c); });
}

/// Builds the mesh from what all ranks describe.
void assemble_part(const Mesh& whole, const std::vector<std::int64_t>& numbers,
                   const std::vector<double>& values, Neighbourhood& out) {
  Mesh& part = out.mesh;
  part.dim = whole.dim;
  part.order = whole.order;
  part.axis = whole.axis;
  const auto for_each_node = [&](const auto& element, const auto& visit) {
    std::size_t v = 0;
    const auto width = static_cast<std::size_t>(3 + 2 * whole.components());
    for (std::size_t k = 0; k < numbers.size();) {
      const auto n = static_cast<std::size_t>(numbers[k + 1]);
      element(static_cast<int>(numbers[k]), static_cast<int>(n), numbers[k + 2]);
      k += 3;
      for (std::size_t a = 0; a < n; ++a, k += 2, v += width) visit(numbers[k], numbers[k + 1], &values[v]);
    }
  };
  for_each_node([](int, int, std::int64_t) {},
                [&](std::int64_t node, std::int64_t, const double*) { part.node.push_back(node); });
  mesh::sort_once(part.node);
  part.position.resize(3 * part.node.size());
  part.fixed.resize(part.node.size());
  const Index c = whole.components();
  out.solution.resize(c * std::ssize(part.node));
  out.inertia.resize(c * std::ssize(part.node));
  Block* block = nullptr;
  for_each_node(
      [&](int type, int n, std::int64_t label) {
        auto known = std::ranges::find(part.blocks, type, &Block::gmsh_type);
        if (known == part.blocks.end()) known = part.blocks.insert(known, Block{type, n, {}, {}, {}});
        block = &*known;
        block->tag.push_back(0);
        block->label.push_back(label);
      },
      [&](std::int64_t node, std::int64_t fixed, const double* value) {
        const auto at =
            static_cast<std::size_t>(std::ranges::lower_bound(part.node, node) - part.node.begin());
        block->node.push_back(static_cast<std::int64_t>(at));
        part.fixed[at] = fixed;
        std::copy(value, value + 3, &part.position[3 * at]);
        out.solution.segment(c * static_cast<Index>(at), c) = Eigen::Map<const VectorXd>(value + 3, c);
        out.inertia.segment(c * static_cast<Index>(at), c) = Eigen::Map<const VectorXd>(value + 3 + c, c);
      });
}

/// The elements with a pressed facet, and all that share a corner with them. Collective; complete on the
/// first rank.
Neighbourhood neighbourhood(const Mesh& mesh, const PatchLoad& load, const VectorXd& solution,
                            const VectorXd& inertia) {
  const Elements elements(mesh, solution, inertia);
  const std::set<Corners> pressed(load.facet.begin(), load.facet.end());
  Corners inner;
  elements.for_each([&](std::size_t b, std::size_t e) {
    if (!elements.has_face(b, e, pressed)) return;
    const Corners own = elements.corners(b, e);
    inner.insert(inner.end(), own.begin(), own.end());
  });
  inner = joined(mesh.comm, std::move(inner));
  Corners edge;
  std::vector<std::int64_t> numbers, beyond;
  std::vector<double> values;
  elements.for_each([&](std::size_t b, std::size_t e) {
    const Corners own = elements.corners(b, e);
    if (!touches(own, inner)) return;
    edge.insert(edge.end(), own.begin(), own.end());
    elements.describe(b, e, numbers, values);
  });
  edge = joined(mesh.comm, std::move(edge));
  elements.for_each([&](std::size_t b, std::size_t e) {
    const Corners own = elements.corners(b, e);
    if (touches(own, inner) || !touches(own, edge)) return;
    beyond.push_back(std::ssize(own));
    beyond.insert(beyond.end(), own.begin(), own.end());
  });
  numbers = parallel::gather(mesh.comm, numbers);
  values = parallel::gather(mesh.comm, values);
  beyond = parallel::gather(mesh.comm, beyond);
  Neighbourhood out;
  if (parallel::rank_of(mesh.comm) != 0) return out;
  assemble_part(mesh, numbers, values, out);
  for (std::size_t k = 0; k < beyond.size(); k += static_cast<std::size_t>(beyond[k]) + 1)
    out.outside.emplace_back(beyond.begin() + static_cast<std::ptrdiff_t>(k + 1),
                             beyond.begin() + static_cast<std::ptrdiff_t>(k + 1) + beyond[k]);
  return out;
}

/// K' e = r on the elements around a patch, with e = 0 on their common boundary with others. Solids only.
class LocalProblem {
 public:
  /// @param raise  1 or 2
  LocalProblem(const Neighbourhood& part, const std::vector<Material>& materials, const PatchLoad& load,
               int raise) {
    for (const Block& block : part.mesh.blocks) add(part, block, materials, raise);
    residual_.conservativeResize(3 * std::ssize(number_));
    for (Eigen::Matrix3d& block : inverse_) block = block.inverse().eval();
    const Eigen::Map<const Eigen::Vector3d> force(load.force.data());
    for (const auto& [key, share] : load.share[static_cast<std::size_t>(raise - 1)])
      if (const auto node = number_.find(key); node != number_.end())
        residual_.segment<3>(3 * node->second) += share * force;
    free_ = VectorXd::Ones(residual_.size());
    clamp(part.outside);
    for (const Index row : fixed_) free_[row] = 0;
    residual_ = residual_.cwiseProduct(free_);
  }

  /// eᵀ r by conjugate gradients, which approach it from below.
  double gain() const {
    VectorXd r = residual_, z = preconditioned(r), d = z;
    double rz = r.dot(z), sum = 0, last = 0;
    for (int k = 0; k < most_iterations && rz > 0; ++k) {
      const VectorXd q = product(d);
      const double step = rz / d.dot(q), added = step * rz;
      sum += added;
      if (added + last < enough * sum) break;
      last = added;
      r -= step * q;
      z = preconditioned(r);
      const double next = r.dot(z);
      d = z + next / rz * d;
      rz = next;
    }
    return sum;
  }

 private:
  static constexpr int most_iterations = 300;
  static constexpr double enough = 1e-3;  ///< share of the gain that two iterations add

  struct Element {
    std::vector<Index> node;
    MatrixXd K;
  };

  Index number_of(const mesh::NodeKey& key) {
    const auto [known, is_new] = number_.try_emplace(key, std::ssize(number_));
    if (is_new) {
      inverse_.push_back(Eigen::Matrix3d::Zero());
      if (residual_.size() < 3 * std::ssize(number_))
        residual_.conservativeResizeLike(VectorXd::Zero(6 * std::ssize(number_)));
    }
    return known->second;
  }

  void add(const Neighbourhood& part, const Block& block, const std::vector<Material>& materials, int raise) {
    const Mesh& mesh = part.mesh;
    // Straight elements: ∫ of products of gradients of order p + q, and of a function of this order with one
    // of order p.
    const int order = mesh::reference_element(block.gmsh_type).order;
    ElementPoints points(mesh, block, 2 * (order + raise) - 1);
    const Enriched high(points, raise);
    const int low_nodes = block.nodes_per_element, corners = points.reference().corners;
    ElementMatrix gradient, K;
    StiffnessIntegral integral;
    Corners corner(static_cast<std::size_t>(corners));
    for (std::size_t e = 0; e < block.size(); ++e) {
      const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(low_nodes)];
      points.move_to(nodes);
      const Material& material = materials[static_cast<std::size_t>(block.label[e])];
      points.gradients(high.shapes(), gradient);
      integral.compute(points, material, gradient, gradient, K);
      for (int k = 0; k < corners; ++k) corner[static_cast<std::size_t>(k)] = mesh.node[nodes[k]];
      Element element{{}, K};
      VectorXd raised = VectorXd::Zero(3 * high.nodes());
      for (int a = 0; a < high.nodes(); ++a) {
        element.node.push_back(number_of(high.keys().of(a, corner.data())));
        inverse_[static_cast<std::size_t>(element.node.back())] += K.block<3, 3>(3 * a, 3 * a);
        for (int b = 0; b < low_nodes; ++b)
          raised.segment<3>(3 * a) += high.prolongation()(a, b) * part.solution.segment<3>(3 * nodes[b]);
        for (int k = 0; k < 3; ++k)
          if (high.all_around(a, [&](int b) { return mesh.is_fixed(static_cast<std::size_t>(nodes[b]), k); }))
            fixed_.push_back(3 * element.node.back() + k);
      }
      VectorXd force = -(element.K * raised);
      for (Index q = 0; q < points.measure().size(); ++q) {
        Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
        for (int b = 0; b < low_nodes; ++b)
          acceleration += points.shapes().value(q, b) * part.inertia.segment<3>(3 * nodes[b]);
        acceleration *= material.density * points.measure()[q];
        for (int a = 0; a < high.nodes(); ++a)
          force.segment<3>(3 * a) -= high.shapes().value(q, a) * acceleration;
      }
      for (int a = 0; a < high.nodes(); ++a)
        residual_.segment<3>(3 * element.node[static_cast<std::size_t>(a)]) += force.segment<3>(3 * a);
      elements_.push_back(std::move(element));
    }
  }

  /// Fixes the nodes that elements outside share.
  void clamp(const std::vector<Corners>& outside) {
    std::map<std::int64_t, std::vector<const Corners*>> around;
    for (const Corners& element : outside)
      for (const std::int64_t corner : element) around[corner].push_back(&element);
    for (const auto& [key, node] : number_) {
      const auto found = around.find(key.corner[0]);
      if (found == around.end()) continue;
      const auto end = std::ranges::find(key.corner, -1);
      const bool shared = std::ranges::any_of(found->second, [&](const Corners* element) {
        return std::all_of(key.corner.begin(), end,
                           [&](std::int64_t c) { return std::ranges::binary_search(*element, c); });
      });
      for (Index k = 0; shared && k < 3; ++k) fixed_.push_back(3 * node + k);
    }
  }

  VectorXd preconditioned(const VectorXd& r) const {
    VectorXd z(r.size());
    for (Index a = 0; a < std::ssize(inverse_); ++a)
      z.segment<3>(3 * a) = inverse_[static_cast<std::size_t>(a)] * r.segment<3>(3 * a);
    return z.cwiseProduct(free_);
  }

  VectorXd product(const VectorXd& d) const {
    VectorXd out = VectorXd::Zero(d.size());
    VectorXd local, forces;
    for (const Element& element : elements_) {
      local.resize(element.K.rows());
      for (std::size_t a = 0; a < element.node.size(); ++a)
        local.segment<3>(3 * static_cast<Index>(a)) = d.segment<3>(3 * element.node[a]);
      forces.noalias() = element.K * local;
      for (std::size_t a = 0; a < element.node.size(); ++a)
        out.segment<3>(3 * element.node[a]) += forces.segment<3>(3 * static_cast<Index>(a));
    }
    return out.cwiseProduct(free_);
  }

  std::map<mesh::NodeKey, Index> number_;
  std::vector<Element> elements_;
  std::vector<Eigen::Matrix3d> inverse_;  ///< of the block of each node
  std::vector<Index> fixed_;
  VectorXd residual_, free_;  ///< by row
};

}  // namespace

double work_of_growth(const Mesh& mesh, const std::vector<scene::Material>& materials, const PatchLoad& load,
                      const Eigen::Ref<const VectorXd>& solution, const Eigen::Ref<const VectorXd>& inertia) {
  constexpr double slowest = 0.8;
  const mesh::Halo halo(mesh);
  const Neighbourhood part = neighbourhood(mesh, load, halo(solution), halo(inertia));
  double out = 0;
  if (parallel::rank_of(mesh.comm) == 0) {
    const std::vector<Material> laws = materials_of(materials, mesh.dim);
    const double once = LocalProblem(part, laws, load, 1).gain(),
                 twice = LocalProblem(part, laws, load, 2).gain();
    const double ratio = once > 0 ? std::clamp((twice - once) / once, 0.0, slowest) : 0;
    out = once + std::max(twice - once, 0.0) / (1 - ratio);
  }
  return parallel::of_rank(mesh.comm, 0, out);
}

}  // namespace ricochet::elasticity
