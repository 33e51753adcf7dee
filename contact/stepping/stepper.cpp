// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/stepper.hpp"

#include "contact/stepping/compliant_stepper.hpp"
#include "contact/stepping/event_stepper.hpp"
#include "contact/stepping/impulse_stepper.hpp"
#include "contact/stepping/look_ahead_stepper.hpp"

namespace ricochet::contact {

Stepper::Stepper(const StepOptions& options, Eigen::Index points, const SolveOptions& solver)
    : options_(options), solver_(static_cast<int>(points), solver) {
  for (Vector* x : {&contact_.force, &u_, &next_force_, &next_u_}) x->setZero(points);
}

StepStatus Stepper::complete(int active, double persistency, const SolveResidual& residual) noexcept {
  contact_.active = active;
  contact_.persistency = persistency;
  contact_.residual = residual;
  contact_.force.swap(next_force_);
  u_.swap(next_u_);
  ++steps_;
  return StepStatus::ok;
}

std::unique_ptr<Stepper> make_stepper(const Model& model, const StepOptions& options) {
  if (options.scheme == Scheme::impulse) {
    if (options.instant == Instant::exact) return std::make_unique<EventStepper>(model, options);
    return std::make_unique<ImpulseStepper>(model, options);
  }
  if (options.block == 1 || model.gap.size() == 0) return std::make_unique<CompliantStepper>(model, options);
  if (options.precision == Precision::float64)
    return std::make_unique<LookAheadStepper<double>>(model, options);
  return std::make_unique<LookAheadStepper<float>>(model, options);
}

}  // namespace ricochet::contact
