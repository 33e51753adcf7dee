// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/summary_observer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

SummaryObserver::SummaryObserver(const MotionSource& source, double step, double wave_speed,
                                 std::vector<MaterialLimits> limits)
    : figures_(source, step), step_(step), limits_(std::move(limits)) {
  out_.candidates = static_cast<int>(source.gap().size());
  if (const Model* const places = source.places()) {
    for (const Bodies::Block& body : places->bodies) {
      out_.modes[body.name] = body.modes;
      out_.basis[body.name] = body.kernel->modes.basis;
    }
    for (const Model::PairBlock& pair : places->pairs) out_.unpaired += pair.unpaired;
    out_.modes_in_residual = static_cast<int>(places->folded.modes.size());
  }
  const Model* const model = source.modes();
  if (!model) return;
  checks_.emplace(*model, step, wave_speed, limits_);
  band_.emplace(*model, step);
  initial_ledger_ = largest_energy_ = initial_energy(*model).ledger();
  if (model->friction.empty()) return;
  out_.ambiguous_steps = 0;
  friction_impulse_.setZero(3, std::ssize(model->pairs));
  slipped_.setZero(std::ssize(model->friction));
}

void SummaryObserver::observe(const Stepper& stepper) {
  figures_.observe(stepper);
  out_.limited_steps = stepper.solver().limited;
  if (const SolveResidual& left = stepper.residual(); left.scale > 0)
    out_.limited_residual = std::max(out_.limited_residual, left.violation / left.scale);
  const Model* const model = figures_.source().modes();
  if (!model) return;
  checks_->observe(stepper, figures_);
  if (figures_.touching()) {
    if (slipped_.size() > 0) observe_friction(*model, stepper);
    // Impulses have a flat spectrum, which steps bound and not modes.
    if (stepper.options().contact.scheme == Scheme::compliant)
      band_->observe(stepper.time(), stepper.force(), stepper.turning());
  }
  if (!model->receivers.empty()) {
    if (!acceleration_) acceleration_.emplace(*model, stepper.options());
    acceleration_->observe(stepper);
  }
  if (stress_ || has_stress(*model)) {
    if (!stress_) stress_.emplace(*model, stepper.options(), limits_);
    stress_->observe(stepper);
  }
  out_.precision = stepper.options().precision;
  out_.rotation = stepper.options().rigid.rotation;
  observe_energy(stepper.modal()->energy());
}

void SummaryObserver::observe_friction(const Model& model, const Stepper& stepper) {
  for (std::size_t p = 0; p < model.pairs.size(); ++p)
    friction_impulse_.col(static_cast<Eigen::Index>(p)) +=
        step_ * model.friction_resultant(model.pairs[p], stepper.force(), frames_of(model, stepper));
  for (Eigen::Index f = 0; f < slipped_.size(); ++f) slipped_(f) += stepper.slip().speed(f) * step_;
  out_.ambiguous_steps = stepper.ambiguous_steps();
}

void SummaryObserver::observe_energy(const Energy& energy) {
  worst_ledger_ = std::max(worst_ledger_, std::abs(energy.ledger() - initial_ledger_));
  largest_energy_ = std::max({largest_energy_, energy.kinetic + energy.strain + energy.residual,
                              std::abs(energy.loads), std::abs(energy.contact), std::abs(energy.friction)});
  energy_lost_ = energy.contact;
  heat_ = energy.friction;
}

Summary SummaryObserver::summary() const {
  Summary out = out_;
  static_cast<ImpactFigures&>(out) = figures_.figures();
  if (checks_) {
    out.energy_drift = largest_energy_ > 0 ? worst_ledger_ / largest_energy_ : 0;
    const auto share = [put_in = figures_.energy_put_in()](double lost) -> std::optional<double> {
      if (lost == 0) return 0;
      return put_in > 0 ? std::optional(lost / put_in) : std::nullopt;
    };
    out.energy_lost_contact = share(energy_lost_);
    if (slipped_.size() > 0) {
      out.energy_lost_friction = share(heat_);
      out.friction_impulse_ns = friction_impulse_.colwise().norm().sum();
      out.max_slip_m = slipped_.maxCoeff();
    }
    if (acceleration_) out.acceleration = acceleration_->peaks();
    out.neglected = checks_->neglected();
    out.warnings = warnings(out);
    if (stress_) {
      out.stress = stress_->peaks();
      out.gauges = stress_->gauge_peaks();
      out.stress_envelope = stress_->envelopes();
    }
    if (out.contact_end_s) add_band(out);
  }
  if (!out.contact_start_s)
    out.warnings.push_back(fmt::format(
        "nothing touched: the smallest distance of a pair of points was {:.4g} m. Check velocity, gap, "
        "gravity and duration, and whether contact names the surfaces that meet",
        figures_.closest()));
  return out;
}

std::vector<std::string> SummaryObserver::warnings(const ImpactFigures& figures) const {
  std::vector<std::string> out;
  if (checks_) out = checks_->warnings(figures);
  if (stress_) std::ranges::move(stress_->warnings(), std::back_inserter(out));
  return out;
}

/// What modes above the band would take. With the restitution e, the bodies part with e² of the energy J v/(2
/// (1 + e)) with which they approach each other, for an impulse J and an approach v.
void SummaryObserver::add_band(Summary& out) const {
  const auto energy = band_->energy();
  if (!energy || !(figures_.energy_put_in() > 0)) return;
  out.energy_above_band = *energy / figures_.energy_put_in();
  if (!out.restitution || !(*out.restitution > 0)) return;
  const double e = *out.restitution, approaching = out.impulse_ns * *figures_.approach() / (2 * (1 + e));
  out.rebound_above_band = e - std::sqrt(std::max(0.0, e * e - *energy / approaching));
}

}  // namespace ricochet::contact
