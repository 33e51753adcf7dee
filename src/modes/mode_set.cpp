// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/certify.hpp"

namespace ricochet::modes {

void ModeSet::store(const parallel::Teams& teams, const Operators& operators, Eigen::Index first,
                    const Eigen::MatrixXd& vectors) {
  const Eigen::Index r = operators.rigid.cols(), rigid = teams.mine() == 0 ? r : 0;
  shape.resize(vectors.rows(), rigid + vectors.cols());
  shape.leftCols(rigid) = operators.rigid.leftCols(rigid);
  shape.rightCols(vectors.cols()) = vectors;
  for (Eigen::Index j = 0; j < rigid; ++j) index.push_back(j);
  for (Eigen::Index j = 0; j < vectors.cols(); ++j) index.push_back(r + first + j);
  fix_signs(operators, shape);
}

Eigen::MatrixXd ModeSet::gather(const parallel::Teams& teams, const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all =
      Eigen::MatrixXd::Zero(mine.rows(), static_cast<Eigen::Index>(angular_frequency.size()));
  for (std::size_t j = 0; j < index.size(); ++j) all.col(index[j]) = mine.col(static_cast<Eigen::Index>(j));
  parallel::sum(teams.peers(), all);
  return all;
}

}  // namespace ricochet::modes
