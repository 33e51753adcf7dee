// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/stepper.hpp"

#include <utility>

#include "base/archive.hpp"
#include "contact/stepping/compliant_stepper.hpp"
#include "contact/stepping/event_stepper.hpp"
#include "contact/stepping/floating_stepper.hpp"
#include "contact/stepping/impulse_stepper.hpp"
#include "contact/stepping/look_ahead_stepper.hpp"

namespace ricochet::contact {

Stepper::Stepper(const StepOptions& options, Eigen::Index points, const SolveOptions& solver, bool conserving)
    : options_(options), points_(points), law_(points, solver), contact_{.mean = {points, conserving}} {
  for (Vector* x : {&contact_.force, &u_, &next_force_, &next_end_, &next_u_}) x->setZero(points);
}

Stepper::Stepper(const StepOptions& options, const Model& model)
    : options_(options),
      points_(model.points()),
      law_(model, options),
      contact_{.mean = {model, conserves(model, options)},
               .slip = {std::ssize(model.friction), model.rows(), options.step}} {
  for (Vector* x : {&contact_.force, &u_, &next_force_, &next_end_, &next_u_}) x->setZero(model.rows());
}

SolveStatistics Stepper::solver() const noexcept { return law_.statistics(); }

void Stepper::archive(base::Archive& a) { a.fail(); }

void Stepper::archive_contact(base::Archive& a) {
  a(steps_, law_, contact_, u_, next_force_, next_end_, next_u_);
}

void Stepper::land(int steps) noexcept {
  contact_.force.setZero();
  contact_.active = 0;
  contact_.persistency = 0;
  contact_.residual = {};
  contact_.slip.clear();
  steps_ += steps;
}

StepStatus Stepper::complete(int active, double persistency, const SolveResidual& residual) noexcept {
  end_contact(active, persistency, residual);
  u_.swap(next_u_);
  ++steps_;
  return StepStatus::ok;
}

void Stepper::end_contact(int active, double persistency, const SolveResidual& residual) noexcept {
  contact_.active = active;
  contact_.persistency = persistency;
  contact_.residual = residual;
  law_.accept(contact_.mean, next_end_);
  contact_.slip.accept();
  contact_.force.swap(next_force_);
}

std::unique_ptr<Stepper> make_stepper(std::shared_ptr<const Model> model, const StepOptions& options) {
  model = fold(std::move(model), options);
  if (options.rigid.rotation == Rotation::finite)
    return std::make_unique<FloatingStepper>(std::move(model), options);
  if (options.contact.scheme == Scheme::impulse) {
    if (options.contact.instant == Instant::exact)
      return std::make_unique<EventStepper>(std::move(model), options);
    return std::make_unique<ImpulseStepper>(std::move(model), options);
  }
  if (options.block == 1 || model->points() == 0)
    return std::make_unique<CompliantStepper>(std::move(model), options);
  if (options.precision == Precision::float64)
    return std::make_unique<LookAheadStepper<double>>(std::move(model), options);
  return std::make_unique<LookAheadStepper<float>>(std::move(model), options);
}

std::unique_ptr<Stepper> make_stepper(const Model& model, const StepOptions& options) {
  return make_stepper(std::make_shared<const Model>(model), options);
}

}  // namespace ricochet::contact
