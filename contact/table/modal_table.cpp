// SPDX-License-Identifier: BSD-2-Clause
#include "contact/table/modal_table.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "base/format.hpp"
#include "contact/stepping/propagator.hpp"
#include "contact/stepping/stepper.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Coefficient of one mode in the responses at each step: its motion after a unit impulse, or after a unit
/// force over the first step.
struct Series {
  double stiffness, q, v;
  ModeStep by;
  void advance() {
    const double g = -stiffness * q, next = q + by.S * v + by.c * g;
    v = by.rate * v + by.S * g;
    q = next;
  }
};

/// Samples the motion without contact at K instants, and the velocities that impulses need.
void sample_free_motion(const Model& model, const StepOptions& options, std::int64_t K, Table& table) {
  const Eigen::Index m = model.gap.size();
  // Without contact, the bodies move as if they were too far apart to touch.
  Model apart = model;
  apart.gap.setConstant(1e300);
  const std::unique_ptr<Stepper> motion =
      make_stepper(std::make_shared<const Model>(std::move(apart)), options);
  for (std::int64_t k = 0; k < K; ++k) {
    if (k > 0 && motion->step() != StepStatus::ok)
      throw SolverError(base::format("the free motion stops being finite at t = {:.6g} s", motion->time()));
    const Vector &u = motion->displacement(), rate = model.B * motion->modal()->v;
    table.free.insert(table.free.end(), u.data(), u.data() + m);
    if (options.contact.scheme != Scheme::compliant)
      table.free_velocity.insert(table.free_velocity.end(), rate.data(), rate.data() + m);
  }
}

/// Samples L responses: S for the compliant scheme, otherwise N and Ṅ.
void sample_responses(const Model& model, const StepOptions& options, std::int64_t L, Table& table) {
  const bool compliant = options.contact.scheme == Scheme::compliant;
  const Eigen::Index m = model.gap.size();
  std::vector<Series> series;
  std::vector<Eigen::Index> column;
  for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
    const double stiffness = model.omega(n) * model.omega(n);
    if (model.B.col(n).isZero(0)) continue;
    const ModeStep by = mode_step(model.omega(n), model.decay(n), options.step);
    series.push_back(compliant ? Series{stiffness, by.c, by.S, by} : Series{stiffness, 0, 1, by});
    column.push_back(n);
  }
  const Matrix B = model.B(Eigen::all, column);
  Matrix weighted(m, B.cols()), sample(m, m);
  const auto append = [&](std::vector<double>& to, auto coefficient) {
    for (Eigen::Index n = 0; n < B.cols(); ++n) weighted.col(n) = coefficient(series[n]) * B.col(n);
    sample.noalias() = weighted * B.transpose();
    if (compliant && to.empty()) sample += model.R;
    to.insert(to.end(), sample.data(), sample.data() + m * m);
  };
  const std::size_t size = L * m * m;
  for (std::vector<double>* response :
       compliant ? std::vector{&table.flexibility} : std::vector{&table.displacement, &table.velocity})
    response->reserve(size);
  if (compliant && !model.R.isZero(0)) table.residual.assign(model.R.data(), model.R.data() + m * m);
  for (std::int64_t l = 0; l < L; ++l) {
    if (compliant) {
      append(table.flexibility, [](const Series& s) { return s.q; });
    } else {
      append(table.displacement, [](const Series& s) { return s.q; });
      append(table.velocity, [](const Series& s) { return s.v; });
    }
    for (Series& s : series) s.advance();
  }
}

/// Projects onto the directions in which a body moves as a whole without a reaction of its supports, such as
/// those in a plane of symmetry. Along a direction e of this kind, its rigid modes carry the momentum of a
/// free body: Σ (p_kᵀ e)² = m.
Eigen::Matrix3d free_directions(const Model& model, const Bodies::Block& block) {
  constexpr double all = 1 - 1e-6;  // of the mass; a body that turns about an axis or a point has less
  if (!block.supported) return Eigen::Matrix3d::Identity();
  const Eigen::Index rigid = (model.omega.segment(block.first_mode, block.modes).array() == 0).count();
  const auto momentum = block.momentum.leftCols(rigid);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> share(momentum * momentum.transpose() / block.mass);
  const Eigen::Vector3d kept = (share.eigenvalues().array() > all).cast<double>();
  return share.eigenvectors() * kept.asDiagonal() * share.eigenvectors().transpose();
}

/// The bodies that move freely along one axis at least, with their motion along these axes.
std::vector<FreeBody> free_bodies(const Model& model) {
  std::vector<FreeBody> bodies;
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Bodies::Block& block = model.bodies[k];
    const Eigen::Matrix3d free = free_directions(model, block);
    if (free.isZero(0)) continue;
    const Eigen::Vector3d momentum = block.momentum * model.v0.segment(block.first_mode, block.modes);
    FreeBody body{block.name, block.mass, free * momentum / block.mass, free * block.weight / block.mass,
                  Matrix::Zero(model.gap.size(), 3)};
    for (const Model::PairBlock& pair : model.pairs)
      for (const auto& [side, sign] : {std::pair{pair.a, -1.0}, std::pair{pair.b, 1.0}})
        if (side == static_cast<int>(k))
          body.push.middleRows(pair.first_point, pair.points) =
              sign * model.normal.middleRows(pair.first_point, pair.points) * free;
    bodies.push_back(body);
  }
  return bodies;
}

}  // namespace

Table table_from_modes(const Model& given, const StepOptions& options, std::int64_t steps) {
  const std::shared_ptr<const Model> folded = fold(borrowed(given), options);
  const Model& model = *folded;
  // A mean rate needs one more sample and one more instant.
  const int more =
      options.contact.scheme != Scheme::compliant && options.contact.admittance == Admittance::difference;
  Table table;
  table.step = options.step;
  table.gap = model.gap;
  if (model.bulge.size() > 0) table.gap += model.bulge;  // no springs
  table.area = model.area;
  sample_free_motion(model, options, steps + 1 + more, table);
  sample_responses(model, options, std::max<std::int64_t>(2, steps + more), table);
  table.bodies = free_bodies(model);
  return table;
}

}  // namespace ricochet::contact
