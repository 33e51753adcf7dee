// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/model/coarsening.hpp"
#include "contact/stepping/run_steps.hpp"
#include "kernels/algebra.hpp"
#include "kernels/band.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

/// Relative change of frequencies that makes their small errors visible.
constexpr double visible = 1e-3;

/// Ratio of the unit round-off of double precision to that of single precision, and the latter.
constexpr double double_over_single = 0x1p-29, single_round_off = 0x1p-24;

/// The change that repeated refinement by a factor of two would still make: d (ρ + ρ² + …) with the last
/// change d and its ratio ρ to the previous change, ½ if that is unknown. Either change may be small by
/// chance, so ρ is at most ½ and d at least a quarter of the previous change.
double remaining_change(double change, double before) {
  const double last = std::max(change, before / 4), pace = before > 0 ? std::min(last / before, 0.5) : 0.5;
  return last * pace / (1 - pace);
}

/// Relative errors of ω: half of Kato and Temple's bound r² λ/gap for λ, but at most half of the residual r.
std::vector<double> frequency_errors(const kernels::Modes& modes, double low_rank) {
  const std::vector<double>& omega = modes.angular_frequency;
  std::vector<double> error(omega.size(), 0.0);
  for (std::size_t n = 0; n < omega.size(); ++n) {
    if (omega[n] == 0) continue;
    if (modes.contact_adapted()) {
      error[n] = low_rank / 2;
      continue;
    }
    const double lambda = omega[n] * omega[n], r = modes.residual.empty() ? 0 : modes.residual[n];
    double gap = lambda;
    for (std::size_t other : {n - 1, n + 1})
      if (other < omega.size()) {
        const double apart = std::abs(omega[other] * omega[other] - lambda);
        if (apart > kernels::multiple_mode * lambda) gap = std::min(gap, apart);
      }
    error[n] = std::min(r, r * r * lambda / gap) / 2;
  }
  return error;
}

/// A share of the highest frequency or, for a contact-adapted basis, of its band.
RadPerSecond end_of(const kernels::Kernel& kernel, double share) {
  const kernels::Modes& modes = kernel.modes;
  if (modes.contact_adapted())
    return RadPerSecond{share * RadPerSecond(Hertz{modes.certificate.upto_hz}).value};
  return RadPerSecond{modes.size() > 0 ? share * modes.angular_frequency.back() : 0};
}

/// Changes each frequency by `factor` times its error, up or down at random.
void detune(kernels::Modes& modes, const std::vector<double>& error, double factor) {
  std::minstd_rand random;
  for (std::size_t n = 0; n < error.size(); ++n)
    modes.angular_frequency[n] *= 1 + (random() % 2 == 0 ? factor : -factor) * error[n];
}

StepOptions divided(StepOptions options, double parts) {
  options.step /= parts;
  return options;
}

std::optional<Quantities> mean_of(const std::optional<Quantities>& one,
                                  const std::optional<Quantities>& other) {
  if (!one || !other) return std::nullopt;
  return Quantities{0.5 * one->value + 0.5 * other->value, one->scale, one->longest_touch};
}

}  // namespace

double left_by_order(int order) {
  // From order 1 to 2, the results of balls improved by a factor of 10 to 40, because linear tetrahedra lock.
  // Each further order improved those of disks by a factor of 3 to 5.
  return order == 1 ? 1 : order == 2 ? 1.0 / 8 : 1.0 / 3;
}

Estimator::Estimator(const Subject& subject, Model model, int coarsenings)
    : subject_(subject), model_(std::move(model)), coarsenings_(coarsenings) {}

std::unique_ptr<Estimator>& Estimator::coarser() {
  if (!coarser_) {
    coarser_.emplace();
    Model wide = coarsened(model_);
    if (wide.gap.size() < model_.gap.size())
      *coarser_ = std::make_unique<Estimator>(subject_, std::move(wide), coarsenings_ + 1);
  }
  return *coarser_;
}

std::optional<Quantities> Estimator::run(const Model& model, const StepOptions& options) const {
  if (subject_.at_rest) return rest_quantities(model);
  return impact_quantities(model, options, step_count(subject_.duration, 1 / options.step), subject_.poll);
}

const std::optional<Quantities>& Estimator::quantities(const StepOptions& options) {
  const std::pair key{options.step, options.precision};
  const auto known = quantities_.find(key);
  return known != quantities_.end() ? known->second
                                    : quantities_.emplace(key, run(model_, options)).first->second;
}

std::optional<Quantities> Estimator::base(const StepOptions& options) {
  return subject_.at_rest ? quantities(options)
                          : mean_of(quantities(options), quantities(divided(options, 2)));
}

std::optional<Quantities> Estimator::mean(const Model& model, const StepOptions& options) const {
  const auto one = run(model, options);
  return subject_.at_rest ? one : mean_of(one, run(model, divided(options, 2)));
}

std::optional<Quantities> Estimator::mean(const std::vector<kernels::Kernel>& kernels,
                                          const StepOptions& options) const {
  return mean(coarsened(subject_.rebuild(kernels), coarsenings_), options);
}

