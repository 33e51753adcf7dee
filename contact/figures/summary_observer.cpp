// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/summary_observer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::contact {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/// A touch has more steps than this, and the rigid motion hardly changes in between.
constexpr std::int64_t steps_between_obstacle_checks = 8;

}  // namespace

SummaryObserver::SummaryObserver(const Model& model, double step, double wave_speed,
                                 std::vector<MaterialLimits> limits)
    : model_(&model),
      gap_(model.gap),
      step_(step),
      before_(model.initial_rates()),
      impulse_(Matrix3Xd::Zero(3, model.pairs.size())),
      episode_impulse_(impulse_),
      friction_impulse_(impulse_),
      slipped_(Vector::Zero(std::ssize(model.friction))),
      linearity_(std::in_place, model, wave_speed),
      resolution_(std::in_place, model),
      obstacles_(std::in_place, model),
      band_(std::in_place, model, step),
      pressure_(std::in_place, model, std::move(limits)),
      ripple_(std::in_place, model, step),
      closest_(gap_.size() > 0 ? gap_.minCoeff() : 0) {
  add_model(model);
}

void SummaryObserver::begin() {
  const Energy start = initial_energy(*model_);
  initial_strain_ = start.strain;
  energy_before_ = start.kinetic;
  initial_ledger_ = largest_energy_ = start.ledger();
}

SummaryObserver::SummaryObserver(const Table& table, const Model* source, const StepOptions& options)
    : bodies_(table.bodies),
      gap_(table.gap),
      step_(options.step),
      before_(3 * std::ssize(bodies_)),
      impulse_(Matrix3Xd::Zero(3, std::ssize(bodies_))),
      episode_impulse_(impulse_),
      closest_(gap_.size() > 0 ? gap_.minCoeff() : 0) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) before_.segment<3>(3 * b) = bodies_[b].velocity;
  out_.candidates = table.points();
  if (!source) return;
  add_model(*source);
  out_.modes_in_residual = static_cast<int>(source->folded.modes.size());
}

void SummaryObserver::add_model(const Model& model) {
  for (const Model::BodyBlock& body : model.bodies) {
    out_.modes[body.name] = body.modes;
    out_.basis[body.name] = body.kernel->modes.basis;
  }
  for (const Model::PairBlock& pair : model.pairs) out_.unpaired += pair.unpaired;
  out_.candidates = static_cast<int>(model.gap.size());
  if (!model.friction.empty()) out_.ambiguous_steps = 0;
}

/// Adds a step to the results that follow from the forces alone. After the last point has opened, the mean
/// force still acts for up to two steps.
void SummaryObserver::count_forces(const Stepper& stepper) {
  const auto force = stepper.force().head(stepper.points());
  const double time = stepper.time();
  const bool touched = std::exchange(touching_, (force.array() > 0).any());
  if (!touching_) {
    if (touched) out_.contact_end_s = out_.episodes.back().end_s = last_touch_;
    return;
  }
  if (stepper.active() > 0) last_touch_ = time;
  if (!touched) out_.episodes.push_back({.start_s = time - step_, .end_s = {}});
  if (!out_.contact_start_s) out_.contact_start_s = time - step_;
  out_.contact_end_s.reset();
  const double sum = force.sum();
  Episode& episode = out_.episodes.back();
  episode.impulse_ns += sum * step_;
  episode.peak_force_n = std::max(episode.peak_force_n, sum);
  out_.impulse_ns += sum * step_;
  out_.peak_force_n = std::max(out_.peak_force_n, sum);
  out_.max_active = std::max(out_.max_active, stepper.active());
  ++out_.contact_steps;
}

