// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/band_share.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "ricochet/units.hpp"

namespace ricochet::contact {
namespace {

constexpr Eigen::Index samples = 128;

/// With fewer modes in the top octave of a band, their mean and number are not representative.
constexpr std::size_t fewest = 2;

}  // namespace

BandShare::Band BandShare::band_of(const Model& model, const Bodies::Block& body) {
  const kernels::Modes& modes = body.kernel->modes;
  const auto omega = model.omega.segment(body.first_mode, body.modes);
  Band band;
  // Ritz vectors above the certified band are no modes.
  band.end = modes.contact_adapted() ? RadPerSecond(Hertz{modes.certificate.upto_hz}).value
             : omega.size() > 0      ? omega.maxCoeff()
                                     : 0;
  double below = 0;
  for (Eigen::Index n = 0; n < omega.size(); ++n) {
    if (omega[n] == 0 || omega[n] > band.end) continue;
    ++band.modes;
    if (omega[n] > band.end / 2)
      band.top.push_back(body.first_mode + static_cast<int>(n));
    else
      ++below;
  }
  if (band.top.size() < fewest) band.end = 0;
  if (below > 0) band.power = std::clamp(std::log2(band.modes / below), 1.0, 3.0);
  return band;
}

BandShare::BandShare(const Model& model, double step)
    : model_(model), step_(step), impulse_(Vector::Zero(model.points())) {
  double first = std::numeric_limits<double>::infinity();
  for (const Bodies::Block& body : model.bodies) {
    bands_.push_back(band_of(model, body));
    if (bands_.back().end > 0) first = std::min(first, bands_.back().end / 2);
  }
  if (model.turns)
    for (const Bodies::Block& body : model.bodies)
      on_candidates_.push_back(Vector::Zero(static_cast<Eigen::Index>(3 * body.kernel->surface.size())));
  const double last = std::numbers::pi / step;
  if (!(2 * first < last)) return;
  const double width = std::log(last / first) / static_cast<double>(samples);
  low_ = std::log(first) + width * Eigen::ArrayXd::LinSpaced(samples, 0, samples - 1);
  high_ = low_ + width;
  omega_.resize(samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    double within = 0;  // multiples of the golden ratio are spread evenly, whatever their number
    within = std::modf(static_cast<double>(k + 1) * std::numbers::phi, &within);
    omega_[k] = std::exp(low_[k] + width * within);
  }
  const std::complex<double> i(0, 1);
  turn_ = (-i * step * omega_.cast<std::complex<double>>()).exp();
  phase_ = Eigen::ArrayXcd::Ones(samples);
  of_force_.assign(model.pairs.size(), Eigen::ArrayXcd::Zero(samples));
}

void BandShare::observe(double time, const Vector& force, const Turning* turning) {
  impulse_ += step_ * force.head(impulse_.size());
  for (std::size_t k = 0; turning && k < on_candidates_.size(); ++k)
    on_candidates_[k] += step_ * turning->candidate_force[k];
  if (of_force_.empty()) return;
  if (time - time_ > 1.5 * step_) {  // after a flight
    const std::complex<double> i(0, 1);
    phase_ = (-i * time * omega_.cast<std::complex<double>>()).exp();
  } else {
    phase_ *= turn_;
  }
  time_ = time;
  for (std::size_t p = 0; p < of_force_.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    const double sum = force.segment(pair.first_point, pair.points).sum();
    if (sum > 0) of_force_[p] += (sum * step_) * phase_;
  }
}

/// b = Σ λ̄ B / Σ λ̄ of a mode under the impulse of a pair. If bodies turn, under all impulses on the body.
double BandShare::mode_under_impulse(int number, int mode, std::size_t p) const {
  const Model::PairBlock& pair = model_.pairs[p];
  const auto impulse = impulse_.segment(pair.first_point, pair.points);
  if (!model_.turns)
    return impulse.dot(model_.B.col(mode).segment(pair.first_point, pair.points)) / impulse.sum();
  const Bodies::Block& body = model_.bodies[static_cast<std::size_t>(number)];
  const Vector& on_body = on_candidates_[static_cast<std::size_t>(number)];
  const Eigen::Map<const Matrix> shape(body.kernel->surface.shape.data(), on_body.size(), body.modes);
  return shape.col(mode - body.first_mode).dot(on_body) / impulse.sum();
}

/// ½ ⟨b²⟩ ∫ n |F|² dω of one pair. The force is constant over a step, so |F|² has the factor (sin x / x)², x
/// = ωΔ/2.
std::optional<double> BandShare::energy(int body, std::size_t p) const {
  const Band& band = bands_[static_cast<std::size_t>(body)];
  const Model::PairBlock& pair = model_.pairs[p];
  const auto impulse = impulse_.segment(pair.first_point, pair.points);
  if (!(impulse.sum() > 0)) return 0;
  if (band.end == 0 || of_force_.empty() || !(band.end * step_ < std::numbers::pi)) return std::nullopt;
  double mean = 0;
  for (const int mode : band.top) {
    const double b = mode_under_impulse(body, mode, p);
    mean += b * b / static_cast<double>(band.top.size());
  }
  const double top = std::log(band.end / 2), end = std::log(band.end);
  double at_top = 0, width_of_top = 0, recorded = 0, of_front = 0;
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double omega = omega_[k], x = omega * step_ / 2,
                 power = std::norm(of_force_[p][k]) * std::pow(std::sin(x) / x, 2);
    if (const double width = std::min(high_[k], end) - std::max(low_[k], top); width > 0) {
      at_top += power * omega * omega * width;
      width_of_top += width;
    }
    const double width = high_[k] - std::max(low_[k], end);
    if (!(width > 0)) continue;
    const double density =
        band.power * band.modes / band.end * std::pow(omega / band.end, band.power - 1) * omega * width;
    recorded += density * power;
    of_front += density / (omega * omega);
  }
  return mean * std::min(recorded, of_front * at_top / width_of_top) / 2;
}

std::optional<double> BandShare::energy() const {
  double sum = 0;
  for (std::size_t p = 0; p < model_.pairs.size(); ++p)
    for (const int body : {model_.pairs[p].a, model_.pairs[p].b}) {
      if (body < 0) continue;
      const auto found = energy(body, p);
      if (!found) return std::nullopt;
      sum += *found;
    }
  return sum;
}

}  // namespace ricochet::contact
