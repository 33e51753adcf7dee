// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/quantities.hpp"

#include <algorithm>
#include <cmath>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/figure_observer.hpp"
#include "contact/figures/receivers.hpp"
#include "contact/figures/spectrum.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/run_steps.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {
namespace {

/// Part of the contact that a touch has at least if it decides the impact.
constexpr double of_deciding_touch = 0.75;

/// Between two looks at the rotation of the bodies, which hardly changes meanwhile.
constexpr std::int64_t steps_between_turns = 8;

/// Gathers the quantities of an impact step by step.
class QuantityObserver {
 public:
  QuantityObserver(const Model& model, const StepOptions& options, bool receivers)
      : model_(model),
        step_(options.step),
        figures_(model, options.step),
        pressed_(model.gap.size(), false),
        impulse_(Vector::Zero(model.rows())),
        linearity_(model, 0) {
    if (receivers && !model.receivers.empty()) receivers_.emplace(model, options);
    heard_.resize(3 * model.receivers.size());
  }

  void observe(const Stepper& stepper) {
    figures_.observe(stepper);
    const std::int64_t passed = stepper.steps() - last_;
    last_ = stepper.steps();
    open_ += passed;
    if (receivers_) listen(stepper, passed);
    if (observed_++ % steps_between_turns == 0)
      linearity_.observe_rotation(stepper.modal()->q, stepper.time());
    if (!figures_.touching()) return;
    force_.resize(force_.size() + static_cast<std::size_t>(open_), 0.0);
    force_.back() = stepper.force().head(stepper.points()).sum();
    touch_ = open_ - 1 > std::max<std::int64_t>(2, touch_ / 10) ? 1 : touch_ + open_;
    open_ = 0;
    longest_ = std::max(longest_, static_cast<double>(touch_) * step_);
    linearity_.observe(stepper, figures_.before(), figures_.begins());
    impulse_ += step_ * stepper.force();
    for (Eigen::Index i = 0; i < stepper.points(); ++i)
      if (stepper.force()[i] > 0) pressed_[static_cast<std::size_t>(i)] = true;
  }

  Quantities quantities() const {
    Quantities out{.figures = figures_.figures().quantities,
                   .longest_touch = longest_,
                   .pressed = pressed_,
                   .force = force_,
                   .impulse = impulse_,
                   .nearer = linearity_.nearer(),
                   .turn = linearity_.farthest_turn()};
    if (receivers_) out.figures[Quantity::receivers] = bands();
    if (force_.empty()) {
      out.missed_by = figures_.closest();
      out.spacing_there = std::sqrt(model_.area[figures_.closest_point()]);
    }
    return out;
  }

 private:
  void listen(const Stepper& stepper, std::int64_t passed) {
    receivers_->observe(stepper);
    for (std::size_t k = 0; k < receivers_->size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        heard_[3 * k + axis].resize(heard_[3 * k + axis].size() + static_cast<std::size_t>(passed),
                                    (*receivers_)[k].velocity[static_cast<Eigen::Index>(axis)]);
  }

  Figure bands() const {
    Figure out;
    for (const std::vector<double>& velocity : heard_) {
      const Vector one = third_octaves(velocity, step_);
      out.value.conservativeResize(out.value.size() + one.size());
      out.value.tail(one.size()) = one;
    }
    out.scale = out.value.norm();
    return out;
  }

  const Model& model_;
  double step_;
  FigureObserver figures_;
  std::vector<bool> pressed_;
  Vector impulse_;
  LinearityCheck linearity_;
  std::vector<double> force_;
  std::optional<Receivers> receivers_;
  std::vector<std::vector<double>> heard_;  ///< velocity of each axis of each receiver [m/s]
  double longest_ = 0;
  std::int64_t last_ = 0, touch_ = 0, open_ = 0;  ///< steps made, of the last touch, and since its last force
  std::int64_t observed_ = 0;                     ///< number of steps and flights
};

}  // namespace

bool Quantities::touched() const {
  const auto push = figures.find(figures.contains(Quantity::impulse) ? Quantity::impulse : Quantity::force);
  return push != figures.end() && push->second.value.maxCoeff() > 0;
}

bool Quantities::touches_repeat() const {
  const auto duration = figures.find(Quantity::duration);
  return duration != figures.end() && longest_touch < of_deciding_touch * duration->second.value.maxCoeff();
}

Errors distances(const Quantities& a, const Quantities& b) {
  Errors out;
  for (const auto& [quantity, reference] : a.figures)
    out[quantity] = relative_error(b.figures.at(quantity).value, reference.value, reference.scale);
  return out;
}

std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, bool receivers,
                                            const std::function<void()>& poll) {
  const std::shared_ptr<const Model> folded = fold(borrowed(model), options);
  const std::unique_ptr<Stepper> stepper = make_stepper(folded, options);
  QuantityObserver observer(*folded, options, receivers);
  const auto observe = [&](std::int64_t) {
    if (poll) poll();
    observer.observe(*stepper);
  };
  if (run_steps(*stepper, steps, observe).status != StepStatus::ok) return std::nullopt;
  return observer.quantities();
}

Quantities rest_quantities(const Model& model) {
  return {.figures = summarise(model, find_equilibrium(model)).quantities()};
}

}  // namespace ricochet::contact
