// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/ripple_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "contact/model/folding.hpp"

namespace ricochet::contact {
namespace {

using std::numbers::pi;

constexpr double farthest = 1.5;      // times the end of the band
constexpr double least_share = 0.05;  // of the mean force
constexpr double above_median = 4;
// A line leaks at most 2.7 % beyond the main lobe of its Hann window, which ends 2/T beside it.
constexpr double leaked = 0.06, main_lobe = 2;
// The median is taken over these multiples of the end of the band.
constexpr double low_end = 0.5, high_end = 2;
constexpr double points_per_bin = 4;  // frequencies in 1/T
// A touch of fewer periods is a smooth pulse, whose own spectrum reaches the end of the band.
constexpr double fewest_periods = 4;
constexpr double most_periods = 128;  // this bounds memory and time
constexpr double samples_per_period = 16;
constexpr double longest_opening = 2;     // periods
constexpr double share_of_largest = 0.1;  // touches with less than this share do not decide

/// Amplitude of a harmonic at each frequency [cycles per sample], under a Hann window of mean 1.
std::vector<double> amplitudes(std::span<const double> force, const std::vector<double>& frequencies) {
  const auto n = static_cast<double>(force.size());
  std::vector<double> weighted, out;
  for (std::size_t k = 0; k < force.size(); ++k)
    weighted.push_back(force[k] * (1 - std::cos(2 * pi * (static_cast<double>(k) + 0.5) / n)));
  for (const double f : frequencies) {
    const std::complex<double> turn = std::polar(1.0, -2 * pi * f);
    std::complex<double> sum = 0;
    for (const double x : weighted) sum = sum * turn + x;  // Horner's rule
    out.push_back(2 * std::abs(sum) / n);
  }
  return out;
}

double median(std::vector<double> x) {
  const auto middle = x.begin() + std::ssize(x) / 2;
  std::ranges::nth_element(x, middle);
  return *middle;
}

}  // namespace

std::optional<SpectralLine> line_above(double band, std::span<const double> force, double rate) {
  const double duration = static_cast<double>(force.size()) / rate, bin = 1 / duration;
  if (!(duration * band >= fewest_periods)) return {};
  std::vector<double> frequency;
  for (double f = low_end * band; f < std::min(high_end * band, rate / 2); f += bin / points_per_bin)
    frequency.push_back(f);
  std::vector<double> cycles = frequency;
  for (double& f : cycles) f /= rate;
  const std::vector<double> size = amplitudes(force, cycles);
  const double mean = amplitudes(force, {0}).front() / 2;
  std::optional<SpectralLine> out;
  for (std::size_t k = 1; k + 1 < size.size(); ++k) {
    if (!(frequency[k] > band && frequency[k] < farthest * band)) continue;
    if (!(size[k] >= size[k - 1] && size[k] > size[k + 1])) continue;
    if (!(size[k] > least_share * mean) || (out && size[k] <= out->share * mean)) continue;
    std::vector<double> beside;
    double strongest = 0;  // within the band
    for (std::size_t j = 0; j < size.size(); ++j) {
      if (std::abs(frequency[j] - frequency[k]) < main_lobe * bin) continue;
      beside.push_back(size[j]);
      if (frequency[j] < band) strongest = std::max(strongest, size[j]);
    }
    if (beside.empty() || !(size[k] > above_median * median(beside)) || !(size[k] > leaked * strongest))
      continue;
    out = {frequency[k], size[k] / mean};
  }
  return out;
}

RippleCheck::RippleCheck(const Model& model, double step) : model_(model), step_(step) {
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Bodies::Block& body = model.bodies[k];
    double highest = 0;
    for (const double omega : model.omega.segment(body.first_mode, body.modes))
      if (sampled(omega, step)) highest = std::max(highest, omega);
    const double proved = body.kernel->modes.certificate.upto_hz;  // 0: unknown
    const double end = std::max(highest / (2 * pi), std::min(proved, 1 / (2 * step)));
    if (highest == 0 || (body_ >= 0 && end >= band_)) continue;
    body_ = static_cast<int>(k);
    band_ = end;
  }
  if (body_ >= 0) steps_per_sample_ = std::max(1, static_cast<int>(1 / (step * band_ * samples_per_period)));
}

void RippleCheck::observe(double time, double force) {
  const std::int64_t steps = std::llround((time - time_) / step_);
  time_ = time;
  if (body_ < 0 || (force == 0 && touch_.empty() && summed_ == 0)) return;
  idle_ = force > 0 ? 0 : idle_ + static_cast<double>(steps) * step_;
  if (idle_ * band_ > longest_opening) {
    finish();
    return;
  }
  for (std::int64_t k = 1; k < steps && (!touch_.empty() || summed_ > 0); ++k) add(0);
  add(force);
}

void RippleCheck::add(double force) {
  sum_ += force;
  if (++summed_ < steps_per_sample_) return;
  if (static_cast<double>(touch_.size()) < most_periods * samples_per_period)
    touch_.push_back(sum_ / summed_);
  sum_ = summed_ = 0;
}

std::optional<SpectralLine> RippleCheck::line_of_touch() const {
  std::span<const double> samples = touch_;
  while (!samples.empty() && samples.back() == 0) samples = samples.first(samples.size() - 1);
  if (std::accumulate(samples.begin(), samples.end(), 0.0) < share_of_largest * largest_) return {};
  return line_above(band_, samples, 1 / (step_ * steps_per_sample_));
}

void RippleCheck::finish() {
  if (const auto line = line_of_touch(); line && !(worst_ && worst_->share >= line->share)) worst_ = line;
  largest_ = std::max(largest_, std::accumulate(touch_.begin(), touch_.end(), 0.0));
  touch_.clear();
  sum_ = idle_ = 0;
  summed_ = 0;
}

std::vector<std::string> RippleCheck::warnings() const {
  std::optional<SpectralLine> worst = worst_;
  if (const auto line = line_of_touch(); line && !(worst && worst->share >= line->share)) worst = line;
  if (!worst) return {};
  return {fmt::format(
      "the force swings by {:.2g} % of its mean at {:.4g} Hz, {:.3g} times the end of the band of {} ({:.4g} "
      "Hz): a ripple of the truncated band, which the peak force contains. Raise modes.up_to_hz, or filter "
      "the "
      "force below {:.2g} Hz",
      100 * worst->share, worst->frequency, worst->frequency / band_, model_.bodies[body_].name, band_,
      band_)};
}

}  // namespace ricochet::contact
