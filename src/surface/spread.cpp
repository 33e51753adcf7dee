// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/spread.hpp"

#include <algorithm>

namespace ricochet::surface {

namespace {

/// Contribution of a displacement component of the mesh to component k, or to the component along a
/// direction.
double component(const mesh::Mesh& mesh, const std::optional<Vector3>& direction, int mesh_component, int k) {
  const Vector3 out = direction.value_or(Vector3{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0});
  if (mesh.dim == 3) return out[static_cast<std::size_t>(mesh_component)];
  return out[0] * mesh.axis[0] + out[1] * mesh.axis[1] + out[2] * mesh.axis[2];
}

}  // namespace

Eigen::SparseMatrix<double> spread(const mesh::Mesh& mesh, const std::vector<Weight>& weights,
                                   std::size_t places, const std::optional<Vector3>& direction,
                                   FixedRows fixed) {
  const int c = mesh.components(), out = direction ? 1 : 3;
  std::vector<Eigen::Triplet<double>> entries;
  for (const Weight& weight : weights) {
    const std::int64_t row = mesh.owned(weight.node);
    if (row < 0) continue;
    const auto local = static_cast<std::size_t>(
        std::lower_bound(mesh.node.begin(), mesh.node.end(), weight.node) - mesh.node.begin());
    for (int d = 0; d < c; ++d) {
      if (fixed == FixedRows::zero && mesh.is_fixed(local, d)) continue;
      for (int k = 0; k < out; ++k)
        if (const double share = component(mesh, direction, d, k); share != 0)
          entries.emplace_back(static_cast<int>(row) * c + d, weight.candidate * out + k,
                               weight.value * weight.by_component[static_cast<std::size_t>(k)] * share);
    }
  }
  Eigen::SparseMatrix<double> loads(mesh.owned_nodes * c, static_cast<Eigen::Index>(places) * out);
  loads.setFromTriplets(entries.begin(), entries.end());
  return loads;
}

}  // namespace ricochet::surface
