// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/enriched.hpp"

namespace ricochet::elasticity {

Enriched::Enriched(const ElementPoints& points, int raise)
    : high_(mesh::reference_element(
          mesh::type_of(points.reference().family, points.reference().order + raise))),
      keys_(high_) {
  const mesh::ReferenceElement& low = points.reference();
  shapes_ = functions_of(mesh::basis_at(high_, points.local()));
  prolongation_ = functions_of(mesh::basis_at(low, mesh::local_nodes(high_))).value;
  const Eigen::MatrixXd interpolation =
      functions_of(mesh::basis_at(high_, mesh::local_nodes(low))).value;  // (n, m)
  surplus_ = shapes_;
  surplus_.value -= points.shapes().value * interpolation;
  const Eigen::Index q = shapes_.value.rows(), m = shapes_.size(), n = points.shapes().size();
  for (Eigen::Index k = 0; k < q; ++k) {
    Eigen::Map<ElementMatrix> of_high(&surplus_.gradient[static_cast<std::size_t>(3 * k * m)], m, 3);
    const Eigen::Map<const ElementMatrix> of_low(
        &points.shapes().gradient[static_cast<std::size_t>(3 * k * n)], n, 3);
    of_high -= interpolation.transpose() * of_low;
  }
  const Eigen::MatrixXi &weight = keys_.weights(), low_weight = mesh::NodeKeys(low).weights();
  around_.resize(static_cast<std::size_t>(m));
  for (Eigen::Index a = 0; a < m; ++a)
    for (int b = 0; b < low.nodes; ++b) {
      bool within = true;
      for (Eigen::Index c = 0; c < weight.cols(); ++c)
        within = within && (low_weight(b, c) == 0 || weight(a, c) != 0);
      if (within) around_[static_cast<std::size_t>(a)].push_back(b);
    }
}

}  // namespace ricochet::elasticity
