// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/trace.hpp"

#include <algorithm>
#include <numeric>

#include "kernels/compression.hpp"
#include "src/elasticity/rigid.hpp"
#include "src/reduction/residual.hpp"
#include "src/surface/gauges.hpp"

namespace ricochet::surface {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Derived>
std::vector<double> flat(const Eigen::MatrixBase<Derived>& matrix) {
  std::vector<double> values(static_cast<std::size_t>(matrix.size()));
  Eigen::Map<RowMajor>(values.data(), matrix.rows(), matrix.cols()) = matrix;
  return values;
}

/// A field on the mesh at the nodes of the visualisation surface.
class VisualisationField {
 public:
  explicit VisualisationField(const mesh::Mesh& mesh) : mesh_(mesh), node_(mesh.visualisation.node) {
    parallel::broadcast(mesh.comm, node_);
    const int c = mesh.components();
    for (std::size_t v = 0; v < node_.size(); ++v) {
      const std::int64_t local = mesh.owned(node_[v]);
      if (local < 0) continue;
      own_.push_back(v);
      for (int d = 0; d < c; ++d) rows.row.push_back(local * c + d);
    }
  }

  /// Gathers columns on the first rank of `comm`, one at a time. Returns (V,3,count), or an empty vector on
  /// other ranks. `column(j)` returns this rank's rows of a column, or std::nullopt if another team holds it.
  /// Collective.
  template <class Column>
  std::vector<float> gather(MPI_Comm comm, std::size_t count, Column&& column) const {
    const bool first = parallel::rank_of(comm) == 0;
    std::vector<float> out(first ? node_.size() * 3 * count : 0);
    std::vector<double> part(node_.size() * 3), whole(part.size());
    for (std::size_t j = 0; j < count; ++j) {
      std::ranges::fill(part, 0.0);
      if (const std::optional<Eigen::VectorXd> value = column(static_cast<Eigen::Index>(j)))
        for (std::size_t i = 0; i < own_.size(); ++i)
          for (std::size_t d = 0; d < 3; ++d)
            part[3 * own_[i] + d] = mesh_.dim == 3 ? (*value)[static_cast<Eigen::Index>(3 * i + d)]
                                                   : (*value)[static_cast<Eigen::Index>(i)] * mesh_.axis[d];
      MPI_Reduce(part.data(), whole.data(), static_cast<int>(part.size()), MPI_DOUBLE, MPI_SUM, 0, comm);
      for (std::size_t k = 0; first && k < whole.size(); ++k)
        out[k * count + j] = static_cast<float>(whole[k]);
    }
    return out;
  }

  /// Gathers columns of `rows`, which every team holds, on the first rank of the team. Collective on the
  /// team.
  std::vector<float> gather(Eigen::Index from, Eigen::Index count) const {
    return gather(mesh_.comm, static_cast<std::size_t>(count),
                  [&](Eigen::Index j) -> Eigen::VectorXd { return rows.value.col(from + j); });
  }

  reduction::Rows rows;

 private:
  const mesh::Mesh& mesh_;
  std::vector<std::int64_t> node_;
  std::vector<std::size_t> own_;  ///< indices into node_
};

/// Stores the modes on the visualisation surface in the kernel of the first rank. Collective.
void gather_view(const parallel::Teams& teams, const mesh::Mesh& mesh, const modes::ModeSet& modes,
                 kernels::Kernel& kernel) {
  const VisualisationField field(mesh);
  std::size_t own = 0;
  std::vector<float> shape = field.gather(
      teams.world(), modes.angular_frequency.size(), [&](Eigen::Index n) -> std::optional<Eigen::VectorXd> {
        if (own == modes.index.size() || modes.index[own] != n) return std::nullopt;
        return modes.shape(field.rows.row, static_cast<Eigen::Index>(own++));
      });
  if (parallel::rank_of(teams.world()) != 0) return;
  kernels::View& view = kernel.view.emplace();
  view.node = mesh.visualisation.position;
  view.element_corners = mesh.visualisation.blocks.front().nodes_per_element;
  view.element = mesh.visualisation.blocks.front().node;
  view.shape = std::move(shape);
}

}  // namespace

