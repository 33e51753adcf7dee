// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/dial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ricochet::contact {
namespace {

double largest(const Errors& errors, const std::vector<Quantity>& requested) {
  double out = 0;
  for (const Quantity quantity : requested)
    if (const auto found = errors.find(quantity); found != errors.end()) out = std::max(out, found->second);
  return out;
}

/// Shares of the accuracy allowed for the step, for fewer contact points and for single precision.
constexpr double of_step = 0.2, of_spacing = 0.1, of_precision = 0.05;

/// The search for the step starts with at least `first_steps` steps of the run. Once the longest contact has
/// `enough_to_see` of them, its duration is known, and the search goes on with `first_of_contact` in it. The
/// step is halved until its share of the error is small enough, a run takes `most_steps`, or `idle_halvings`
/// in succession beyond `few_steps` have not reduced the share to `at_least` of its smallest value: where a
/// front meets truncated modes, short steps resolve their ripple, and the share no longer falls. Runs of few
/// steps cost nothing, and their share may fall only after several halvings.
constexpr double first_steps = 100, enough_to_see = 8, first_of_contact = 48, few_steps = 1e4,
                 most_steps = 2e6, at_least = 0.7;
constexpr int idle_halvings = 2;

/// Steps of a quarter of the shortest period, at which the impulse schemes are stable.
double stable_steps(const Model& model, double duration) {
  return std::ceil(to_hertz(RadPerSecond{model.omega.maxCoeff()}).value * 4 * duration);
}

/// Number of steps of a run with `first_of_contact` steps in the longest contact.
double steps_of_contact(Estimator& estimator, StepOptions options, double duration, double first) {
  for (double steps = first; steps < most_steps; steps *= 2) {
    options = with_step(options, duration / steps);
    const auto& found = estimator.quantities(options);
    // An unresolved contact lasts one step at least, so its duration is only known to be shorter.
    if (found && found->touched() && found->longest_touch >= enough_to_see * options.step)
      return std::ceil(first_of_contact * duration / found->longest_touch);
  }
  return most_steps;
}

Hertz chosen_rate(Estimator& estimator, const DialRequest& request, double duration,
                  const std::vector<Quantity>& requested) {
  const double known = std::round(request.rate.value * duration);
  double first = std::max(first_steps, std::round(known / 8)), steps = 0;
  if (request.options.contact.scheme == Scheme::impulse) {
    first = std::max(first, stable_steps(estimator.model(), duration));
    steps = std::max(known, 4 * first);
  } else {
    // A known rate may be that of a shorter contact. No step is longer than a given output sample.
    const double sample = request.options.steps_per_sample * request.options.step;
    steps = std::max(std::round(known / 4), request.choose_samples ? first : std::ceil(duration / sample));
  }
  steps = std::max(steps, steps_of_contact(estimator, request.options, duration, first));
  StepOptions options = request.options, best = options;
  double least = std::numeric_limits<double>::infinity();
  for (int idle = 0;; steps *= 2) {
    options = with_step(options, duration / std::min(steps, most_steps));
    if (steps >= most_steps) break;
    const auto errors = estimator.step(options);
    const double share = errors ? largest(*errors, requested) : std::numeric_limits<double>::infinity();
    if (share <= of_step * request.accuracy) break;
    if (share < at_least * least) {
      least = share;
      best = options;
      idle = 0;
    } else if (steps > few_steps && ++idle >= idle_halvings && std::isfinite(least)) {
      options = best;
      break;
    }
  }
  return Hertz{1 / options.step};
}

/// With fewer pressed points, the distance of the points decides on force and duration.
constexpr auto fewest_pressed = 4;

/// Whether an impact with fewer contact points gives the same results. The quantities may agree even if the
/// forces do not, so the duration of contact must agree, too, and several points must be pressed.
bool alike(const Quantities& all, const Quantities& fewer, const Subject& subject, double accuracy) {
  return std::ranges::count(fewer.pressed, true) >= fewest_pressed &&
         largest(distances(all, fewer), subject.requested) <= of_spacing * accuracy &&
         std::abs(fewer.longest_touch - all.longest_touch) <= accuracy * all.longest_touch;
}

/// Part of the accuracy. Changes by modes that are this small would have to grow tenfold to matter.
constexpr double negligible = 0.1;

/// Makes the share of the modes unknown if it decides that the accuracy is met, although its changes still
/// grow from band to band, which bounds no further change.
void refuse_growing_changes(ErrorEstimate& estimate, double change, double accuracy) {
  if (change > negligible * accuracy && estimate.scatter() * estimate.total() <= accuracy)
    estimate.by_cause.at(Cause::modes).reset();
}

Precision chosen_precision(Estimator& estimator, const DialRequest& request,
                           const std::vector<Quantity>& requested) {
  StepOptions options = request.options;
  options.precision = Precision::float32;
  const auto errors = estimator.precision(options);
  const bool enough = errors && largest(*errors, requested) <= of_precision * request.accuracy;
  return enough ? Precision::float32 : Precision::float64;
}

}  // namespace

Dialled dial(const Subject& subject, Model model, DialRequest request) {
  Estimator of_all(subject, std::move(model));
  Estimator* estimator = &of_all;
  Dialled out;
  const auto with_model = [&] {
    out.model = std::move(*estimator).take_model();
    return std::move(out);
  };
  try {
    StepOptions& options = request.options;
    if (request.choose_rate) {
      out.rate = chosen_rate(*estimator, request, subject.duration, subject.requested);
      options = with_step(options, 1 / out.rate->value);
    }
    const auto all = estimator->quantities(options);
    if (request.choose_precision) out.precision = Precision::float64;
    if (!all || !all->touched()) {
      out.quantities = all;
      return with_model();
    }

    while (request.choose_points) {
      Estimator* const coarser = estimator->coarser();
      const auto fewer = coarser != nullptr ? coarser->quantities(options) : std::nullopt;
      if (!fewer || !alike(*all, *fewer, subject, request.accuracy)) break;
      estimator = coarser;
    }
    if (request.choose_precision)
      options.precision = *(out.precision = chosen_precision(*estimator, request, subject.requested));
    out.estimate = estimator->estimate(options);
    out.mesh_near_contact = estimator->mesh_near_contact();
    out.on_sharp_edge = of_all.on_sharp_edge();
    out.quantities = estimator->quantities(options);
    refuse_growing_changes(*out.estimate, estimator->growing_change(), request.accuracy);
  } catch (TurnsTooFar& turned) {
    out.quantities = std::move(turned.run);
  }
  return with_model();
}

}  // namespace ricochet::contact
