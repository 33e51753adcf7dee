// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/order_reduction.hpp"

#include <algorithm>
#include <map>

#include "src/mesh/directory.hpp"

namespace ricochet::mesh {

namespace {

using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the shape functions of `element` at the nodes of `at`, (nodes of `at`, nodes of `element`).
Table functions_at(const ReferenceElement& element, const ReferenceElement& at) {
  std::vector<double> local(static_cast<std::size_t>(3 * at.nodes), 0.0);
  for (int a = 0; a < at.nodes; ++a)
    for (int d = 0; d < at.dim; ++d)
      local[static_cast<std::size_t>(3 * a + d)] = at.node[static_cast<std::size_t>(a * at.dim + d)];
  const Basis basis = basis_at(element, local);
  return Eigen::Map<const Table>(basis.value.data(), basis.points, basis.nodes);
}

/// One element type in both orders.
struct Pair {
  /// A corner, or the interior of an edge, face or element: the corners that span it, and the nodes in it.
  struct Inside {
    std::vector<int> corner, high, low;
  };

  explicit Pair(int gmsh_type) : high(reference_element(gmsh_type)) {
    low = reference_element(type_of(high.family, high.order - 1));
    const ReferenceElement linear = reference_element(type_of(high.family, 1));
    corner_at_low = functions_at(linear, low);
    high_at_low = functions_at(high, low);
    low_at_high = functions_at(low, high);
    std::map<std::vector<int>, Inside> inside;
    const auto sort_in = [&](const Table& corner_at, std::vector<int> Inside::*list) {
      for (int a = 0; a < corner_at.rows(); ++a) {
        std::vector<int> span;
        for (int k = 0; k < corner_at.cols(); ++k)
          if (std::abs(corner_at(a, k)) > 1e-9) span.push_back(k);
        (inside[span].*list).push_back(a);
      }
    };
    sort_in(functions_at(linear, high), &Inside::high);
    sort_in(corner_at_low, &Inside::low);
    for (auto& [corners, part] : inside)
      if (!part.low.empty()) parts.push_back({corners, part.high, part.low});
  }

  ReferenceElement high, low;
  Table corner_at_low, high_at_low, low_at_high;
  std::vector<Inside> parts;
};

/// Matches each node of the lower order with a node of the element. Both are sorted in an order on which all
/// elements around an edge or a face agree.
void match(const Pair& pair, const Mesh& mesh, const std::int64_t* nodes, std::vector<std::int64_t>& taken) {
  const auto canonical = [&](int a) { return mesh.canonical[static_cast<std::size_t>(nodes[a])]; };
  const auto by_number = [&](int a, int b) { return canonical(a) < canonical(b); };
  for (const Pair::Inside& part : pair.parts) {
    std::vector<int> high = part.high, low = part.low, corner = part.corner;
    if (low.size() > 1) {
      std::sort(corner.begin(), corner.end(), by_number);
      std::sort(low.begin(), low.end(), [&](int a, int b) {
        for (int k : corner) {
          const double difference = pair.corner_at_low(a, k) - pair.corner_at_low(b, k);
          if (std::abs(difference) > 1e-9) return difference > 0;
        }
        return false;
      });
    }
    std::sort(high.begin(), high.end(), by_number);
    for (std::size_t k = 0; k < low.size(); ++k) taken[static_cast<std::size_t>(low[k])] = nodes[high[k]];
  }
}

}  // namespace

OrderReduction::OrderReduction(const Mesh& mesh) : weights_(static_cast<std::size_t>(mesh.owned_nodes)) {
  mesh_.comm = mesh.comm;
  mesh_.dim = mesh.dim;
  mesh_.order = mesh.order - 1;
  mesh_.axis = mesh.axis;
  mesh_.total_elements = mesh.total_elements;
  mesh_.parts = mesh.parts;
  mesh_.own = mesh.own;

  // Nodes of the lower order, identified by local nodes of the higher one, and their positions.
  std::vector<std::int64_t> taken;
  std::vector<double> position(mesh.position.size());
  for (const Block& block : mesh.blocks) {
    const Pair pair(block.gmsh_type);
    const auto width = static_cast<std::size_t>(block.nodes_per_element);
    Block low{pair.low.gmsh_type, pair.low.nodes, {}, block.tag, block.label};
    std::vector<std::int64_t> here(static_cast<std::size_t>(pair.low.nodes));
    for (std::size_t e = 0; e < block.size(); ++e) {
      const std::int64_t* nodes = &block.node[e * width];
      match(pair, mesh, nodes, here);
      low.node.insert(low.node.end(), here.begin(), here.end());
      for (int a = 0; a < pair.low.nodes; ++a)
        for (std::size_t k = 0; k < 3; ++k) {
          double x = 0;
          for (int b = 0; b < pair.high.nodes; ++b)
            x += pair.high_at_low(a, b) * mesh.position[3 * static_cast<std::size_t>(nodes[b]) + k];
          position[3 * static_cast<std::size_t>(here[static_cast<std::size_t>(a)]) + k] = x;
        }
      for (int b = 0; b < pair.high.nodes; ++b) {
        const std::int64_t row = mesh.owned(mesh.node[static_cast<std::size_t>(nodes[b])]);
        if (row < 0 || !weights_[static_cast<std::size_t>(row)].empty()) continue;
        for (int a = 0; a < pair.low.nodes; ++a)
          if (std::abs(pair.low_at_high(b, a)) > 1e-12)
            weights_[static_cast<std::size_t>(row)].emplace_back(here[static_cast<std::size_t>(a)],
                                                                 pair.low_at_high(b, a));
      }
    }
    taken.insert(taken.end(), low.node.begin(), low.node.end());
    mesh_.blocks.push_back(std::move(low));
  }
  sort_once(taken);
  number(mesh, taken);

  // Converts local numbers of the higher order to local numbers of the lower order.
  const auto local = [&](std::int64_t node) {
    return std::lower_bound(taken.begin(), taken.end(), node) - taken.begin();
  };
  for (Block& block : mesh_.blocks)
    for (std::int64_t& node : block.node) node = local(node);
  for (const std::int64_t node : taken)
    mesh_.position.insert(mesh_.position.end(), &position[3 * static_cast<std::size_t>(node)],
                          &position[3 * static_cast<std::size_t>(node)] + 3);
  for (auto& list : weights_)
    for (auto& [node, weight] : list) node = local(node);
  const int c = mesh.components();
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) held_.push_back(row * c + k);
  });
  prepare_exchange();
}