void SummaryObserver::observe(const Stepper& stepper) {
  if (observed_++ == 0 && model_) begin();
  const ModalState* modal = stepper.modal();
  // Impulses are larger the shorter the step, so they are no measure of pressure, and their spectrum is flat.
  const bool compliant = stepper.options().scheme == Scheme::compliant;
  if (gap_.size() > 0) {
    const double deepest = (stepper.displacement().head(gap_.size()) - gap_).maxCoeff();
    out_.max_penetration_m = std::max(out_.max_penetration_m, deepest);
    closest_ = std::min(closest_, -deepest);
  }
  out_.limited_steps = stepper.solver().limited;
  if (const SolveResidual& left = stepper.residual(); left.scale > 0)
    out_.limited_residual = std::max(out_.limited_residual, left.violation / left.scale);
  const bool untouched = !out_.contact_start_s, touched = touching_;
  count_forces(stepper);
  if (touching_ && !touched) {
    episode_start_ = mean_velocities(stepper.time() - step_);
    episode_impulse_.setZero();
  }
  if (touching_ && untouched) {
    at_start_ = episode_start_;
    energy_at_start_ = energy_before_;
  }
  if (touching_) {
    push(stepper.force());
    for (Eigen::Index f = 0; f < slipped_.size(); ++f) slipped_(f) += stepper.slip().speed(f) * step_;
    if (slipped_.size() > 0) out_.ambiguous_steps = stepper.ambiguous_steps();
    if (modal) linearity_->observe(stepper, before_, !touched);
    // Impulses have a flat spectrum, which steps bound and not modes.
    if (modal && compliant) {
      band_->observe(stepper.time(), stepper.force());
      pressure_->observe(stepper.force(), stepper.time());
    }
  } else if (touched) {
    at_end_ = mean_velocities(stepper.time() - step_);
    judge(out_.episodes.back(), true);
  }
  if (modal) {
    linearity_->observe_rotation(modal->q, stepper.time());
    resolution_->observe(stepper, before_);
    if (compliant) ripple_->observe(stepper.time(), stepper.force().head(stepper.points()).sum());
    if (observed_ % steps_between_obstacle_checks == 1) obstacles_->observe(modal->q, stepper.time());
    out_.modes_in_residual = modal->modes_in_residual();
    out_.precision = stepper.options().precision;
    observe_energy(modal->energy());
    before_ = modal->v;
  } else {
    before_ = stepper.body_velocities()->reshaped();
  }
}

void SummaryObserver::observe_energy(const Energy& energy) {
  worst_ledger_ = std::max(worst_ledger_, std::abs(energy.ledger() - initial_ledger_));
  largest_energy_ = std::max({largest_energy_, energy.kinetic + energy.strain + energy.residual,
                              std::abs(energy.loads), std::abs(energy.contact), std::abs(energy.friction)});
  energy_lost_ = energy.contact;
  heat_ = energy.friction;
  energy_before_ = energy.kinetic + energy.strain - initial_strain_;
}

/// Velocity of each body at the end of the previous step, at `time`.
Matrix3Xd SummaryObserver::mean_velocities(double time) const {
  if (!model_) return before_.reshaped(3, std::ssize(bodies_));
  Matrix3Xd out(3, std::ssize(model_->bodies));
  for (Eigen::Index k = 0; k < out.cols(); ++k)
    out.col(k) = model_->momentum(static_cast<int>(k), before_, time) / model_->bodies[k].mass;
  return out;
}

void SummaryObserver::push(const Vector& force) {
  for (Eigen::Index k = 0; k < impulse_.cols(); ++k) {
    Vector3d impulse;
    if (model_) {
      const Model::PairBlock& pair = model_->pairs[k];
      impulse = step_ * model_->normal.middleRows(pair.first_point, pair.points).transpose() *
                force.segment(pair.first_point, pair.points);
      friction_impulse_.col(k) += step_ * model_->friction_resultant(pair, force);
    } else {
      impulse = step_ * bodies_[k].push.transpose() * force;
    }
    impulse_.col(k) += impulse;
    episode_impulse_.col(k) += impulse;
  }
}

/// Sets the approach of the last episode and, if it has ended with the velocities at_end_, its restitution.
void SummaryObserver::judge(Episode& episode, bool ended) const {
  episode.approach_m_per_s = closing_speed(episode_start_, episode_impulse_);
  if (ended && episode.approach_m_per_s && *episode.approach_m_per_s > 0)
    episode.restitution = -*closing_speed(at_end_, episode_impulse_) / *episode.approach_m_per_s;
}

