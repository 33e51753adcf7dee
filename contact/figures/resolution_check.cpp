// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/resolution_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "contact/model/folding.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

namespace {

// A smooth pulse rises from half its peak within about a third of its duration (a half sine: 1/3), a front
// within the time that the run resolves.
constexpr double share_of_front = 0.1;
constexpr int steps_of_front = 3;
// A half sine of ten windows loses 0.4 % to their mean.
constexpr double share_of_overshoot = 0.05, longest_window = 1e6;
// Three candidates across the zone of contact: a quarter of a zone, cut by two planes of symmetry, then
// contains four, and a zone along a line three.
constexpr int fewest_on_surface = 4, fewest_on_line = 3;
// Patches of coarse meshes show a curvature within a factor of two.
constexpr double more_curved = 2;
// A pulse of duration T excites modes up to about 1/T. Modes above the band respond quasi-statically.
constexpr double least_periods = 1;
constexpr double share_of_impulse = 0.1;  // episodes with less than this share do not decide
// Gravity changes a speed during a short flight by less than this.
constexpr double faster = 1.05;

}  // namespace

ResolutionCheck::ResolutionCheck(const Model& model)
    : model_(model),
      rigid_(model),
      most_active_(model.pairs.size(), 0),
      strongest_(model.pairs.size(), {0, -1}) {}

void ResolutionCheck::observe(const Stepper& stepper, const Vector& before) {
  if (step_ == 0) {
    step_ = stepper.options().step;
    double highest = 0;
    for (const double omega : model_.omega)
      if (sampled(omega, step_)) highest = std::max(highest, omega);
    if (highest > 0) shortest_period_ = 2 * std::numbers::pi / highest;
    mean_.emplace(static_cast<std::size_t>(std::clamp(std::round(resolved() / step_), 1.0, longest_window)),
                  step_);
  }
  const Vector& force = stepper.force();
  const double sum = force.head(stepper.points()).sum();
  peak_.observe(stepper.time(), sum);
  mean_->observe(stepper.time(), sum);
  const bool touched = std::exchange(touching_, stepper.active() > 0);
  if (!touching_) return;
  for (std::size_t p = 0; p < model_.pairs.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    int active = 0;
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      if (force(i) > 0) active += pair.is_summit(i) ? fewest_on_surface : 1;  // a summit follows Hertz's law
      if (force(i) > strongest_[p].first) strongest_[p] = {force(i), i};
    }
    most_active_[p] = std::max(most_active_[p], active);
  }
  if (touched) return;
  ++episodes_;
  const double speed = approach(stepper, before);
  if (episodes_ == 1) first_approach_ = speed;
  if (speed > fastest_approach_) {
    fastest_approach_ = speed;
    fastest_episode_ = episodes_;
  }
}

/// Largest approach speed of the pressed points in the rigid motion of the bodies [m/s].
/// @param rates  (N) q̇
double ResolutionCheck::approach(const Stepper& stepper, const Vector& rates) const {
  const std::vector<RigidMotion> speed = rigid_.rates(rates, stepper);
  const Vector& force = stepper.force();
  const RowFrames& frames = frames_of(model_, stepper);
  double fastest = 0;
  for (const Model::PairBlock& pair : model_.pairs)
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      if (!(force(i) > 0)) continue;
      fastest = std::max(fastest, frames.normal.row(i).dot(relative_at(speed, pair, i, frames)));
    }
  return fastest;
}

std::vector<std::string> ResolutionCheck::warnings(const ImpactFigures& figures) const {
  std::vector<std::string> out;
  std::string peak = front(figures);
  if (peak.empty()) peak = overshoot(figures);
  for (std::string warning : {std::move(peak), few_candidates(), low_band(figures), faster_approach()})
    if (!warning.empty()) out.push_back(std::move(warning));
  return out;
}

/// The peak of a wave front converges to that of Gibbs' overshoot, or to that of the first step, and not to
/// that of the front. One run cannot distinguish such a front from a pulse that a higher band would resolve.
std::string ResolutionCheck::front(const ImpactFigures& figures) const {
  for (std::size_t k = 0; k < figures.episodes.size(); ++k) {
    const double start = figures.episodes[k].start_s;
    double end = figures.episodes[k].end_s.value_or(std::max(start, peak_.time()));
    if (peak_.time() < start || peak_.time() > end + 0.5 * step_) continue;
    // A truncated front may open the contact after a step or two, for a period of the highest mode.
    if (end - start < (steps_of_front + 0.5) * step_)
      while (++k < figures.episodes.size() && figures.episodes[k].start_s - end <= 2 * resolved())
        end = figures.episodes[k].end_s.value_or(std::numeric_limits<double>::infinity());
    if (peak_.rise() > resolved() || peak_.rise() > share_of_front * (end - start)) return "";
    return fmt::format(
        "the peak force {:.4g} N is not resolved: it rose from half of it within {:.2g} s (time step {:.2g} "
        "s, shortest period of the modes {:.2g} s). Compare two bands (modes.up_to_hz): if it rises as fast "
        "as each band allows, it stands at a wave front and contains its overshoot (Gibbs), so use the "
        "impulse",
        peak_.peak(), peak_.rise(), step_, shortest_period_);
  }
  return "";
}