void OrderReduction::number(const Mesh& mesh, const std::vector<std::int64_t>& taken) {
  // Local nodes are in the order of their global numbers, and so are the chosen ones.
  std::vector<std::int64_t> tags, numbers;
  for (const std::int64_t node : taken) {
    const auto i = static_cast<std::size_t>(node);
    tags.push_back(mesh.canonical[i]);
    mesh_.fixed.push_back(mesh.fixed[i]);
    mesh_.part.push_back(mesh.part[i]);
    numbers.push_back(mesh.owned(mesh.node[i]) >= 0 ? mesh_.owned_nodes++ : -1);
  }
  mesh_.first_node = parallel::sum_before(mesh.comm, mesh_.owned_nodes);
  for (std::int64_t& number : numbers)
    if (number >= 0) number += mesh_.first_node;
  mesh_.total_nodes = parallel::sum(mesh.comm, mesh_.owned_nodes);
  const Directory directory(mesh.comm, tags);
  mesh_.canonical = directory.order();
  mesh_.node = directory.combined(numbers, [](auto a, auto b) { return std::max(a, b); });
}

void OrderReduction::prepare_exchange() {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(mesh_.comm));
  std::vector<std::int64_t> first(ranks);
  MPI_Allgather(&mesh_.first_node, 1, MPI_INT64_T, first.data(), 1, MPI_INT64_T, mesh_.comm);
  ghost_.resize(ranks);
  std::vector<std::vector<std::int64_t>> number(ranks);
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    const std::int64_t node = mesh_.node[i];
    if (mesh_.owned(node) >= 0) continue;
    const auto owner =
        static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), node) - first.begin()) - 1;
    ghost_[owner].push_back(static_cast<std::int64_t>(i));
    number[owner].push_back(node);
  }
  asked_ = parallel::exchange(mesh_.comm, number);
  for (auto& list : asked_)
    for (std::int64_t& node : list) node -= mesh_.first_node;
}

Eigen::MatrixXd OrderReduction::prolong(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  const Eigen::Index c = mesh_.components(), n = columns.cols();
  // Values at all local nodes, including those fetched from other ranks.
  std::vector<std::vector<double>> answers(asked_.size());
  for (std::size_t r = 0; r < asked_.size(); ++r)
    for (const std::int64_t row : asked_[r])
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index k = 0; k < c; ++k) answers[r].push_back(columns(row * c + k, j));
  const std::vector<std::vector<double>> received = parallel::exchange(mesh_.comm, answers);
  Eigen::MatrixXd all(static_cast<Eigen::Index>(mesh_.node.size()) * c, n);
  mesh_.for_each_owned([&](std::size_t i, std::int64_t row) {
    all.middleRows(static_cast<Eigen::Index>(i) * c, c) = columns.middleRows(row * c, c);
  });
  for (std::size_t r = 0; r < ghost_.size(); ++r)
    for (std::size_t g = 0; g < ghost_[r].size(); ++g)
      all.middleRows(ghost_[r][g] * c, c) =
          Eigen::Map<const Eigen::MatrixXd>(&received[r][g * static_cast<std::size_t>(n * c)], c, n);

  Eigen::MatrixXd raised = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(weights_.size()) * c, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (std::size_t row = 0; row < weights_.size(); ++row)
      for (const auto& [node, weight] : weights_[row])
        for (Eigen::Index k = 0; k < c; ++k)
          raised(static_cast<Eigen::Index>(row) * c + k, j) += weight * all(node * c + k, j);
  for (const std::int64_t row : held_) raised.row(row).setZero();
  return raised;
}

}  // namespace ricochet::mesh