/// Calls act(sensitivity, first, count) for the stress and the strain of each gauge, with its rows among
/// those of all gauges.
template <class Act>
static void for_each_row(kernels::Kernel& kernel, Act&& act) {
  Eigen::Index from = 0;
  for (kernels::Gauge& gauge : kernel.gauges) {
    act(gauge.stress, from, stress_rows);
    from += stress_rows;
    if (gauge.strain) act(*gauge.strain, from++, 1);
  }
}

/// Stores the static correction of all that is not a force on a candidate.
/// @param response  responses at candidates, receivers and gauges (rows) to forces at receivers, gravity and
/// loads
static void take_other_corrections(const Eigen::Ref<const Eigen::MatrixXd>& response, Eigen::Index candidates,
                                   const Sources& sources, kernels::Kernel& kernel) {
  const Eigen::Index receivers = response.rows() - candidates, loads = sources.load.cols();
  kernel.loads.body_force_residual = flat(response.block(0, receivers, candidates, 3));
  for (std::size_t l = 0; l < kernel.applied.size(); ++l)
    kernel.applied[l].residual =
        flat(response.block(0, receivers + 3 + static_cast<Eigen::Index>(3 * l), candidates, 3));
  for (std::size_t r = 0; r < kernel.receivers.size(); ++r) {
    kernels::Receiver& receiver = kernel.receivers[r];
    const auto from = static_cast<Eigen::Index>(3 * r);
    const auto rows = response.middleRows(candidates + from, 3);
    receiver.residual_flexibility = flat(response.block(0, from, candidates, 3).transpose());
    receiver.body_force_residual = flat(rows.middleCols(receivers, 3));
    receiver.load_residual = flat(rows.rightCols(loads));
  }
  for_each_row(kernel, [&](kernels::Sensitivity& seen, Eigen::Index from, Eigen::Index count) {
    const auto unit = sources.gauge_unit.segment(from, count).asDiagonal();
    const Eigen::Index at = sources.receiver.cols() - sources.gauge_unit.size() + from;
    const Eigen::MatrixXd rows = unit * response.middleRows(candidates + at, count);
    seen.residual_flexibility = flat(unit * response.block(0, at, candidates, count).transpose());
    seen.body_force_residual = flat(rows.middleCols(receivers, 3));
    seen.load_residual = flat(rows.rightCols(loads));
  });
}

void take_corrections(const Eigen::Ref<const Eigen::MatrixXd>& response, Eigen::Index candidates,
                      const Sources& sources, kernels::Kernel& kernel) {
  const auto square = response.topLeftCorner(candidates, candidates);
  kernel.surface.residual_flexibility = flat((square + square.transpose()) / 2);
  take_other_corrections(response.rightCols(response.cols() - candidates), candidates, sources, kernel);
}

namespace {

/// Moves the traces of rigid modes from the means of the patches to x̂_i, so that the lever arm of a force is
/// that of the point from which its gap is measured. With the momentum p_n = φ_nᵀ M e and the angular
/// momentum L_n about the origin, a rigid mode turns by θ_n = J⁻¹ (L_n − c × p_n).
void move_rigid_traces(const std::vector<double>& arm, kernels::Kernel& kernel) {
  const std::size_t n = kernel.modes.size(), c = static_cast<std::size_t>(kernel.surface.components);
  const Eigen::Matrix3d inertia = Eigen::Map<const Eigen::Matrix3d>(kernel.inertia.data());
  // Parts of a body that are not joined turn separately, and rods do not turn.
  if (kernel.parts > 1 || !(inertia.determinant() > 0)) return;
  const auto three = [&](const std::vector<double>& rows, std::size_t mode) {
    return Eigen::Vector3d(rows[mode], rows[n + mode], rows[2 * n + mode]);
  };
  for (std::size_t k = 0; k < n && kernel.modes.angular_frequency[k] == 0; ++k) {
    const Eigen::Vector3d momentum = three(kernel.loads.body_force, k),
                          about = Eigen::Map<const Eigen::Vector3d>(kernel.centre.data()).cross(momentum),
                          turn = inertia.ldlt().solve(three(kernel.loads.rotation, k) - about);
    for (std::size_t i = 0; i < kernel.surface.size(); ++i) {
      const Eigen::Vector3d moved = turn.cross(Eigen::Map<const Eigen::Vector3d>(&arm[3 * i]));
      for (std::size_t d = 0; d < c; ++d)
        kernel.surface.shape[(c * i + d) * n + k] +=
            c == 3 ? moved[static_cast<Eigen::Index>(d)]
                   : moved.dot(Eigen::Map<const Eigen::Vector3d>(kernel.surface.direction->data()));
    }
  }
}

}  // namespace