/// Closing speed of the bodies along the impulse, with supported bodies and obstacles at 0. Returns no value
/// unless exactly one pair has an impulse.
std::optional<double> SummaryObserver::closing_speed(const Matrix3Xd& velocity,
                                                     const Matrix3Xd& impulse) const {
  if (model_) {
    const Eigen::RowVectorXd size = impulse.colwise().norm();
    if ((size.array() > 0).count() != 1) return {};
    Eigen::Index p = 0;
    size.maxCoeff(&p);
    const Model::PairBlock& pair = model_->pairs[p];
    Vector3d relative = Vector3d::Zero();
    if (!model_->bodies[pair.a].supported) relative += velocity.col(pair.a);
    if (pair.b >= 0 && !model_->bodies[pair.b].supported) relative -= velocity.col(pair.b);
    return relative.dot(impulse.col(p).normalized());
  }
  // If other bodies push two bodies as well, their impulses are unequal. 1e-9 is far above the round-off of a
  // sum of steps.
  const bool pair = impulse.cols() == 2 && impulse.rowwise().sum().norm() < 1e-9 * impulse.norm();
  if (impulse.cols() != 1 && !pair) return {};
  const double size = impulse.col(0).norm();
  if (!(size > 0)) return {};
  return -velocity.cwiseProduct(impulse).sum() / size;
}

Summary SummaryObserver::summary() const {
  Summary out = out_;
  if (model_) {
    out.energy_drift = largest_energy_ > 0 ? worst_ledger_ / largest_energy_ : 0;
    if (slipped_.size() > 0) {
      if (energy_at_start_ > 0 || heat_ == 0)
        out.energy_lost_friction = heat_ == 0 ? 0 : heat_ / energy_at_start_;
      out.friction_impulse_ns = friction_impulse_.colwise().norm().sum();
      out.max_slip_m = slipped_.maxCoeff();
    }
    if (energy_at_start_ > 0)
      out.energy_lost_contact = energy_lost_ / energy_at_start_;
    else if (energy_lost_ == 0)
      out.energy_lost_contact = 0;
    out.warnings = linearity_->warnings();
    for (std::string& warning : pressure_->warnings()) out.warnings.push_back(std::move(warning));
    for (std::string& warning : resolution_->warnings(out_)) out.warnings.push_back(std::move(warning));
    for (std::string& warning : ripple_->warnings()) out.warnings.push_back(std::move(warning));
    for (std::string& warning : obstacles_->warnings()) out.warnings.push_back(std::move(warning));
  }
  if (!out.contact_start_s)
    out.warnings.push_back(fmt::format(
        "nothing touched: the smallest distance of a pair of points was {:.4g} m. Check velocity, gap, "
        "gravity and duration, and whether contact names the surfaces that meet",
        closest_));
  if (touching_) judge(out.episodes.back(), false);
  if (!out.contact_end_s) return out;
  for (Eigen::Index k = 0; k < at_end_.cols(); ++k) {
    const auto body = static_cast<std::size_t>(k);
    out.exit_velocity[model_ ? model_->bodies[body].name : bodies_[body].name] = at_end_.col(k);
  }
  if (const auto approach = closing_speed(at_start_, impulse_); approach && *approach > 0)
    out.restitution = -*closing_speed(at_end_, impulse_) / *approach;
  if (band_) add_band(out);
  return out;
}

/// What modes above the band would take. With the restitution e, the bodies part with e² of the energy J v/(2
/// (1 + e)) with which they approach each other, for an impulse J and an approach v.
void SummaryObserver::add_band(Summary& out) const {
  const auto energy = band_->energy();
  if (!energy || !(energy_at_start_ > 0)) return;
  out.energy_above_band = *energy / energy_at_start_;
  const auto approach = closing_speed(at_start_, impulse_);
  if (!out.restitution || !(*out.restitution > 0)) return;
  const double e = *out.restitution, approaching = out.impulse_ns * *approach / (2 * (1 + e));
  out.rebound_above_band = e - std::sqrt(std::max(0.0, e * e - *energy / approaching));
}

}  // namespace ricochet::contact
