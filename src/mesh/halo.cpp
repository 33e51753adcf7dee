// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/halo.hpp"

namespace ricochet::mesh {

Halo::Halo(const Mesh& mesh) : mesh_(mesh) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(mesh.comm));
  std::vector<std::int64_t> end(ranks);  // of the nodes of each rank
  const std::int64_t own_end = mesh.first_node + mesh.owned_nodes;
  MPI_Allgather(&own_end, 1, MPI_INT64_T, end.data(), 1, MPI_INT64_T, mesh.comm);
  std::vector<std::vector<std::int64_t>> needed(ranks);
  taken_.resize(ranks);
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    if (mesh.owned(mesh.node[i]) >= 0) continue;
    const auto owner = static_cast<std::size_t>(std::ranges::upper_bound(end, mesh.node[i]) - end.begin());
    needed[owner].push_back(mesh.node[i]);
    taken_[owner].push_back(i);
  }
  given_ = parallel::exchange(mesh.comm, needed);
  for (auto& of_rank : given_)
    for (std::int64_t& node : of_rank) node -= mesh.first_node;
}

Eigen::MatrixXd Halo::operator()(const Eigen::Ref<const Eigen::MatrixXd>& owned) const {
  const Eigen::Index c = mesh_.components();
  Eigen::MatrixXd out(c * std::ssize(mesh_.node), owned.cols());
  mesh_.for_each_owned([&](std::size_t local, std::int64_t row) {
    out.middleRows(c * static_cast<Eigen::Index>(local), c) = owned.middleRows(c * row, c);
  });
  const auto block = static_cast<std::size_t>(c * owned.cols());
  std::vector<std::vector<double>> to(given_.size());
  for (std::size_t rank = 0; rank < to.size(); ++rank) {
    to[rank].resize(block * given_[rank].size());
    for (std::size_t k = 0; k < given_[rank].size(); ++k)
      Eigen::Map<Eigen::MatrixXd>(&to[rank][block * k], c, owned.cols()) =
          owned.middleRows(c * given_[rank][k], c);
  }
  const auto from = parallel::exchange(mesh_.comm, to);
  for (std::size_t rank = 0; rank < from.size(); ++rank)
    for (std::size_t k = 0; k < taken_[rank].size(); ++k)
      out.middleRows(c * static_cast<Eigen::Index>(taken_[rank][k]), c) =
          Eigen::Map<const Eigen::MatrixXd>(&from[rank][block * k], c, owned.cols());
  return out;
}

}  // namespace ricochet::mesh