std::optional<double> Estimator::step(const StepOptions& options) {
  if (subject_.at_rest) return 0;
  const auto whole = quantities(options), half = quantities(divided(options, 2)),
             quarter = quantities(divided(options, 4));
  if (!whole || !half || !quarter) return std::nullopt;
  return std::max(4.0 / 3 * distance(*whole, *quarter), distance(*whole, *half));
}

std::optional<double> Estimator::precision(const StepOptions& options) {
  const bool is_single = options.precision == Precision::float32;
  StepOptions other = options;
  other.precision = is_single ? Precision::float64 : Precision::float32;
  const auto here = base(options);
  std::optional<Quantities> there;
  if (options.scheme == Scheme::compliant && !subject_.at_rest) {
    there = base(other);
  } else {
    // These schemes have no products in single precision, so the frequencies are rounded instead.
    std::vector<kernels::Kernel> kernels = subject_.kernels;
    for (kernels::Kernel& kernel : kernels)
      detune(kernel.modes, std::vector(kernel.modes.size(), single_round_off), 1);
    there = mean(kernels, options);
  }
  if (!here || !there) return std::nullopt;
  return distance(*here, *there) * (is_single ? 1 : double_over_single);
}

std::optional<double> Estimator::modes(const StepOptions& options, const Quantities& base) {
  if (subject_.at_rest && model_.has_residual) return 0;
  // Truncates all kernels to a share of the highest frequency or of the band.
  const auto cut = [&](double share) {
    std::vector<kernels::Kernel> out;
    for (const kernels::Kernel& kernel : subject_.kernels)
      out.push_back(kernels::truncated_above(kernel, end_of(kernel, share)));
    return out;
  };
  const std::vector<kernels::Kernel> half = cut(0.5);
  // Waves return undiminished from the end of a rod. Its resonances therefore count, but the flexibility
  // error ignores them.
  bool fewer = false, fitted = false, rods = false;
  double left = 0, made = 0;
  for (std::size_t k = 0; k < half.size(); ++k) {
    const kernels::Kernel& kernel = subject_.kernels[k];
    fewer = fewer || half[k].modes.size() < kernel.modes.size();
    if (!kernel.modes.contact_adapted()) continue;
    fitted = true;
    rods = rods || kernel.surface.element_corners == 1;
    left = std::max(left, kernel.modes.certificate.flexibility_error);
    made = std::max(made, kernels::truncation_error(kernel, end_of(kernel, 0.5), end_of(kernel, 1)));
  }
  if (!fewer) return std::nullopt;
  const auto once = mean(half, options);
  if (!once) return std::nullopt;
  const double change = distance(base, *once);
  if (fitted) {
    // Nothing is known about the vectors above the band, so their effect counts in full.
    const auto in_band = mean(cut(1), options);
    return std::max(left < made && !rods ? change * left / made : change,
                    in_band ? distance(base, *in_band) : 0);
  }
  const auto nearly = mean(cut(0.75), options), twice = mean(cut(0.25), options);
  return remaining_change(std::max(change, nearly ? distance(base, *nearly) : 0),
                          twice ? distance(*once, *twice) : 0);
}

std::optional<double> Estimator::spacing(const StepOptions& options, const Quantities& base) {
  Estimator* const wide = coarser().get();
  if (!wide) return 0;
  const auto once = wide->base(options);
  if (!once) return std::nullopt;
  Estimator* const wider = wide->coarser().get();
  const auto twice = wider ? wider->base(options) : std::nullopt;
  return remaining_change(distance(base, *once), twice ? distance(*once, *twice) : 0);
}

std::optional<double> Estimator::mesh(const StepOptions& options, const Quantities& base) const {
  if (!subject_.other_order) return std::nullopt;
  std::optional<Quantities> other;
  try {
    other = mean(coarsened(subject_.other_order(), coarsenings_), options);
  } catch (const InputError&) {  // the candidates of that order may not face each other
  }
  if (!other) return std::nullopt;
  return distance(base, *other) * subject_.left_of_other;
}

std::optional<double> Estimator::eigensolver(const StepOptions& options, const Quantities& base) const {
  std::vector<kernels::Kernel> kernels = subject_.kernels;
  double largest = 0;
  for (const kernels::Kernel& kernel : kernels) {
    // A residual of 1 bounds nothing; imported modes without known residuals have this value.
    if (std::ranges::any_of(kernel.modes.residual, [](double r) { return r >= 1; })) return std::nullopt;
    for (const double error : frequency_errors(kernel.modes, subject_.low_rank))
      largest = std::max(largest, error);
  }
  if (largest == 0) return 0;
  const double factor = visible / largest;
  for (kernels::Kernel& kernel : kernels)
    detune(kernel.modes, frequency_errors(kernel.modes, subject_.low_rank), factor);
  const auto detuned = mean(kernels, options);
  if (!detuned) return std::nullopt;
  return distance(base, *detuned) / factor;
}

ErrorEstimate Estimator::estimate(const StepOptions& options) {
  const auto found = base(options);
  if (!found) return {};
  return {.mesh = mesh(options, *found),
          .modes = modes(options, *found),
          .step = step(options),
          .eigensolver = eigensolver(options, *found),
          .precision = precision(options),
          .spacing = spacing(options, *found)};
}

}  // namespace ricochet::contact
