#include <algorithm>

#include "src/mesh/lattice.hpp"
#include "src/surface/surface.hpp"

namespace ricochet::surface {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<double> flat(const Eigen::MatrixXd& matrix) {
  std::vector<double> values(static_cast<std::size_t>(matrix.size()));
  Eigen::Map<RowMajor>(values.data(), matrix.rows(), matrix.cols()) = matrix;
  return values;
}

/// Share of a displacement component of the mesh in the kernel's component k.
double component(const mesh::Mesh& mesh, const kernels::Surface& surface, int mesh_component, int k) {
  const Vector3 out = surface.components == 3
                          ? Vector3{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}
                          : *surface.direction;
  if (mesh.dim == 3) return out[static_cast<std::size_t>(mesh_component)];
  return out[0] * mesh.axis[0] + out[1] * mesh.axis[1] + out[2] * mesh.axis[2];
}

/// Modes at the skin's nodes, gathered on the first rank one mode at a time: (V,3,N).
void gather_view(const parallel::Teams& teams, const mesh::Mesh& mesh, const modes::ModeSet& modes,
                 kernels::Kernel& kernel) {
  const auto c = static_cast<std::size_t>(mesh.components());
  const std::size_t count = modes.angular_frequency.size();
  std::vector<std::int64_t> nodes = mesh.skin.node;
  parallel::broadcast(mesh.comm, nodes);
  const bool first = parallel::rank_of(teams.world()) == 0;
  kernels::View view;
  if (first) {
    view.node = mesh.skin.position;
    view.element_corners = mesh.skin.blocks.front().nodes_per_element;
    view.element = mesh.skin.blocks.front().node;
    view.shape.assign(nodes.size() * 3 * count, 0.0F);
  }
  std::vector<double> value(nodes.size() * 3), whole(value.size());
  std::size_t own = 0;
  for (std::size_t n = 0; n < count; ++n) {
    std::fill(value.begin(), value.end(), 0.0);
    if (own < modes.index.size() && modes.index[own] == static_cast<Eigen::Index>(n)) {
      const auto shape = modes.shape.col(static_cast<Eigen::Index>(own++));
      for (std::size_t v = 0; v < nodes.size(); ++v) {
        const std::int64_t row = nodes[v] - mesh.first_node;
        if (row < 0 || row >= mesh.owned_nodes) continue;
        for (std::size_t d = 0; d < 3; ++d)
          value[3 * v + d] =
              c == 3 ? shape[row * 3 + static_cast<Eigen::Index>(d)] : shape[row] * mesh.axis[d];
      }
    }
    MPI_Reduce(value.data(), whole.data(), static_cast<int>(value.size()), MPI_DOUBLE, MPI_SUM, 0,
               teams.world());
    if (first)
      for (std::size_t k = 0; k < whole.size(); ++k) view.shape[k * count + n] = static_cast<float>(whole[k]);
  }
  if (first) kernel.view = std::move(view);
}

}  // namespace

Eigen::MatrixXd patch_loads(const mesh::Mesh& mesh, const Patches& patches) {
  const int c = mesh.components(), out = patches.geometry.components;
  Eigen::MatrixXd loads =
      Eigen::MatrixXd::Zero(mesh.owned_nodes * c, static_cast<Eigen::Index>(patches.geometry.size()) * out);
  for (const Weight& weight : patches.weights) {
    const std::int64_t row = weight.node - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    const auto local = static_cast<std::size_t>(
        std::lower_bound(mesh.node.begin(), mesh.node.end(), weight.node) - mesh.node.begin());
    for (int d = 0; d < c; ++d) {
      if (mesh.is_fixed(local, d)) continue;
      for (int k = 0; k < out; ++k)
        loads(row * c + d, weight.candidate * out + k) +=
            weight.value * component(mesh, patches.geometry, d, k);
    }
  }
  return loads;
}

void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           const Eigen::MatrixXd& loads, bool residual, bool view, kernels::Kernel& kernel) {
  kernel.surface = patches.geometry;
  const auto seen_by_modes = [&](const Eigen::MatrixXd& load) {
    return modes.gather(teams, modes::inner(mesh.comm, load, modes.shape));
  };
  kernel.surface.shape = flat(seen_by_modes(loads));
  const Eigen::MatrixXd participation = seen_by_modes(body.rigid_load);
  kernel.loads.body_force = flat(participation.topRows(3));
  kernel.loads.rotation = flat(participation.bottomRows(3));
  if (residual) {
    Eigen::MatrixXd all(loads.rows(), loads.cols() + 3);
    all << loads, body.rigid_load.leftCols(3);
    const Eigen::MatrixXd response =
        modes::residual_response(teams, mesh, body, factor, modes, all, loads.cols());
    const Eigen::MatrixXd square = response.leftCols(loads.cols());
    kernel.surface.residual_flexibility = flat((square + square.transpose()) / 2);
    kernel.loads.body_force_residual = flat(response.rightCols(3));
  }
  if (view) gather_view(teams, mesh, modes, kernel);
}

}  // namespace ricochet::surface
