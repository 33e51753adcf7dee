// SPDX-License-Identifier: BSD-2-Clause
#include "player/player.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "ricochet/denormals.hpp"
#include "ricochet/error.hpp"

namespace ricochet::player {
namespace {

constexpr int most_steps = 256;     // of contact per sample
constexpr double longest_stay = 1;  // of a mallet that does not touch, nor recedes [s]

/// Energy of a mode [J] that is inaudible in any body: 1e-24 J move 1 g at 4e-11 m/s. Without this limit,
/// decaying modes become denormal numbers, which WebAssembly cannot flush.
constexpr double inaudible = 1e-24;

/// Contact steps per sample: as many as the instrument wants, and enough to sample all its modes.
int steps_per_sample(const Instrument& instrument, double rate_hz) {
  if (!(rate_hz >= 8e3 && rate_hz <= 768e3))
    throw InputError("sample rate = " + std::to_string(rate_hz) + " Hz: must be from 8000 to 768000.");
  double highest = instrument.omega.maxCoeff();
  for (const Mallet& mallet : instrument.mallets)
    highest = std::max(highest, instrument.mallet_omega.maxCoeff() / std::sqrt(mallet.mass));
  const double wanted = std::max(instrument.contact_rate_hz, highest / std::numbers::pi) / rate_hz;
  if (!(wanted <= most_steps))
    throw InputError("instrument: needs more than 256 contact steps per sample at a sample rate of " +
                     std::to_string(rate_hz) + " Hz. Give it fewer modes or a lower contact rate.");
  return std::max(1, static_cast<int>(std::ceil(wanted * (1 - 1e-12))));
}

}  // namespace

Player::Player(const Instrument& instrument, double rate_hz)
    : instrument_(&instrument),
      rate_hz_(rate_hz),
      per_sample_(steps_per_sample(instrument, rate_hz)),
      body_(instrument, most_mallets, 1 / (rate_hz * per_sample_), 1 / rate_hz),
      left_(instrument.left),
      right_(instrument.right),
      forces_(most_forces),
      mono_(instrument.left == instrument.right) {
  for (Eigen::Index n = 0; n < left_.size(); ++n)
    if (instrument.omega(n) == 0 || instrument.omega(n) >= std::numbers::pi * rate_hz)
      left_(n) = right_(n) = 0;
}

bool Player::strike(const Strike& strike) noexcept {
  const auto within = [](int k, std::size_t count) { return k >= 0 && static_cast<std::size_t>(k) < count; };
  if (!within(strike.place, instrument_->places.size()) ||
      !within(strike.mallet, instrument_->mallets.size()) || !(strike.speed > 0 && strike.speed <= 1000) ||
      strike.after < 0)
    return false;
  int chosen = -1;
  for (int k = 0; k < most_mallets; ++k) {
    const Slot& slot = slots_[k];
    if (slot.waits || (body_.holds(k) && body_.touches(k))) continue;
    if (!body_.holds(k)) {
      chosen = k;
      break;
    }
    if (chosen < 0 || slot.age > slots_[chosen].age) chosen = k;
  }
  if (chosen < 0) return false;
  if (body_.holds(chosen)) body_.take(chosen);
  slots_[chosen] = {.waits = true, .strike = strike};
  return true;
}

void Player::set_damping(double factor) noexcept {
  if (std::isnan(factor)) return;
  const double before = std::exchange(damping_, std::clamp(factor, 0.0, 1000.0));
  new_damping_ = new_damping_ || damping_ != before;
}

void Player::begin_sample() noexcept {
  for (int k = 0; k < most_mallets; ++k) {
    Slot& slot = slots_[k];
    if (!slot.waits || slot.strike.after-- > 0) continue;
    slot.waits = false;
    body_.bring(k, instrument_->places[slot.strike.place], slot.strike.mallet, slot.strike.speed);
    force_count_ = 0;
    silent_ = false;
  }
}

void Player::contact_steps() noexcept {
  for (int step = 0; step < per_sample_; ++step) {
    if (!body_.step()) {
      ++failures_;
      return;
    }
    peak_force_ = std::max(peak_force_, body_.force());
    if (force_count_ < most_forces) forces_[force_count_++] = body_.force();
  }
}

void Player::end_sample() noexcept {
  const auto stay = static_cast<std::int64_t>(longest_stay * rate_hz_);
  for (int k = 0; k < most_mallets; ++k) {
    if (!body_.holds(k) || body_.touches(k)) continue;
    if (body_.recedes(k) || slots_[k].age > stay) body_.take(k);
    ++slots_[k].age;
  }
}

void Player::process(std::span<float> left, std::span<float> right) noexcept {
  const FlushDenormals scope;
  if (new_damping_) body_.set_damping(damping_);
  new_damping_ = false;
  for (std::size_t i = 0; i < left.size(); ++i) {
    begin_sample();
    if (!body_.alone()) {
      contact_steps();
      end_sample();
    } else if (!silent_) {
      body_.advance_in_flight();
    }
    left[i] = silent_ ? 0.0F : static_cast<float>(body_.velocity(left_));
    right[i] = silent_ || mono_ ? left[i] : static_cast<float>(body_.velocity(right_));
  }
  if (body_.alone() && !silent_) silent_ = body_.rest_below(inaudible);
}

void Player::reset() noexcept {
  slots_ = {};
  body_.rest();
  force_count_ = 0;
  peak_force_ = 0;
  silent_ = true;
}

double Player::take_peak_force() noexcept {
  const double peak = peak_force_;
  peak_force_ = 0;
  return peak;
}

void Player::amplitudes(std::span<double> out) const noexcept {
  for (Eigen::Index n = 0; n < left_.size(); ++n) out[n] = std::abs(left_(n)) * body_.amplitude(n);
}

int Player::mallets() const noexcept {
  int count = 0;
  for (int k = 0; k < most_mallets; ++k) count += body_.holds(k) ? 1 : 0;
  return count;
}

}  // namespace ricochet::player
