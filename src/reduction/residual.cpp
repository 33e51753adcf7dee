// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/residual.hpp"

#include <algorithm>

#include "src/elasticity/rigid.hpp"

namespace ricochet::reduction {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using modes::BlockProduct;
using modes::Factorisation;
using modes::inner;
using modes::ModeSet;

/// Modes below this share of the cut in λ are projected out. The flexibility of the others is at most 100
/// times that at the cut, and is subtracted with its round-off.
constexpr double low = 0.01;

/// Number of columns that a team solves together: several right-hand-side blocks of MUMPS.
constexpr Index columns_at_once = 256;

}  // namespace

/// The modes of all teams, by how they are removed from the static response. Each team holds some of them.
struct Retained {
  MatrixXd trace;             ///< (b, N) Fᵀφ
  std::vector<Index> low;     ///< rigid modes, and elastic ones far below the cut
  std::vector<Index> others;  ///< the other elastic modes
  Eigen::VectorXd inverse;    ///< (N) 1/ω², 0 for rigid modes
  /// (local rows, low) The part of a load along W acts on φ alone: W = Mφ, which equals Kφ/λ for exact modes.
  /// For Ritz vectors, Kφ/λ makes the rest of the load orthogonal to them.
  MatrixXd load;
};

namespace {

Retained retained(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                  const ModeSet& modes, const Loads& loads) {
  Retained out;
  out.trace = modes.gather(teams, inner(mesh.comm, loads, modes.shape));
  const auto all = static_cast<Index>(modes.angular_frequency.size());
  out.inverse.resize(all);
  for (Index n = 0; n < all; ++n) {
    const double omega = modes.angular_frequency[static_cast<std::size_t>(n)];
    out.inverse[n] = omega > 0 ? 1 / (omega * omega) : 0;
    (omega * omega < low * modes.cut ? out.low : out.others).push_back(n);
  }
  std::vector<Index> own, to;
  for (std::size_t j = 0; j < modes.index.size(); ++j) {
    const auto found = std::ranges::lower_bound(out.low, modes.index[j]);
    if (found == out.low.end() || *found != modes.index[j]) continue;
    own.push_back(static_cast<Index>(j));
    to.push_back(found - out.low.begin());
  }
  const MatrixXd shape = modes.shape(Eigen::all, own);
  MatrixXd load = BlockProduct(body.mass)(shape);
  if (!modes.exact) {
    const MatrixXd force = BlockProduct(body.stiffness)(shape);
    for (std::size_t j = 0; j < own.size(); ++j) {
      const double inverse = out.inverse[out.low[static_cast<std::size_t>(to[j])]];
      if (inverse > 0) load.col(static_cast<Index>(j)) = inverse * force.col(static_cast<Index>(j));
    }
  }
  out.load = MatrixXd::Zero(body.local_rows, std::ssize(out.low));
  for (std::size_t j = 0; j < to.size(); ++j) out.load.col(to[j]) = load.col(static_cast<Index>(j));
  parallel::sum(teams.peers(), out.load);
  return out;
}

/// Values of the responses, by solves with K on springs. See residual_response for T and Z.
void respond(const parallel::Teams& teams, Factorisation& factor, const std::vector<std::int64_t>& on_springs,
             const ModeSet& modes, const Retained& kept, const Loads& loads, const MatrixXd& t,
             const MatrixXd& z, Rows& field) {
  factor.factor_on_springs(on_springs);
  const Index rows = field.of.rows() + field.gradient_rows();
  const auto solved = [&](Index columns, const auto& block) {
    MatrixXd value(rows, columns);
    const Index width = columns_at_once * teams.count();
    for (Index from = 0; from < columns; from += width) {
      const Index n = std::min(width, columns - from);
      value.middleCols(from, n) = field.all_times(modes::shared_solve(teams, factor, block(from, n)));
    }
    return value;
  };
  MatrixXd shape = MatrixXd::Zero(rows, kept.inverse.size());
  shape(Eigen::all, modes.index) = field.all_times(modes.shape);
  parallel::sum(teams.peers(), shape);
  const MatrixXd by_low = solved(
      kept.load.cols(), [&](Index from, Index n) -> MatrixXd { return kept.load.middleCols(from, n); });
  const MatrixXd trace = kept.trace(Eigen::all, kept.low);
  field.value =
      solved(loads.cols(), [&](Index from, Index n) { return MatrixXd(loads.middleCols(from, n)); });
  field.value.noalias() -= by_low * trace.transpose();
  field.value.noalias() -= shape(Eigen::all, kept.low) * (t.transpose() - z * trace.transpose());
  field.value.noalias() -= shape(Eigen::all, kept.others) * (kept.inverse(kept.others).asDiagonal() *
                                                             kept.trace(Eigen::all, kept.others).transpose());
}

}  // namespace

