// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/dial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::contact {
namespace {

double largest(const Errors& errors, const std::vector<Quantity>& requested) {
  double out = 0;
  for (const Quantity quantity : requested)
    if (const auto found = errors.find(quantity); found != errors.end()) out = std::max(out, found->second);
  return out;
}

/// Shares of the accuracy allowed for the step, for fewer contact points and for single precision. With fewer
/// points, the estimate of the spacing rises further than the results change, to at most `of_estimate`.
constexpr double of_step = 0.2, of_spacing = 0.1, of_estimate = 0.3, of_precision = 0.05;

/// The search for the step starts with `first_steps` steps of the run, and with `first_of_contact` steps of
/// the longest contact once that is known. The step is halved until its share of the error is small enough or
/// a run takes `most_steps`.
constexpr double first_steps = 100, first_of_contact = 8, most_steps = 2e6;

/// Number of steps of a run so short that bodies can meet and part in it, and their contact is resolved.
double steps_of_contact(Estimator& estimator, StepOptions options, double duration) {
  double steps = first_steps;
  // Some of the impulse schemes are unstable if a step misses a quarter of a period.
  if (options.scheme == Scheme::impulse)
    steps = std::max(
        steps, std::ceil(to_hertz(RadPerSecond{estimator.model().omega.maxCoeff()}).value * 4 * duration));
  for (; steps < most_steps; steps *= 2) {
    options = with_step(options, duration / steps);
    const auto& found = estimator.quantities(options);
    if (!found || !found->touched()) continue;
    const double enough = first_of_contact * duration / found->longest_touch;
    if (enough <= steps) return steps;
    // An unresolved contact lasts one step at least, so its duration is only known to be shorter.
    if (found->longest_touch > 1.5 * options.step)
      return std::exp2(std::ceil(std::log2(enough / steps))) * steps;
  }
  return most_steps;
}

Hertz chosen_rate(Estimator& estimator, const DialRequest& request, double duration,
                  const std::vector<Quantity>& requested) {
  double steps = request.rate.value > 0 ? std::max(1.0, std::round(request.rate.value * duration))
                                        : 4 * steps_of_contact(estimator, request.options, duration);
  StepOptions options = request.options;
  for (;; steps *= 2) {
    options = with_step(options, duration / std::min(steps, most_steps));
    if (steps >= most_steps) break;
    const auto errors = estimator.step(options);
    if (errors && largest(*errors, requested) <= of_step * request.accuracy) break;
  }
  return Hertz{1 / options.step};
}

/// Whether an impact with fewer contact points gives the same results. The quantities may agree even if the
/// forces do not, so the duration of contact must agree, too.
bool alike(const Quantities& all, const Quantities& fewer, const Subject& subject, double accuracy) {
  return largest(distances(all, fewer), subject.requested) <= of_spacing * accuracy &&
         std::abs(fewer.longest_touch - all.longest_touch) <= accuracy * all.longest_touch;
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
  auto estimator = std::make_unique<Estimator>(subject, std::move(model));
  Dialled out;
  const auto with_model = [&] {
    out.model = std::move(*estimator).take_model();
    return std::move(out);
  };
  StepOptions& options = request.options;
  if (request.choose_rate) {
    out.settings.rate = chosen_rate(*estimator, request, subject.duration, subject.requested);
    options = with_step(options, 1 / out.settings.rate->value);
  }
  const auto all = estimator->quantities(options);
  if (request.choose_precision) out.settings.precision = Precision::float64;
  if (!all || !all->touched()) return with_model();

  std::optional<Errors> by_coarsening;
  while (request.choose_points) {
    std::unique_ptr<Estimator>& coarser = estimator->coarser();
    const auto fewer = coarser ? coarser->quantities(options) : std::nullopt;
    if (!fewer || !alike(*all, *fewer, subject, request.accuracy)) break;
    const auto left = coarser->spacing(options);
    if (!left || largest(*left, subject.requested) > of_estimate * request.accuracy) break;
    by_coarsening = distances(*all, *fewer);
    estimator = std::exchange(coarser, nullptr);
  }
  if (request.choose_precision)
    options.precision = *(out.settings.precision = chosen_precision(*estimator, request, subject.requested));
  out.estimate = estimator->estimate(options);
  out.mesh_change = estimator->mesh_change();
  out.quantities = estimator->quantities(options);
  if (auto& spacing = out.estimate->by_cause.at(Cause::spacing); spacing && by_coarsening)
    for (auto& [quantity, error] : *spacing) error = std::max(error, by_coarsening->at(quantity));
  return with_model();
}

}  // namespace ricochet::contact
