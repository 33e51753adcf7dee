// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/first_touch.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/format.hpp"
#include "contact/accuracy/estimate.hpp"
#include "contact/figures/figure_observer.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/model/folding.hpp"
#include "contact/motion/floating_body.hpp"
#include "contact/stepping/run_steps.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Share of its radius that a free body has to go before it touches.
constexpr double share_of_radius = 0.01;

/// Steps with which a touch is resolved well enough to know its end, and the factor by which steps get
/// shorter until they do.
constexpr double enough_steps = 16;
constexpr int shorter = 8, most_per_sample = 100000;

constexpr double degrees = 180 / std::numbers::pi;

/// Sets the poses shortly before the bodies touch in the poses `then`, at the start of the touch; under
/// loads, those at the start of the run.
void set_poses(const Model& model, std::span<const Pose> then, double start, FirstTouch& out) {
  double margin = start;
  for (std::size_t k = 0; k < then.size(); ++k) {
    if (model.bodies[k].supported || !model.forcing.empty()) continue;
    const double radius = model.bodies[k].radius(),
                 speed = then[k].velocity.norm() + radius * then[k].spin.norm();
    if (speed > 0) margin = std::min(margin, share_of_radius * radius / speed);
  }
  out.from = start - margin;
  for (FloatingBody& body : floating_bodies(model)) {
    if (out.from > 0) body.fly(out.from);
    out.poses.push_back(body.pose());
  }
}

/// The largest angle by which a body has turned since the start [rad].
double turned(const FirstTouch& touch, std::span<const Pose> now) {
  double out = 0;
  for (std::size_t k = 0; k < now.size(); ++k)
    out = std::max(out, touch.poses[k].attitude.angularDistance(now[k].attitude));
  return out;
}

struct Found {
  std::optional<FirstTouch> touch;
  double steps = 0;  ///< of the touch
};

Found find(const Model& model, const StepOptions& options, double duration,
           const std::function<void()>& poll) {
  const std::unique_ptr<Stepper> stepper = make_stepper(borrowed(model), options);
  const double step = options.step;
  Found out;
  std::vector<bool> pressed(model.pairs.size(), false);
  double start = 0, last = 0;  // of the forces
  const std::int64_t samples = step_count(duration, 1 / (step * options.steps_per_sample));
  bool over = false;
  while (!over && stepper->steps() < samples * options.steps_per_sample) {
    if (stepper->step() != StepStatus::ok) break;
    if (poll) poll();
    const double now = stepper->time();
    for (std::size_t p = 0; p < model.pairs.size(); ++p) {
      const Model::PairBlock& pair = model.pairs[p];
      if (!(stepper->force().segment(pair.first_point, pair.points).array() > 0).any()) continue;
      if (!out.touch) {
        set_poses(model, stepper->poses(), start = now - step, out.touch.emplace());
        if (const double angle = turned(*out.touch, stepper->poses()); angle > largest_linear_rotation)
          throw InputError(base::format(
              "accuracy: loads turn a body by {:.3g} degrees before it touches, and errors are "
              "estimated up to {:.3g}: give modes.up_to_hz or modes.count and accuracy = \"off\"",
              angle * degrees, largest_linear_rotation * degrees));
      }
      pressed[p] = true;
      last = now;
    }
    if (!out.touch) continue;
    const double wait = std::max(last - start, 2 * step);
    over = now >= last + wait;
    out.touch->until = over ? last + wait : now;
    const double angle = turned(*out.touch, stepper->poses());
    if (last == now) out.touch->turned = angle;
    over = over || angle > largest_linear_rotation;
  }
  if (!out.touch) return out;
  out.touch->end = last;
  out.steps = (last - start) / step;
  for (std::size_t p = 0; p < pressed.size(); ++p)
    if (pressed[p]) out.touch->pairs.push_back(p);
  return out;
}

struct Parting {
  std::optional<double> time;
  double steps = 0;  ///< with a force
};

Parting find_parting_with(const Model& model, const StepOptions& options, double longest,
                          const std::function<void()>& poll) {
  const std::shared_ptr<const Model> folded = fold(borrowed(model), options);
  const std::unique_ptr<Stepper> stepper = make_stepper(folded, options);
  FigureObserver figures(*folded, options.step);
  Parting out;
  run_steps(*stepper, step_count(longest, 1 / options.step), [&](std::int64_t) {
    if (poll) poll();
    figures.observe(*stepper);
    if (figures.touching()) ++out.steps;
    if (figures.parted(*stepper)) out.time = stepper->time();
    return !out.time;
  });
  return out;
}

}  // namespace

std::optional<FirstTouch> find_first_touch(const Model& model, StepOptions options, double duration,
                                           const std::function<void()>& poll) {
  Found out = find(model, options, duration, poll);
  while (out.touch && out.steps < enough_steps && options.steps_per_sample < most_per_sample) {
    options.steps_per_sample *= shorter;
    options.step /= shorter;
    out = find(model, options, duration, poll);
  }
  return out.touch;
}

std::optional<double> find_parting(const Model& model, StepOptions options, double longest,
                                   const std::function<void()>& poll) {
  const double finest = options.step / most_per_sample;
  Parting out = find_parting_with(model, options, longest, poll);
  while (out.steps > 0 && out.steps < enough_steps && options.step > finest) {
    options = with_step(options, options.step / shorter);
    out = find_parting_with(model, options, longest, poll);
  }
  return out.time;
}

}  // namespace ricochet::contact
