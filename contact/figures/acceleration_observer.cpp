// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/acceleration_observer.hpp"

#include <cmath>

#include "contact/figures/shock.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

AccelerationObserver::AccelerationObserver(const Model& model, const StepOptions& options)
    : model_(model),
      options_(options),
      interval_(options.step * options.steps_per_sample),
      receivers_(model, options) {
  for (std::size_t k = 0; k < receivers_.size(); ++k) {
    const ReceiverMotion& start = receivers_[k];
    const bool own = model.receivers[k].axes == Axes::body;
    const Eigen::Matrix3d& turn = model.bodies[model.receivers[k].body].rotation;
    channels_.push_back({.velocity = own ? Vector3d(turn * start.velocity) : start.velocity,
                         .rest = start.acceleration,
                         .means = {}});
    note_peak(channels_.back(), start.acceleration, 0);
  }
}

void AccelerationObserver::note_peak(Channel& channel, const Vector3d& acceleration, double time) const {
  if (!(acceleration.norm() > channel.peak)) return;
  channel.peak = acceleration.norm();
  channel.peak_time = time;
}

/// The attitude of the receiver's body after the step.
Eigen::Quaterniond AccelerationObserver::attitude(std::size_t receiver, const Stepper& stepper) const {
  const auto body = static_cast<std::size_t>(model_.receivers[receiver].body);
  return stepper.poses().empty() ? Eigen::Quaterniond(model_.bodies[body].rotation)
                                 : stepper.poses()[body].attitude;
}

/// Velocities and not accelerations are averaged, because the mean of the acceleration is then exact:
/// vibration above half of the rate does not alias into the classes, and impulses count.
void AccelerationObserver::observe(const Stepper& stepper) {
  receivers_.observe(stepper);
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    Channel& channel = channels_[k];
    const ReceiverMotion& motion = receivers_[k];
    note_peak(channel, motion.acceleration, stepper.time());
    if (!stepper.at_sample()) continue;
    const bool own = model_.receivers[k].axes == Axes::body;
    const Eigen::Quaterniond turn = own ? attitude(k, stepper) : Eigen::Quaterniond::Identity();
    const Vector3d velocity = turn * motion.velocity,
                   mean = turn.conjugate() * ((velocity - channel.velocity) / interval_);
    channel.velocity = velocity;
    for (const double x : mean) channel.means.push_back(static_cast<float>(x));
    // Impulses have no acceleration at an instant.
    if (options_.contact.scheme == Scheme::impulse) note_peak(channel, mean, stepper.time());
  }
}

std::map<std::string, AccelerationPeaks> AccelerationObserver::peaks() const {
  std::map<std::string, AccelerationPeaks> out;
  const double rate = 1 / interval_;
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const Channel& channel = channels_[k];
    AccelerationPeaks& of = out[model_.receivers[k].name];
    of.peak_m_per_s2 = channel.peak;
    of.time_s = channel.peak_time;
    const std::size_t samples = channel.means.size() / 3;
    for (const int channel_class : channel_classes) {
      std::optional<double>& filtered = of.by_class[channel_class];
      if (rate < least_rate(channel_class)) continue;
      Eigen::VectorXd square = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples));
      for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> x(samples);
        for (std::size_t s = 0; s < samples; ++s) x[s] = static_cast<double>(channel.means[3 * s + c]);
        filter_channel(x, rate, channel_class, channel.rest[static_cast<Eigen::Index>(c)]);
        square.array() += Eigen::Map<const Eigen::ArrayXd>(x.data(), square.size()).square();
      }
      filtered = samples > 0 ? std::sqrt(square.maxCoeff()) : 0;
    }
  }
  return out;
}

}  // namespace ricochet::contact
