// SPDX-License-Identifier: BSD-2-Clause
#include "src/surface/trace.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "kernels/compression.hpp"
#include "src/elasticity/rigid.hpp"
#include "src/reduction/residual.hpp"
#include "src/surface/gauges.hpp"

namespace ricochet::surface {

namespace {

/// Modes whose values at the nodes of the visualisation surface are computed together.
constexpr Eigen::Index modes_at_once = 32;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Derived>
std::vector<double> flat(const Eigen::MatrixBase<Derived>& matrix) {
  std::vector<double> values(static_cast<std::size_t>(matrix.size()));
  Eigen::Map<RowMajor>(values.data(), matrix.rows(), matrix.cols()) = matrix;
  return values;
}

/// A field on the mesh at the nodes of the visualisation surface: its displacement and, if the kernel is to
/// have it, its stress.
class VisualisationField {
 public:
  /// One of them: some rows of `rows`, and the number of each in (V,3) or (V,6).
  struct Quantity {
    Eigen::Index first = 0;
    std::vector<std::size_t> number{};
    std::size_t size = 0;  ///< 3V or 6V; 0: there is none
    Eigen::Index count() const { return std::ssize(number); }
  };

  /// @param stress  rows of stress_rows; without a law, there is no stress
  VisualisationField(const mesh::Mesh& mesh, reduction::GradientRows stress) : mesh_(mesh) {
    std::vector<std::int64_t> node = mesh.visualisation.node;
    parallel::broadcast(mesh.comm, node);
    std::vector<Eigen::Triplet<double>> entries;
    const int c = mesh.components();
    displacement.size = 3 * node.size();
    for (std::size_t v = 0; v < node.size(); ++v) {
      const auto local = static_cast<int>(mesh.owned(node[v]));
      if (local < 0) continue;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto row = static_cast<int>(displacement.count()), of = static_cast<int>(d);
        displacement.number.push_back(3 * v + d);
        entries.emplace_back(row, c == 3 ? 3 * local + of : local, c == 3 ? 1 : mesh.axis[d]);
      }
    }
    rows.of.resize(displacement.count(), mesh.owned_nodes * c);
    rows.of.setFromTriplets(entries.begin(), entries.end());
    this->stress.first = displacement.count();
    this->stress.size = static_cast<std::size_t>(stress.law.rows()) * node.size();
    for (const std::size_t point : stress.point)
      for (std::size_t k = 0; k < kernels::stress_rows; ++k)
        this->stress.number.push_back(kernels::stress_rows * point + k);
    rows.of_gradient = std::move(stress);
  }

  /// Gathers columns on the first rank of `comm`, one at a time. Returns (size, count), or an empty vector on
  /// other ranks. `column(j)` returns this rank's share of a column, or std::nullopt if it has none.
  /// Collective.
  template <class Column>
  static std::vector<float> gather(const Quantity& of, MPI_Comm comm, std::size_t count, Column&& column) {
    const bool first = parallel::rank_of(comm) == 0;
    std::vector<float> out(first ? of.size * count : 0);
    std::vector<double> part(of.size), whole(part.size());
    for (std::size_t j = 0; j < count; ++j) {
      std::ranges::fill(part, 0.0);
      if (const std::optional<Eigen::VectorXd> value = column(static_cast<Eigen::Index>(j)))
        for (std::size_t i = 0; i < of.number.size(); ++i)
          part[of.number[i]] = (*value)[static_cast<Eigen::Index>(i)];
      MPI_Reduce(part.data(), whole.data(), static_cast<int>(part.size()), MPI_DOUBLE, MPI_SUM, 0, comm);
      for (std::size_t k = 0; first && k < whole.size(); ++k)
        out[k * count + j] = static_cast<float>(whole[k]);
    }
    return out;
  }

  /// Gathers columns of `rows`, which every team holds, on the first rank of the team. Collective on the
  /// team.
  std::vector<float> gather(const Quantity& of, Eigen::Index from, Eigen::Index count) const {
    return gather(of, mesh_.comm, static_cast<std::size_t>(count), [&](Eigen::Index j) -> Eigen::VectorXd {
      return rows.value.col(from + j).segment(of.first, of.count());
    });
  }

  reduction::Rows rows;
  Quantity displacement, stress;

