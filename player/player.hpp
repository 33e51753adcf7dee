// SPDX-License-Identifier: BSD-2-Clause
// Plays an instrument in real time: a web page and a plug-in call this class from their audio thread.
//
//   const player::Instrument bell = player::load(bytes);
//   player::Player player(bell, 48000);
//   player.strike({.place = 3, .mallet = 0, .speed = 1});   // [m/s]
//   player.process(left, right);                            // one block of sound: velocities [m/s]
//
// The mallet meets the body as it moves at that time, so a second blow is not the sum of two sounds. Contact
// is computed while a mallet is present, several times per sample; after that, each mode rings by itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "player/struck_body.hpp"

namespace ricochet::player {

struct Strike {
  int place = 0;           ///< of Instrument::places
  int mallet = 0;          ///< of Instrument::mallets
  double speed = 1;        ///< towards the place, above 0 [m/s]
  std::int64_t after = 0;  ///< samples from the beginning of the next block
};

/// Only the constructor allocates. Functions that are noexcept neither allocate nor lock nor call the system.
/// Use a player from one thread at a time. The instrument must outlive it.
class Player {
 public:
  static constexpr int most_mallets = 4;  ///< at a time
  static constexpr std::size_t most_forces = 1 << 14;

  /// Throws a one-line InputError if the rate is not from 8 to 768 kHz, or if the instrument would need more
  /// than 256 contact steps per sample.
  Player(const Instrument& instrument, double rate_hz);

  /// Requests a blow. It waits for its sample; mallets that wait, fly or touch do not influence it otherwise.
  /// Returns false and does nothing if a value is out of range or if all mallets wait or touch.
  bool strike(const Strike& strike) noexcept;
  /// Multiplies the decay rates of the body, from the next block on. Values are limited to 0 … 1000.
  void set_damping(double factor) noexcept;
  /// Renders a block into both channels, which are of the same length: velocities of the body [m/s].
  void process(std::span<float> left, std::span<float> right) noexcept;
  /// Stops all sound and forgets all strikes.
  void reset() noexcept;

  /// Total force of each contact step since the last mallet came [N], at most `most_forces`.
  std::span<const double> forces() const noexcept { return {forces_.data(), force_count_}; }
  double contact_rate_hz() const noexcept { return rate_hz_ * per_sample_; }
  /// Largest total force since the last call [N].
  double take_peak_force() noexcept;
  /// Amplitudes (N) of the velocity of each mode in the left channel [m/s].
  void amplitudes(std::span<double> out) const noexcept;
  Energies energies() const noexcept { return body_.energies(); }
  int mallets() const noexcept;  ///< that fly or touch
  bool silent() const noexcept { return silent_; }
  /// Strikes that ended because a value was not finite.
  std::int64_t failures() const noexcept { return failures_; }

 private:
  /// A mallet: free, waiting for its sample, or present in front of the body.
  struct Slot {
    bool waits = false;
    Strike strike{};
    std::int64_t age = 0;  ///< samples since it came
  };

  void begin_sample() noexcept;
  void end_sample() noexcept;
  void contact_steps() noexcept;

  const Instrument* instrument_;
  double rate_hz_;
  int per_sample_;
  StruckBody body_;
  Eigen::VectorXd left_, right_;  ///< (N) without modes that cannot be heard at this rate
  std::array<Slot, most_mallets> slots_{};
  std::vector<double> forces_;
  bool mono_;  ///< whether both channels are the same
  std::size_t force_count_ = 0;
  double peak_force_ = 0, damping_ = 1;
  bool new_damping_ = false, silent_ = true;
  std::int64_t failures_ = 0;
};

}  // namespace ricochet::player
