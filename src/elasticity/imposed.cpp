// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/imposed.hpp"

namespace ricochet::elasticity {

Imposing::Imposing(const mesh::Mesh& mesh, const std::vector<std::string>& moved)
    : mesh_(mesh), moved_(moved) {
  const int c = mesh.components();
  const auto columns = static_cast<Eigen::Index>(3 * moved.size());
  sum_.shape = Eigen::MatrixXd::Zero(mesh.owned_nodes * c, columns);
  sum_.force = sum_.inertia = sum_.shape;
  sum_.momentum = Eigen::MatrixXd::Zero(3, columns);
  if (moved.empty()) return;
  mesh.for_each_owned([&](std::size_t i, std::int64_t own) {
    for (int k = 0; k < c; ++k) sum_.shape.row(own * c + k) = row(i, k);
  });
}

Eigen::RowVectorXd Imposing::row(std::size_t local_node, int component) const {
  Eigen::RowVectorXd values = Eigen::RowVectorXd::Zero(sum_.momentum.cols());
  if (!mesh_.is_fixed(local_node, component)) return values;
  for (std::size_t s = 0; s < moved_.size(); ++s) {
    if (!mesh_.is_moved(local_node, s)) continue;
    for (const char axis : moved_[s]) {
      const int k = axis - 'x';
      if (mesh_.dim == 3 && k != component) continue;
      values[static_cast<Eigen::Index>(3 * s) + k] =
          mesh_.dim == 3 ? 1 : mesh_.axis[static_cast<std::size_t>(k)];
    }
    // A node that belongs to several supports moves only with the first.
    if (!values.isZero(0)) break;
  }
  return values;
}

void Imposing::add(const std::int64_t* nodes, int count, const ElementMatrix& K, const ElementMatrix& M,
                   const Eigen::MatrixXd& translation) {
  const int c = mesh_.components();
  if (moved_.empty()) return;
  Eigen::MatrixXd shape(c * count, sum_.momentum.cols());
  for (int a = 0; a < count; ++a)
    for (int k = 0; k < c; ++k) shape.row(c * a + k) = row(static_cast<std::size_t>(nodes[a]), k);
  if (shape.isZero(0)) return;
  const Eigen::MatrixXd force = K * shape, inertia = M * shape;
  for (int a = 0; a < count; ++a) {
    const auto local = static_cast<std::size_t>(nodes[a]);
    const std::int64_t own = mesh_.owned(mesh_.node[local]);
    if (own < 0) continue;
    for (int k = 0; k < c; ++k)
      if (mesh_.is_fixed(local, k)) {
        sum_.momentum += translation.row(c * a + k).leftCols(3).transpose() * shape.row(c * a + k);
      } else {
        sum_.force.row(own * c + k) -= force.row(c * a + k);
        sum_.inertia.row(own * c + k) += inertia.row(c * a + k);
      }
  }
}

Imposed Imposing::take() {
  parallel::sum(mesh_.comm, sum_.momentum);
  return std::move(sum_);
}

}  // namespace ricochet::elasticity
