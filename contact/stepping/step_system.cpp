// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/step_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/format.hpp"
#include "contact/law/mean_force.hpp"
#include "contact/stepping/forced_response.hpp"
#include "contact/stepping/propagator.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Share of the mean diagonal of A that is added to it. If there are more points than modes, A is singular
/// and determines only Bᵀ P; this term selects the P of least norm and leaves 1e-12 of the approach velocity.
constexpr double least_norm = 1e-12;

void check(const Model& model, const StepOptions& o) {
  if (!(o.step > 0) || !std::isfinite(o.step))
    throw InputError(
        base::format("time step = {} s: must be positive and finite. Set time.rate_hz above 0.", o.step));
  if (o.max_pivots < 1)
    throw InputError(base::format("contact.max_pivots = {}: must be at least 1.", o.max_pivots));
  if (o.steps_per_sample < 1 || (o.steps_per_sample > 1 && o.scheme != Scheme::compliant))
    throw InputError(base::format(
        "contact steps per sample = {}: must be at least 1, and 1 with contact.scheme = \"impulse\".",
        o.steps_per_sample));
  if (o.scheme == Scheme::at_rest)
    throw InputError("contact.scheme = \"static\": has no steps. Choose \"compliant\" or \"impulse\".");
  if (o.scheme != Scheme::impulse) return;
  if (!model.friction.empty())
    throw InputError(
        "contact.friction: needs contact.scheme = \"compliant\" or \"static\". Choose one, or leave friction "
        "out.");
  if (!(o.restitution >= 0 && o.restitution <= 1))
    throw InputError(base::format("contact.restitution = {}: must be between 0 and 1.", o.restitution));
  const double highest = model.omega.size() > 0 ? model.omega.maxCoeff() : 0;
  if (o.admittance == Admittance::difference && highest * o.step >= std::numbers::pi)
    throw InputError(base::format(
        "contact.admittance = \"difference\": omega_max * step = {:.4g} is not below pi (highest mode {:.6g} "
        "Hz). Use a step "
        "below {:.4g} s (time.rate_hz above {:.6g}), fewer modes, or \"jump\".",
        highest * o.step, highest / (2 * std::numbers::pi), std::numbers::pi / highest,
        highest / std::numbers::pi));
}

}  // namespace

void ModeConstants::set_step(Eigen::Index n, double omega, double decay, double step) noexcept {
  const ModeStep k = mode_step(omega, decay, step);
  b(n) = h(n) = k.S;
  c(n) = k.c;
  e(n) = k.rate;
  damp_ss(n) = 2 * decay * k.ss;
  damp_sr(n) = 4 * decay * k.sr;
  damp_rr(n) = 2 * decay * k.rr;
}

bool conserves(const Model& model, const StepOptions& options) {
  return options.scheme == Scheme::compliant && options.contact_step == ContactStep::conserving &&
         (!model.R.isZero(0) ||
          std::ranges::any_of(model.omega, [&](double omega) { return !sampled(omega, options.step); }));
}

std::shared_ptr<const StepSystem> make_step_system(const Model& model, const StepOptions& options) {
  check(model, options);
  const bool compliant = options.scheme == Scheme::compliant;
  const Eigen::Index N = model.omega.size(), m = model.gap.size();
  StepSystem out;
  out.omega = model.omega;
  out.decay = model.decay;
  for (Vector* x : out.all()) x->setZero(N);
  out.stiffness = model.omega.cwiseAbs2();
  out.load = model.load;
  out.q0 = model.q0;
  out.v0 = model.v0;
  out.B = model.B;
  out.gap = model.gap;
  if (compliant)
    out.springs = model.springs();
  else if (model.bulge.size() > 0)
    out.gap += model.bulge;
  out.R = model.R;
  out.friction = model.friction;
  out.belts = model.belts;
  assert(out.B.rows() == m + 2 * std::ssize(out.friction) && out.B.cols() == N);
  assert(out.R.rows() == out.B.rows() && out.R.cols() == out.B.rows());
  assert(out.load.size() == N && out.q0.size() == N && model.v0.size() == N && out.decay.size() == N);
  for (Eigen::Index n = 0; n < N; ++n) {
    const double omega = model.omega(n), delta = model.decay(n);
    if (compliant && !sampled(omega, options.step)) {
      // The mode has only its static displacement (f_n − Σ B_in λ_i)/ω², which moves the points through s
      // (ForcedResponse) and R.
      out.R.noalias() += out.B.col(n) * out.B.col(n).transpose() / out.stiffness(n);
      out.B.col(n).setZero();
      out.stiffness(n) = out.load(n) = out.q0(n) = out.v0(n) = 0;
      ++out.dropped;
      continue;
    }
    out.set_step(n, omega, delta, options.step);
    out.damped = out.damped || delta > 0;
  }
  if (compliant) {
    out.M = out.B * out.c.asDiagonal() * out.B.transpose();
    out.S = out.M + out.R;
    if (conserves(model, options)) out.S_mean = conserving_mean.end * out.M + out.R;
  } else if (options.admittance == Admittance::jump) {
    out.S = out.B * out.B.transpose();
  } else {
    out.S = out.B * (out.b / options.step).asDiagonal() * out.B.transpose();
  }
  if (!compliant && m > 0) {
    out.S.diagonal().array() += least_norm * out.S.diagonal().mean();
    out.norm = out.B.rowwise().norm();
  }
  out.s = ForcedResponse(model, options.step, compliant).start().s;
  return std::make_shared<const StepSystem>(std::move(out));
}

Energy initial_energy(const Model& model, const StepOptions& options) {
  Energy out{.kinetic = 0.5 * model.v0.squaredNorm()};
  for (Eigen::Index n = 0; n < model.omega.size(); ++n)
    if (options.scheme != Scheme::compliant || sampled(model.omega(n), options.step))
      out.strain += 0.5 * model.omega(n) * model.omega(n) * model.q0(n) * model.q0(n);
  return out;
}

}  // namespace ricochet::contact