/// The shortest time in which the run resolves a change of the force [s].
double ResolutionCheck::resolved() const { return std::max(steps_of_front * step_, shortest_period_); }

/// A front that is released, or whose ripple exceeds its rise later, has a peak that rises slowly.
std::string ResolutionCheck::overshoot(const ImpactFigures& figures) const {
  if (!mean_ || !(peak_.peak() > (1 + share_of_overshoot) * mean_->peak())) return "";
  // The touch around the peak. Ripple may open it for a period of the highest mode.
  double start = 0, end = 0;
  for (const Episode& episode : figures.episodes) {
    if (end == 0 || episode.start_s - end > 2 * resolved()) start = episode.start_s;
    end = episode.end_s.value_or(std::max(episode.start_s, peak_.time()));
    if (start > peak_.time()) break;
    if (end + 2 * resolved() < peak_.time()) continue;
    if (mean_->window() > share_of_front * (end - start)) continue;
    return fmt::format(
        "the peak force {:.4g} N exceeds the largest mean over {:.2g} s, the shortest time that modes and "
        "steps "
        "resolve, {:.4g} N, by {:.0f} %: it is ripple of a front that rises or is released. Use this mean, "
        "or "
        "the impulse",
        peak_.peak(), mean_->window(), mean_->peak(), 100 * (peak_.peak() / mean_->peak() - 1));
  }
  return "";
}

/// A multiple of the curvature of a body where its candidates are nearest to a point of the world [1/m]: the
/// bulge of a patch grows with its area. 0 on flat and hollow surfaces.
static double curvature(const Bodies::Block& body, const Vector3d& point) {
  const kernels::Surface& surface = body.kernel->surface;
  if (surface.bulge.empty()) return 0;
  const std::vector<double>& place = surface.places();
  const Vector3d own = body.rotation.transpose() * (point - body.translation);
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.bulge.size(); ++i) {
    const double distance = (Eigen::Map<const Vector3d>(&place[3 * i]) - own).norm();
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  return std::max(surface.bulge[nearest] / surface.area[nearest], 0.0);
}

/// The candidates are those of the first body, which should be the more curved one: projected on a flat
/// surface, they follow the zone of contact.
std::string ResolutionCheck::better_order(const Model::PairBlock& pair, int point) const {
  if (pair.b < 0 || point < 0 || model_.turns) return "";
  const Bodies::Block &a = model_.bodies[pair.a], &b = model_.bodies[pair.b];
  if (!(curvature(b, model_.point_b.row(point).transpose()) >
        more_curved * curvature(a, model_.point_a.row(point).transpose())))
    return "";
  return fmt::format(". {} is more curved there: name it before {} in between", b.name, a.name);
}

std::string ResolutionCheck::few_candidates() const {
  for (std::size_t p = 0; p < model_.pairs.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    const kernels::Surface& surface = model_.bodies[pair.a].kernel->surface;
    const int corners = surface.corners();
    const int fewest = corners == 1 ? 0 : corners == 2 ? fewest_on_line : fewest_on_surface;
    const int active = most_active_[p];
    // A small surface may touch with all of its candidates, but not if others were dropped beyond a reach.
    const bool dropped = pair.reach || surface.whole;
    if (active == 0 || active >= fewest || (active == pair.points && !dropped)) continue;
    return fmt::format(
        "at most {} of {} candidates of {} touch at the same time (below {}): the zone of contact is smaller "
        "than their distance, so peak force and duration depend on it. Refine the mesh where bodies touch, "
        "or "
        "lower contact.spacing{}",
        active, pair.points, model_.bodies[pair.a].name, fewest, better_order(pair, strongest_[p].second));
  }
  return "";
}

std::string ResolutionCheck::low_band(const ImpactFigures& figures) const {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Episode& episode : figures.episodes)
    if (episode.end_s && episode.impulse_ns >= share_of_impulse * figures.impulse_ns)
      shortest = std::min(shortest, *episode.end_s - episode.start_s);
  for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
    const Bodies::Block& body = model_.bodies[k];
    const double band = body.kernel->modes.certificate.upto_hz;  // 0: unknown
    const bool pressed = std::ranges::any_of(model_.pairs, [&](const Model::PairBlock& pair) {
      const auto index = static_cast<int>(k);
      return (pair.a == index || pair.b == index) && most_active_[&pair - model_.pairs.data()] > 0;
    });
    if (!pressed || band == 0 || !(band * shortest < least_periods)) continue;
    return fmt::format(
        "a touch of {:.3g} s is shorter than a period at the end of the band of {}, {:.4g} Hz: the vibration "
        "that it excites above the band is missing. Raise modes.up_to_hz to {:.2g} or more",
        shortest, body.name, band, 2 / shortest);
  }
  return "";
}

std::string ResolutionCheck::faster_approach() const {
  if (!(first_approach_ > 0) || !(fastest_approach_ > faster * first_approach_)) return "";
  return fmt::format(
      "touch {} begins at {:.4g} m/s, faster than the first one at {:.4g} m/s: restitution and relative "
      "losses of the run refer to the first; each of its episodes has its own approach and restitution",
      fastest_episode_, fastest_approach_, first_approach_);
}

}  // namespace ricochet::contact
