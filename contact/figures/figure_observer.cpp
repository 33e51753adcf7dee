// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/figure_observer.hpp"

#include <algorithm>
#include <utility>

#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

using Eigen::Vector3d;

namespace {

/// A ringing body touches several times before it rebounds: pauses of contact that are shorter than this
/// share of the time since it began, or than so many steps, do not end it.
constexpr double quiet_share = 0.1, quiet_steps = 10;

/// Round-off of the direction of a velocity.
constexpr double negligible_speed = 1e-9;

}  // namespace

FigureObserver::FigureObserver(MotionSource source, double step)
    : source_(std::move(source)),
      step_(step),
      impulses_(source_.pairs().size()),
      of_episode_(impulses_),
      touch_of_(source_.pairs().size(), -1) {
  now_.state = source_.initial_state();
  if (const Model* const model = source_.modes()) now_.energy = initial_energy(*model);
  initial_strain_ = now_.energy.strain;
  if (source_.gap().size() > 0) closest_ = source_.gap().minCoeff(&closest_point_);
}

void FigureObserver::begin(const Stepper& stepper) {
  now_.time = stepper.time();
  now_.state = source_.state(stepper);
  if (source_.modes()) {
    now_.energy = stepper.modal()->energy();
    now_.rigid_energy = source_.rigid_energy(stepper);
  }
}

void FigureObserver::observe(const Stepper& stepper) {
  std::swap(before_, now_);
  begin(stepper);
  touched_ = std::exchange(touching_, (stepper.force().head(stepper.points()).array() > 0).any());
  // Displacements of all points of bodies that turn take longer than a step, and nothing is pressed in
  // flight.
  const bool matters = stepper.poses().empty() || touching_ || touched_ || !out_.contact_start_s;
  if (const Vector& gap = source_.gap(); gap.size() > 0 && matters) {
    Eigen::Index point = 0;
    const double deepest = (stepper.displacement().head(gap.size()) - gap).maxCoeff(&point);
    out_.max_penetration_m = std::max(out_.max_penetration_m, deepest);
    if (-deepest < closest_) {
      closest_ = -deepest;
      closest_point_ = point;
    }
  }
  if (touching_) {
    count(stepper);
  } else if (touched_) {
    std::ranges::fill(touch_of_, -1);
    out_.contact_end_s = out_.episodes.back().end_s = last_touch_;
    at_end_ = before_;
    judge(out_.episodes.back());
  }
}

/// Adds a step with a force. After the last point has opened, the mean force still acts for up to two steps.
void FigureObserver::count(const Stepper& stepper) {
  const double start = now_.time - step_;
  if (!touched_) {
    out_.episodes.push_back({.start_s = start, .end_s = {}});
    episode_start_ = before_;
    std::ranges::fill(of_episode_, Impulse{});
  }
  if (!out_.contact_start_s) {
    out_.contact_start_s = start;
    at_start_ = before_;
  }
  // What loads do after the last touch, as on a body that falls on, is not put into it.
  most_work_ = std::max(most_work_, now_.energy.loads - at_start_.energy.loads);
  if (stepper.active() > 0) last_touch_ = now_.time;
  last_force_ = now_.time;
  out_.contact_end_s.reset();
  const double force = stepper.force().head(stepper.points()).sum();
  Episode& episode = out_.episodes.back();
  episode.impulse_ns += force * step_;
  episode.peak_force_n = std::max(episode.peak_force_n, force);
  out_.impulse_ns += force * step_;
  out_.peak_force_n = std::max(out_.peak_force_n, force);
  out_.max_active = std::max(out_.max_active, stepper.active());
  ++out_.contact_steps;
  for (std::size_t p = 0; p < source_.pairs().size(); ++p) {
    const Impulse impulse = impulse_of(source_.pairs()[p], stepper);
    count_pair(p, impulse);
    impulses_[p] += impulse;
    of_episode_[p] += impulse;
  }
}

FigureObserver::Impulse& FigureObserver::Impulse::operator+=(const Impulse& other) {
  sum += other.sum;
  size += other.size;
  moment += other.moment;
  return *this;
}

/// In the last step.
FigureObserver::Impulse FigureObserver::impulse_of(const MotionSource::Pair& pair,
                                                   const Stepper& stepper) const {
  const auto own = stepper.force().segment(pair.first, pair.points);
  const auto sum = [&](const Matrix& rows) -> Vector3d {
    return step_ * (rows.middleRows(pair.first, pair.points).transpose() * own);
  };
  Impulse out{.sum = stepper.turning() ? sum(stepper.turning()->frames.normal)
                                       : Vector3d(step_ * (pair.normal.transpose() * own)),
              .size = step_ * own.sum()};
  if (pair.turns()) out.moment = sum(frames_of(*source_.places(), stepper).point_b);
  return out;
}

/// Adds a step of a pair to its touch; one with an impulse of 0 ends it.
void FigureObserver::count_pair(std::size_t number, const Impulse& impulse) {
  const MotionSource::Pair& pair = source_.pairs()[number];
  int& touch = touch_of_[number];
  if (!impulse.exists()) {
    touch = -1;
    return;
  }
  if (touch < 0) {
    touch = static_cast<int>(out_.touches.size());
    out_.touches.push_back({.start_s = now_.time - step_, .end_s = {}, .a = pair.name_a, .b = pair.name_b});
  }
  out_.touches[static_cast<std::size_t>(touch)].end_s = now_.time;
  out_.touches[static_cast<std::size_t>(touch)].impulse += impulse.sum;
}