MatrixXd residual_response(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                           Factorisation& factor, const ModeSet& modes, const Loads& loads, Rows* field) {
  const Retained kept = retained(teams, mesh, body, modes, loads);
  const std::vector<std::int64_t> on_springs =
      determinate_rows(mesh.comm, elasticity::rigid_modes(mesh, body), factor.entries().first);
  const Index b = loads.cols(), l = kept.load.cols();
  factor.release();
  // With G = K⁻¹ on springs and P = I − W Φᵀ over the low modes, the response is
  //   Fᵀ Pᵀ G P F = S − T Bᵀ − B Tᵀ + B Z Bᵀ,   S = FᵀGF, T = FᵀGW, Z = WᵀGW, B = FᵀΦ,
  // less B Λ⁻¹ Bᵀ over the other modes. P also removes rigid modes, so that loads are in equilibrium.
  MatrixXd response =
      BorderedStiffness(teams, factor, on_springs, beside({loads, kept.load.sparseView()})).flexibility();
  MatrixXd t, z;
  if (parallel::rank_of(teams.world()) == 0) {
    t = response.topRightCorner(b, l);
    z = response.bottomRightCorner(l, l);
    response.conservativeResize(b, b);
    const MatrixXd trace = kept.trace(Eigen::all, kept.low), other = kept.trace(Eigen::all, kept.others);
    const MatrixXd half = t - 0.5 * trace * z;
    response.noalias() -= half * trace.transpose();
    response.noalias() -= trace * half.transpose();
    response.noalias() -= other * kept.inverse(kept.others).asDiagonal() * other.transpose();
    response.triangularView<Eigen::StrictlyUpper>() = response.transpose();
  }
  for (MatrixXd* matrix : {&response, &t, &z}) {
    matrix->resize(matrix == &z ? l : b, matrix == &response ? b : l);
    for (auto column : matrix->colwise())  // in parts, because MPI counts with 32 bits
      MPI_Bcast(column.data(), static_cast<int>(column.size()), MPI_DOUBLE, 0, teams.world());
  }
  if (field != nullptr) respond(teams, factor, on_springs, modes, kept, loads, t, z, *field);
  return response;
}

struct ResidualColumns::Parts {
  const parallel::Teams& teams;
  const mesh::Mesh& mesh;
  modes::Factorisation& factor;
  const ModeSet& modes;
  const Loads& loads;
  Retained kept;
  std::vector<std::int64_t> on_springs;
  MatrixXd t, z;  // T and Z of residual_response
};

ResidualColumns::ResidualColumns(const parallel::Teams& teams, const mesh::Mesh& mesh,
                                 const elasticity::Body& body, Factorisation& factor, const ModeSet& modes,
                                 const Loads& loads)
    : parts_(
          new Parts{teams,
                    mesh,
                    factor,
                    modes,
                    loads,
                    retained(teams, mesh, body, modes, loads),
                    determinate_rows(mesh.comm, elasticity::rigid_modes(mesh, body), factor.entries().first),
                    {},
                    {}}) {
  factor.release();
  factor.factor_on_springs(parts_->on_springs);
  const MatrixXd& load = parts_->kept.load;
  MatrixXd solved(load.rows(), load.cols());
  for (Index from = 0; from < load.cols(); from += columns_at_once) {
    const Index n = std::min(columns_at_once, load.cols() - from);
    solved.middleCols(from, n) = modes::shared_solve(teams, factor, load.middleCols(from, n));
  }
  parts_->t = inner(mesh.comm, loads, solved);
  parts_->z = inner(mesh.comm, load, solved);
}

ResidualColumns::~ResidualColumns() = default;

MatrixXd ResidualColumns::at(std::span<const Index> columns) {
  const Loads& loads = parts_->loads;
  const Retained& kept = parts_->kept;
  MatrixXd pressed(loads.rows(), std::ssize(columns));
  for (std::size_t c = 0; c < columns.size(); ++c) pressed.col(static_cast<Index>(c)) = loads.col(columns[c]);
  MatrixXd out = inner(parts_->mesh.comm, loads, modes::shared_solve(parts_->teams, parts_->factor, pressed));
  const MatrixXd trace = kept.trace(Eigen::all, kept.low), other = kept.trace(Eigen::all, kept.others);
  const MatrixXd half = parts_->t - 0.5 * trace * parts_->z;
  const std::vector<Index> rows(columns.begin(), columns.end());
  out.noalias() -= half * trace(rows, Eigen::all).transpose();
  out.noalias() -= trace * half(rows, Eigen::all).transpose();
  out.noalias() -= other * (kept.inverse(kept.others).asDiagonal() * other(rows, Eigen::all).transpose());
  return out;
}

void ResidualColumns::respond(Rows& field) {
  reduction::respond(parts_->teams, parts_->factor, parts_->on_springs, parts_->modes, parts_->kept,
                     parts_->loads, parts_->t, parts_->z, field);
}

}  // namespace ricochet::reduction
