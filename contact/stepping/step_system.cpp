// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/step_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/format.hpp"
#include "contact/law/mean_force.hpp"
#include "contact/stepping/propagator.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

void check(const Model& model, const StepOptions& o) {
  if (!(o.step > 0) || !std::isfinite(o.step))
    throw InputError(
        base::format("time step = {} s: must be positive and finite. Set time.rate_hz above 0.", o.step));
  if (o.contact.max_pivots < 1)
    throw InputError(base::format("contact.max_pivots = {}: must be at least 1.", o.contact.max_pivots));
  if (o.steps_per_sample < 1 || (o.steps_per_sample > 1 && o.contact.scheme != Scheme::compliant))
    throw InputError(base::format(
        "contact steps per sample = {}: must be at least 1, and 1 with contact.scheme = \"impulse\".",
        o.steps_per_sample));
  if (o.contact.scheme == Scheme::at_rest)
    throw InputError("contact.scheme = \"static\": has no steps. Choose \"compliant\" or \"impulse\".");
  if (o.contact.scheme != Scheme::impulse) return;
  if (!model.friction.empty())
    throw InputError(
        "contact.friction: needs contact.scheme = \"compliant\" or \"static\". Choose one, or leave friction "
        "out.");
  if (!(o.contact.restitution >= 0 && o.contact.restitution <= 1))
    throw InputError(
        base::format("contact.restitution = {}: must be between 0 and 1.", o.contact.restitution));
  const double highest = model.omega.size() > 0 ? model.omega.maxCoeff() : 0;
  if (o.contact.admittance == Admittance::difference && highest * o.step >= std::numbers::pi)
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
  if (options.contact.scheme != Scheme::compliant || options.contact.integration != ContactStep::conserving)
    return false;
  if (!model.turns) return !model.R.isZero(0);
  return !model.folded.modes.empty() || std::ranges::any_of(model.bodies, [](const Bodies::Block& body) {
    return body.kernel->surface.has_flexibility();
  });
}

std::shared_ptr<const StepSystem> make_step_system(std::shared_ptr<const Model> shared,
                                                   const StepOptions& options) {
  const Model& model = *shared;
  check(model, options);
  const bool compliant = options.contact.scheme == Scheme::compliant;
  const Eigen::Index N = model.omega.size(), m = model.points();
  assert(model.turns || (model.B.rows() == model.rows() && model.B.cols() == N));
  assert(model.turns || (model.R.rows() == model.rows() && model.R.cols() == model.rows()));
  assert(model.load.size() == N && model.q0.size() == N && model.v0.size() == N && model.decay.size() == N);
  StepSystem out;
  out.model = std::move(shared);
  for (Vector* x : out.all()) x->setZero(N);
  out.stiffness = model.omega.cwiseAbs2();
  out.load = model.load;
  out.q0 = model.q0;
  out.gap = model.gap;
  if (compliant)
    out.springs = model.springs();
  else if (model.bulge.size() > 0)
    out.gap += model.bulge;
  for (Eigen::Index n = 0; n < N; ++n) {
    out.set_step(n, model.omega(n), model.decay(n), options.step);
    out.damped = out.damped || model.decay(n) > 0;
  }
  for (const int n : model.folded.modes)
    for (Vector* x : out.all()) (*x)(n) = 0;
  out.conserving = conserves(model, options);
  if (!compliant) out.norm = model.B.topRows(m).rowwise().norm();
  return std::make_shared<const StepSystem>(std::move(out));
}

RowMatrices::RowMatrices(const StepSystem& system)
    : M(system.model->B * system.c.asDiagonal() * system.model->B.transpose()),
      R(system.model->R),
      S(M + R),
      S_mean(system.conserving ? conserving_mean.end * M + R : Eigen::MatrixXd()) {}

Energy initial_energy(const Model& model) {
  return {.kinetic = 0.5 * model.v0.squaredNorm(),
          .strain = 0.5 * model.omega.cwiseProduct(model.q0).squaredNorm()};
}

}  // namespace ricochet::contact
