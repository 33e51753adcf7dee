// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/dial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::contact {
namespace {

/// Shares of the accuracy allowed for the step, for fewer contact points and for single precision.
constexpr double of_step = 0.5, of_spacing = 0.1, of_precision = 0.05;

/// The first step tried is a period at the end of the kernels' band divided by `steps_a_period`, but a run
/// has at least `fewest_steps`. The step is halved until its share of the error is small enough or a run
/// takes `most_steps`.
constexpr double steps_a_period = 4, fewest_steps = 200, most_steps = 5e5;

Hertz chosen_rate(Estimator& estimator, const DialRequest& request, double duration) {
  double steps = std::max(fewest_steps, std::ceil(steps_a_period * request.band.value * duration));
  StepOptions options = request.options;
  for (;; steps *= 2) {
    const Hertz rate{std::min(steps, most_steps) / duration};
    if (steps >= most_steps) return rate;
    options.step = 1 / rate.value;
    const auto share = estimator.step(options);
    if (share && *share <= of_step * request.accuracy) return rate;
  }
}

/// Whether an impact with fewer contact points gives the same results. The quantities may agree even if the
/// forces do not, so the duration of contact must agree, too.
bool alike(const Quantities& all, const Quantities& fewer, double accuracy) {
  return distance(all, fewer) <= of_spacing * accuracy &&
         std::abs(fewer.longest_touch - all.longest_touch) <= accuracy * all.longest_touch;
}

Precision chosen_precision(Estimator& estimator, const DialRequest& request) {
  StepOptions options = request.options;
  options.precision = Precision::float32;
  const auto share = estimator.precision(options);
  return !share || *share > of_precision * request.accuracy ? Precision::float64 : Precision::float32;
}

}  // namespace

Dialled dial(const Subject& subject, Model model, DialRequest request) {
  auto estimator = std::make_unique<Estimator>(subject, std::move(model));
  Dialled out;
  const auto with_model = [&] {
    out.model = std::move(*estimator).take_model();
    return std::move(out);
  };
  StepOptions& options = request.options;
  if (request.choose_rate) {
    out.settings.rate = chosen_rate(*estimator, request, subject.duration);
    options.step = 1 / out.settings.rate->value;
  }
  const auto all = estimator->quantities(options);
  if (request.choose_precision) out.settings.precision = Precision::float64;
  if (!all || !all->touched()) return with_model();

  double by_coarsening = 0;
  while (request.choose_points) {
    std::unique_ptr<Estimator>& coarser = estimator->coarser();
    const auto fewer = coarser ? coarser->quantities(options) : std::nullopt;
    if (!fewer || !alike(*all, *fewer, request.accuracy)) break;
    by_coarsening = distance(*all, *fewer);
    estimator = std::exchange(coarser, nullptr);
  }
  if (request.choose_precision)
    options.precision = *(out.settings.precision = chosen_precision(*estimator, request));
  out.estimate = estimator->estimate(options);
  if (out.estimate->spacing) out.estimate->spacing = std::max(*out.estimate->spacing, by_coarsening);
  return with_model();
}

}  // namespace ricochet::contact