void take_traces(const Patches& patches, const Traces& traces, const Sources& sources,
                 kernels::Kernel& kernel) {
  kernel.surface = patches.geometry;
  kernel.surface.shape = flat(traces.shape);
  kernel.loads.body_force = flat(traces.participation.topRows(3));
  kernel.loads.rotation = flat(traces.participation.bottomRows(3));
  move_rigid_traces(patches.arm, kernel);
  kernel.applied = sources.loads;
  kernel.receivers = sources.receivers;
  for (std::size_t l = 0; l < kernel.applied.size(); ++l)
    kernel.applied[l].participation = flat(traces.applied.middleRows(static_cast<Eigen::Index>(3 * l), 3));
  for (std::size_t r = 0; r < kernel.receivers.size(); ++r)
    kernel.receivers[r].shape = flat(traces.at_receivers.middleRows(static_cast<Eigen::Index>(3 * r), 3));
  kernel.gauges = sources.gauges;
  for_each_row(kernel, [&](kernels::Sensitivity& seen, Eigen::Index from, Eigen::Index count) {
    seen.shape = flat(sources.gauge_unit.segment(from, count).asDiagonal() *
                      traces.at_receivers.bottomRows(sources.gauge_unit.size()).middleRows(from, count));
  });
}

namespace {

/// Stores the static correction on the visualisation surface. `field` contains the responses there.
/// Collective on the team.
void take_corrections(const VisualisationField& field, Eigen::Index candidates, Eigen::Index seen,
                      kernels::Kernel& kernel) {
  auto by_contact = field.gather(0, candidates), by_gravity = field.gather(seen, 3),
       by_loads = field.gather(seen + 3, field.rows.value.cols() - seen - 3);
  if (!kernel.view) return;
  kernel.view->residual_flexibility = std::move(by_contact);
  kernel.view->body_force_residual = std::move(by_gravity);
  kernel.view->load_residual = std::move(by_loads);
}

/// Stores Ψ − ΦΓ on the visualisation surface. Collective on the team.
void trace_motions(const mesh::Mesh& mesh, const reduction::Lift& lift, kernels::Kernel& kernel) {
  VisualisationField field(mesh);
  field.rows.value = lift.shape(field.rows.row, Eigen::all);
  std::vector<float> moved = field.gather(0, lift.shape.cols());
  if (!kernel.view) return;
  const std::size_t n = kernel.view->shape.size() / std::max<std::size_t>(kernel.view->node.size(), 1);
  const auto count = static_cast<std::size_t>(lift.shape.cols());
  for (std::size_t row = 0; row < kernel.view->node.size(); ++row)
    for (std::size_t j = 0; j < count; ++j) {
      const double* gamma = &kernel.motions[j / 3].participation[j % 3 * n];
      double taken = 0;
      for (std::size_t k = 0; k < n; ++k) taken += kernel.view->shape[row * n + k] * gamma[k];
      moved[row * count + j] -= static_cast<float>(taken);
    }
  kernel.view->motion_residual = std::move(moved);
}

/// Stores the motions of the moving supports, u = (Ψ − ΦΓ) ū + Φ p.
void trace_motions(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                   const modes::ModeSet& modes, const Patches& patches, const Traces& traces,
                   const Sources& sources, kernels::Kernel& kernel) {
  if (sources.motions.empty()) return;
  const reduction::Lift& lift = sources.lift;
  const reduction::Loads at_candidates =
      spread(mesh, patches.weights, patches.geometry.size(), patches.geometry.direction, FixedRows::filled);
  const Eigen::MatrixXd candidates = modes::inner(mesh.comm, at_candidates, lift.shape),
                        receivers = modes::inner(mesh.comm, sources.receiver_filled, lift.shape),
                        momentum = modes::inner(mesh.comm, body.rigid_load.leftCols(3), lift.shape) +
                                   body.imposed.momentum,
                        gamma = modes.gather(teams, modes::inner(mesh.comm, lift.inertia, modes.shape));
  const Eigen::MatrixXd body_force = traces.participation.topRows(3),
                        on_candidates = candidates - traces.shape * gamma.transpose(),
                        on_receivers = receivers - traces.at_receivers * gamma.transpose(),
                        in_momentum = momentum - body_force * gamma.transpose();
  kernel.motions = sources.motions;
  for (std::size_t s = 0; s < kernel.motions.size(); ++s) {
    const auto from = static_cast<Eigen::Index>(3 * s);
    kernel.motions[s].participation = flat(gamma.middleRows(from, 3));
    kernel.motions[s].residual = flat(on_candidates.middleCols(from, 3));
    kernel.motions[s].momentum = flat(in_momentum.middleCols(from, 3));
  }
  for (std::size_t r = 0; r < kernel.receivers.size(); ++r)
    kernel.receivers[r].motion_residual = flat(on_receivers.middleRows(static_cast<Eigen::Index>(3 * r), 3));
  for_each_row(kernel, [&](kernels::Sensitivity& seen, Eigen::Index from, Eigen::Index count) {
    seen.motion_residual = flat(sources.gauge_unit.segment(from, count).asDiagonal() *
                                on_receivers.bottomRows(sources.gauge_unit.size()).middleRows(from, count));
  });
}

}  // namespace

