// SPDX-License-Identifier: BSD-2-Clause
// Gathers the figures of an impact, step by step.
#pragma once

#include <optional>
#include <span>

#include "contact/figures/impact_figures.hpp"
#include "contact/figures/motion_source.hpp"

namespace ricochet::contact {

class FigureObserver {
 public:
  /// @param step  Δ [s]
  FigureObserver(MotionSource source, double step);

  /// Begins where a stepper is, after steps that were not observed.
  void begin(const Stepper& stepper);

  /// Call it after each step or flight.
  void observe(const Stepper& stepper);

  const MotionSource& source() const { return source_; }
  /// Whether the last step had a force, and whether an episode began with it.
  bool touching() const { return touching_; }
  bool begins() const { return touching_ && !touched_; }
  /// Whether bodies have touched and parted: nothing has touched for a tenth of the time since contact began
  /// and for ten steps, the bodies of each pair that has touched move apart, and those of the other pairs do
  /// not approach each other. Bodies move as a whole here, at their present speeds. @param stepper  after the
  /// step that was observed last
  bool parted(const Stepper& stepper) const;
  /// State of the source at the start of the last step or flight.
  const Vector& before() const { return before_.state; }
  /// The pair of points that came closest at the end of a step.
  Eigen::Index closest_point() const { return closest_point_; }
  double closest() const { return closest_; }  ///< its distance [m]

  /// Energy put into the bodies [J]: kinetic + strain energy when contact began, above the strain under dead
  /// loads at t = 0, and the largest net work from outside between then and a step with a force: of loads,
  /// moving supports and obstacles, and of bodies that are added. 0 if unknown.
  double energy_put_in() const {
    return elastic((out_.contact_start_s ? at_start_ : now_).energy) + most_work_;
  }
  /// Speed of approach along the impulse when contact began [m/s]; no value if more than one pair touched.
  std::optional<double> approach() const { return closing_speed(at_start_, impulses_); }
  /// Of the steps so far.
  ImpactFigures figures() const;

 private:
  struct Instant {
    double time = 0;
    Vector state;
    Energy energy{};
    double rigid_energy = 0;  ///< kinetic energy of the bodies as a whole, with modes [J]
  };
  /// The impulse of a pair.
  struct Impulse {
    Eigen::Vector3d sum{0, 0, 0};     ///< Σ λ n Δ on b [N s]
    double size = 0;                  ///< Σ λ Δ [N s]
    Eigen::Vector3d moment{0, 0, 0};  ///< Σ λ Δ y with the places y of an obstacle that turns [N s m]
    Impulse& operator+=(const Impulse& other);
    bool exists() const { return !sum.isZero(0); }
    Eigen::Vector3d place() const { return moment / size; }  ///< its mean place
  };
  Impulse impulse_of(const MotionSource::Pair& pair, const Stepper& stepper) const;
  void count(const Stepper& stepper);
  void count_pair(std::size_t pair, const Impulse& impulse);
  void judge(Episode& episode) const;
  bool approaches(std::size_t pair, std::span<const Pose> poses) const;
  double closing_speed(std::size_t pair, const Instant& at, const Impulse& impulse) const;
  std::optional<double> closing_speed(const Instant& at, std::span<const Impulse> impulses) const;
  double elastic(const Energy& energy) const { return energy.kinetic + energy.strain - initial_strain_; }
  Figures quantities() const;
  void add_motion(Figures& out, const Instant& start, const Instant& end) const;

  MotionSource source_;
  double step_;
  ImpactFigures out_;
  bool touching_ = false, touched_ = false;     ///< whether the last step and the one before had a force
  double last_touch_ = 0;                       ///< last instant at which a point was in contact [s]
  double last_force_ = 0;                       ///< end of the last step with a force [s]
  Instant before_, now_;                        ///< around the last step
  Instant at_start_, at_end_;                   ///< when contact began and last ended
  Instant episode_start_;                       ///< when the last episode began
  std::vector<Impulse> impulses_, of_episode_;  ///< by pair, of the run and of the episode
  std::vector<int> touch_of_;                   ///< by pair: its touch that has not ended, or −1
  double initial_strain_ = 0;                   ///< [J]
  double most_work_ = 0;  ///< largest net work since contact began, while bodies touch [J]
  double closest_ = 0;
  Eigen::Index closest_point_ = 0;
};

}  // namespace ricochet::contact