 private:
  const mesh::Mesh& mesh_;
};

/// Stores the modes on the visualisation surface in the kernel of the first rank. Collective.
void gather_view(const parallel::Teams& teams, const mesh::Mesh& mesh, const modes::ModeSet& modes,
                 const VisualisationField& field, kernels::Kernel& kernel) {
  const auto gathered = [&](const VisualisationField::Quantity& of, auto times, double from) {
    Eigen::Index own = 0;
    Eigen::MatrixXd some;  // of the next modes of this rank
    return field.gather(
        of, teams.world(), modes.angular_frequency.size(),
        [&](Eigen::Index n) -> std::optional<Eigen::VectorXd> {
          if (own == std::ssize(modes.index) || modes.index[static_cast<std::size_t>(own)] != n)
            return std::nullopt;
          const Eigen::Index at = own++ % modes_at_once;
          if (at == 0)
            some = (field.rows.*times)(
                modes.shape.middleCols(own - 1, std::min(modes_at_once, modes.shape.cols() - (own - 1))));
          if (modes.angular_frequency[static_cast<std::size_t>(n)] < from) return std::nullopt;
          return some.col(at);
        });
  };
  std::vector<float> shape = gathered(field.displacement, &reduction::Rows::times, 0);
  // Rigid modes have no stress, and a body that flies far would multiply the round-off of one.
  std::vector<float> stress;
  if (field.stress.size > 0)
    stress = gathered(field.stress, &reduction::Rows::gradient_times, std::numeric_limits<double>::min());
  if (parallel::rank_of(teams.world()) != 0) return;
  kernels::View& view = kernel.view.emplace();
  view.node = mesh.visualisation.position;
  view.element_corners = mesh.visualisation.blocks.front().nodes_per_element;
  view.element = mesh.visualisation.blocks.front().node;
  view.shape = std::move(shape);
  if (field.stress.size > 0) view.stress.emplace().shape = std::move(stress);
}

}  // namespace

/// Calls act(sensitivity, first, count) for the stress and the strain of each gauge, with its rows among
/// those of all gauges.
template <class Act>
static void for_each_row(kernels::Kernel& kernel, Act&& act) {
  Eigen::Index from = 0;
  for (kernels::Gauge& gauge : kernel.gauges) {
    constexpr auto count = static_cast<Eigen::Index>(kernels::stress_rows);
    act(gauge.stress, from, count);
    from += count;
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
  // Parts and pieces of a body turn separately, and rods do not turn.
  if (kernel.parts > 1 || !kernel.piece_elements.empty() || !(inertia.determinant() > 0)) return;
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
  const auto take = [&](const VisualisationField::Quantity& of, auto* to) {
    auto by_contact = field.gather(of, 0, candidates), by_gravity = field.gather(of, seen, 3),
         by_loads = field.gather(of, seen + 3, field.rows.value.cols() - seen - 3);
    if (!to) return;
    to->residual_flexibility = std::move(by_contact);
    to->body_force_residual = std::move(by_gravity);
    to->load_residual = std::move(by_loads);
  };
  kernels::View* const view = kernel.view ? &*kernel.view : nullptr;
  take(field.displacement, view);
  if (field.stress.size > 0) take(field.stress, view ? &*view->stress : nullptr);
}

/// Stores Ψ − ΦΓ on the visualisation surface. Collective on the team.
void trace_motions(const Sources& sources, VisualisationField& field, kernels::Kernel& kernel) {
  field.rows.value = field.rows.all_times(sources.lift.shape);
  const auto count = static_cast<std::size_t>(sources.lift.shape.cols());
  const auto take = [&](const VisualisationField::Quantity& of, auto* to) {
    std::vector<float> moved = field.gather(of, 0, sources.lift.shape.cols());
    if (!to) return;
    const std::size_t n = of.size > 0 ? to->shape.size() / of.size : 0;
    for (std::size_t row = 0; row < of.size; ++row)
      for (std::size_t j = 0; j < count; ++j) {
        const double* gamma = &kernel.motions[j / 3].participation[j % 3 * n];
        double taken = 0;
        for (std::size_t k = 0; k < n; ++k) taken += to->shape[row * n + k] * gamma[k];
        moved[row * count + j] -= static_cast<float>(taken);
      }
    to->motion_residual = std::move(moved);
  };
  kernels::View* const view = kernel.view ? &*kernel.view : nullptr;
  take(field.displacement, view);
  if (field.stress.size > 0) take(field.stress, view ? &*view->stress : nullptr);
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
           const Sources& sources, const std::vector<scene::Material>& stressed,
           const parallel::Progress& advance) {
  const auto seen_by_modes = [&](const auto& load) {
    return modes.gather(teams, modes::inner(mesh.comm, load, modes.shape));
  };
  const Traces traces{seen_by_modes(loads), seen_by_modes(body.rigid_load), seen_by_modes(sources.load),
                      seen_by_modes(sources.receiver)};
  take_traces(patches, traces, sources, kernel);
  trace_motions(teams, mesh, body, modes, patches, traces, sources, kernel);
  std::optional<VisualisationField> field;
  if (view) {
    field.emplace(mesh, stressed.empty() || mesh.total_elements == 0 ? reduction::GradientRows{}
                                                                     : surface_stress(mesh, stressed));
    gather_view(teams, mesh, modes, *field, kernel);
    if (!sources.motions.empty()) trace_motions(sources, *field, kernel);
  }
  if (correction != Correction::none) {
    kernel.surface.normal_residual = correction == Correction::normal;
    const reduction::Loads pressed =
        kernel.surface.normal_residual ? along_normals(loads, patches.geometry) : loads;
    const Eigen::Index candidates = pressed.cols(), seen = candidates + sources.receiver.cols();
    const reduction::Loads all =
        reduction::beside({pressed, sources.receiver.sparseView(),
                           gravity_without_fall(mesh, body).sparseView(), sources.load.sparseView()});
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