namespace {

/// Gravity along each axis without the rigid motion that it causes. Removing it from the load, and not only
/// from the response, keeps the round-off of a falling body out of its deformation. (local rows, 3)
Eigen::MatrixXd gravity_without_fall(const mesh::Mesh& mesh, const elasticity::Body& body) {
  const Eigen::MatrixXd gravity = body.rigid_load.leftCols(3), rigid = elasticity::rigid_modes(mesh, body);
  return gravity - modes::BlockProduct(body.mass)(rigid) * modes::inner(mesh.comm, rigid, gravity);
}

}  // namespace

void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           const reduction::Loads& loads, Correction correction, bool view, kernels::Kernel& kernel,
           const Sources& sources, const parallel::Progress& advance) {
  const auto seen_by_modes = [&](const auto& load) {
    return modes.gather(teams, modes::inner(mesh.comm, load, modes.shape));
  };
  const Traces traces{seen_by_modes(loads), seen_by_modes(body.rigid_load), seen_by_modes(sources.load),
                      seen_by_modes(sources.receiver)};
  take_traces(patches, traces, sources, kernel);
  trace_motions(teams, mesh, body, modes, patches, traces, sources, kernel);
  if (view) gather_view(teams, mesh, modes, kernel);
  if (view && !sources.motions.empty()) trace_motions(mesh, sources.lift, kernel);
  if (correction != Correction::none) {
    kernel.surface.normal_residual = correction == Correction::normal;
    const reduction::Loads pressed =
        kernel.surface.normal_residual ? along_normals(loads, patches.geometry) : loads;
    const Eigen::Index candidates = pressed.cols(), seen = candidates + sources.receiver.cols();
    const reduction::Loads all =
        reduction::beside({pressed, sources.receiver.sparseView(),
                           gravity_without_fall(mesh, body).sparseView(), sources.load.sparseView()});
    std::optional<VisualisationField> field;
    if (view) field.emplace(mesh);
    if (correction == Correction::compressed) {
      reduction::ResidualColumns response(teams, mesh, body, factor, modes, all);
      std::vector<Eigen::Index> others(static_cast<std::size_t>(all.cols() - candidates));
      std::iota(others.begin(), others.end(), candidates);
      take_other_corrections(response.at(others).topRows(seen), candidates, sources, kernel);
      kernel.surface.compact = kernels::compressed(
          kernel.surface,
          [&](std::span<const Eigen::Index> columns) -> Eigen::MatrixXd {
            return response.at(columns).topRows(candidates);
          },
          {}, advance);
      if (field) response.respond(field->rows);
    } else {
      take_corrections(
          reduction::residual_response(teams, mesh, body, factor, modes, all, field ? &field->rows : nullptr)
              .topRows(seen),
          candidates, sources, kernel);
    }
    if (field) take_corrections(*field, candidates, seen, kernel);
  }
}

}  // namespace ricochet::surface