bool FigureObserver::parted(const Stepper& stepper) const {
  if (!out_.contact_start_s || touching_) return false;
  const double quiet = std::max(quiet_share * (last_force_ - *out_.contact_start_s), quiet_steps * step_);
  if (now_.time < last_force_ + quiet) return false;
  for (std::size_t p = 0; p < source_.pairs().size(); ++p)
    if (approaches(p, stepper.poses())) return false;
  return true;
}

/// Whether the bodies of a pair come nearer to each other: along its impulse or, before it has one, along its
/// mean normal or, with finite rotations, the line between the bodies. At rest, those that have touched may
/// do so again. An obstacle that turns may come nearer at any time.
bool FigureObserver::approaches(std::size_t number, std::span<const Pose> poses) const {
  const MotionSource::Pair& pair = source_.pairs()[number];
  if (pair.turns()) return true;
  if (impulses_[number].exists()) return closing_speed(number, now_, impulses_[number]) >= 0;
  Vector3d along = pair.normal.colwise().sum().transpose();
  if (pair.b >= 0 && !poses.empty())
    along =
        poses[static_cast<std::size_t>(pair.b)].position - poses[static_cast<std::size_t>(pair.a)].position;
  const Vector3d relative = source_.relative_velocity(pair, now_.state, now_.time, pair.origin);
  return relative.dot(along.normalized()) > negligible_speed * relative.norm();
}

/// Sets the approach of the last episode and, if it has ended, its restitution.
void FigureObserver::judge(Episode& episode) const {
  episode.approach_m_per_s = closing_speed(episode_start_, of_episode_);
  if (episode.end_s && episode.approach_m_per_s && *episode.approach_m_per_s > 0)
    episode.restitution = -*closing_speed(at_end_, of_episode_) / *episode.approach_m_per_s;
}

/// Speed at which the bodies of a pair as a whole approach each other along its impulse [m/s]; an obstacle
/// has the velocity of what is at the mean place of the impulse.
double FigureObserver::closing_speed(std::size_t p, const Instant& at, const Impulse& impulse) const {
  return source_.relative_velocity(source_.pairs()[p], at.state, at.time, impulse.place())
      .dot(impulse.sum.normalized());
}

/// That of the only pair with an impulse; no value if there are several or none.
std::optional<double> FigureObserver::closing_speed(const Instant& at,
                                                    std::span<const Impulse> impulses) const {
  if (std::ranges::count_if(impulses, &Impulse::exists) != 1) return {};
  const auto only = std::ranges::find_if(impulses, &Impulse::exists);
  return closing_speed(static_cast<std::size_t>(only - impulses.begin()), at, *only);
}

ImpactFigures FigureObserver::figures() const {
  ImpactFigures out = out_;
  if (touching_) judge(out.episodes.back());
  for (const int touch : touch_of_)
    if (touch >= 0) out.touches[static_cast<std::size_t>(touch)].end_s.reset();
  out.quantities = quantities();
  if (!out.contact_end_s) return out;
  for (std::size_t k = 0; k < source_.bodies().size(); ++k) {
    const MotionSource::Body& body = source_.bodies()[k];
    out.exit_velocity[body.name] =
        source_.momentum(static_cast<int>(k), at_end_.state, at_end_.time) / body.mass;
  }
  if (const auto speed = approach(); speed && *speed > 0)
    out.restitution = -*closing_speed(at_end_, impulses_) / *speed;
  return out;
}

Figures FigureObserver::quantities() const {
  const auto relative_to_itself = [](double value) { return Figure{Vector::Constant(1, value), value}; };
  Figures out;
  out[Quantity::impulse] = relative_to_itself(out_.impulse_ns);
  out[Quantity::peak_force] = relative_to_itself(out_.peak_force_n);
  out[Quantity::duration] = relative_to_itself(static_cast<double>(out_.contact_steps) * step_);
  const Instant &start = out_.contact_start_s ? at_start_ : now_, &end = out_.contact_end_s ? at_end_ : now_;
  add_motion(out, start, end);
  if (!source_.modes()) return out;
  Figure energy{Vector(2), energy_put_in()};
  energy.value << elastic(end.energy) + end.energy.residual - end.rigid_energy,
      end.energy.damping + end.energy.contact;
  // Bodies that stay at rest have none.
  if (!(energy.scale > 0)) energy.scale = energy.value.cwiseAbs().maxCoeff();
  out[Quantity::energy] = energy;
  return out;
}

/// The velocities of the bodies that can move rigidly, and V.
void FigureObserver::add_motion(Figures& out, const Instant& start, const Instant& end) const {
  double speed = 0;
  for (std::size_t p = 0; p < source_.pairs().size(); ++p)
    if (impulses_[p].exists()) speed = std::max(speed, closing_speed(p, start, impulses_[p]));
  std::vector<double> rebound, spin;
  bool turns = false;
  for (std::size_t k = 0; k < source_.bodies().size(); ++k) {
    if (!source_.bodies()[k].moves) continue;
    const int body = static_cast<int>(k);
    const Vector3d velocity = source_.velocity(body, end.state);
    speed = std::max(speed, (velocity - source_.velocity(body, start.state)).norm() / 2);
    rebound.insert(rebound.end(), velocity.begin(), velocity.end());
    const auto turn = source_.spin(body, end.state);
    turns = turns || turn;
    spin.insert(spin.end(), 3, 0.0);
    if (turn) std::ranges::copy(*turn, spin.end() - 3);
  }
  const auto relative_to_speed = [&](const std::vector<double>& values) {
    return Figure{Eigen::Map<const Vector>(values.data(), std::ssize(values)), speed};
  };
  out[Quantity::rebound] = relative_to_speed(rebound);
  if (turns) out[Quantity::spin] = relative_to_speed(spin);
}

}  // namespace ricochet::contact
