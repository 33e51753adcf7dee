// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/run_checks.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace ricochet::contact {
namespace {

/// A touch has more steps than this, and the rigid motion hardly changes in between.
constexpr std::int64_t steps_between_obstacle_checks = 8;

}  // namespace

RunChecks::RunChecks(const Model& model, double step, double wave_speed, std::vector<MaterialLimits> limits)
    : rigid_(model),
      linearity_(model, wave_speed),
      resolution_(model),
      obstacles_(model),
      pressure_(model, std::move(limits)),
      ripple_(model, step),
      rotation_(model, wave_speed) {}

void RunChecks::observe(const Stepper& stepper, const FigureObserver& figures) {
  // Impulses are larger the shorter the step, so they are no measure of pressure, and their spectrum is flat.
  const bool compliant = stepper.options().contact.scheme == Scheme::compliant;
  const Vector& q = stepper.modal()->q;
  if (figures.touching()) {
    linearity_.observe(stepper, figures.before(), figures.begins());
    if (compliant) pressure_.observe(stepper.force(), stepper.time());
  }
  linearity_.observe_rotation(q, stepper.time());
  rotation_.observe(stepper);
  resolution_.observe(stepper, figures.before());
  if (compliant) ripple_.observe(stepper.time(), stepper.force().head(stepper.points()).sum());
  if (observed_++ % steps_between_obstacle_checks == 0)
    obstacles_.observe(rigid_.displacement(stepper), stepper.time());
}

std::vector<std::string> RunChecks::warnings(const ImpactFigures& figures) const {
  std::vector<std::string> out = linearity_.warnings();
  for (const auto& more : {pressure_.warnings(), resolution_.warnings(figures), ripple_.warnings(),
                           obstacles_.warnings(), rotation_.warnings()})
    std::ranges::copy(more, std::back_inserter(out));
  return out;
}

}  // namespace ricochet::contact
