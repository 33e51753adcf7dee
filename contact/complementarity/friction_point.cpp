// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/friction_point.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace ricochet::contact {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// g(θ) = Σ_k a_k cos kθ + b_k sin kθ, k ≤ 2, through its values at five equidistant angles.
class Trigonometric {
 public:
  static constexpr int samples = 5;

  explicit Trigonometric(const std::array<double, samples>& value) noexcept {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < samples; ++i) {
        const double angle = 2 * pi * ((k * i) % samples) / samples;
        a_[k] += (k == 0 ? 1.0 : 2.0) / samples * value[i] * std::cos(angle);
        b_[k] += (k == 0 ? 0.0 : 2.0) / samples * value[i] * std::sin(angle);
      }
      const double size = std::hypot(a_[k], b_[k]);
      largest_ += size;
      curvature_ += k * k * size;
    }
  }

  double largest() const { return largest_; }      ///< ≥ |g|
  double curvature() const { return curvature_; }  ///< ≥ |g''|

  struct Value {
    double g = 0, slope = 0;
  };
  Value operator()(double angle) const noexcept {
    const double c = std::cos(angle), s = std::sin(angle);
    Value out{a_[0], 0};
    double ck = 1, sk = 0;
    for (int k = 1; k < 3; ++k) {
      const double next = ck * c - sk * s;
      sk = sk * c + ck * s;
      ck = next;
      out.g += a_[k] * ck + b_[k] * sk;
      out.slope += k * (b_[k] * ck - a_[k] * sk);
    }
    return out;
  }

  /// The root between two angles where g is monotone and changes its sign: Newton, or else bisection.
  double root(double low, double high, double at_low) const noexcept {
    double angle = 0.5 * (low + high);
    for (int k = 0; k < 60; ++k) {
      const Value value = (*this)(angle);
      if (value.g == 0) break;
      (value.g > 0) == (at_low > 0) ? low = angle : high = angle;
      double next = value.slope != 0 ? angle - value.g / value.slope : low;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (std::abs(next - angle) <= epsilon) return next;
      angle = next;
    }
    return angle;
  }

 private:
  std::array<double, 3> a_{}, b_{};
  double largest_ = 0, curvature_ = 0;
};

}  // namespace

/// Adds the solution that slips along t, if p_n ≥ 0 and w_t points along t.
void FrictionPoint::add_slip(double angle, Solutions& found) const noexcept {
  const Eigen::Vector2d t(std::cos(angle), std::sin(angle));
  const Eigen::Vector3d along(1, -coefficient * t.x(), -coefficient * t.y());
  const Eigen::Vector3d push = S * along;
  if (push(0) == 0) return;
  const double normal = r(0) / push(0);
  if (!(normal > 0) || !std::isfinite(normal) || found.count == most) return;
  if (!(t.dot(normal * push.tail<2>() - r.tail<2>()) >= 0)) return;
  for (int k = 0; k < found.count; ++k)  // a double root is found in several intervals
    if (found.at[k].direction.dot(t) > 1 - 1e-14) return;
  found.at[found.count++] = {normal * along, ContactState::slip, t};
}

/// w_t is parallel to t if g = (n·r) (t⊥·S d) − (t⊥·r) (n·S d) = 0 with d = n − μ t. Intervals are divided
/// until bounds of g' or g'' show that they contain no root or that g is monotone.
void FrictionPoint::add_slips(bool all, Solutions& found) const noexcept {
  std::array<double, Trigonometric::samples> value;
  for (int i = 0; i < Trigonometric::samples; ++i) {
    const double angle = 2 * pi * i / Trigonometric::samples;
    const Eigen::Vector2d t(std::cos(angle), std::sin(angle)), across(-t.y(), t.x());
    const Eigen::Vector3d push = S * Eigen::Vector3d(1, -coefficient * t.x(), -coefficient * t.y());
    value[i] = r(0) * across.dot(push.tail<2>()) - across.dot(r.tail<2>()) * push(0);
  }
  const Trigonometric g(value);
  if (!(g.largest() > 0)) return;

  struct Interval {
    double low, high;
  };
  std::array<Interval, 64> open;
  int count = 0;
  for (int i = 0; i < 8; ++i) open[count++] = {pi * (i - 4) / 4, pi * (i - 3) / 4};
  while (count > 0) {
    const auto [low, high] = open[--count];
    const double half = 0.5 * (high - low), middle = low + half;
    const Trigonometric::Value value_there = g(middle);
    if (std::abs(value_there.g) > half * (std::abs(value_there.slope) + 0.5 * half * g.curvature())) continue;
    if (std::abs(value_there.slope) > half * g.curvature()) {
      const double at_low = g(low).g;
      if ((at_low > 0) != (g(high).g > 0)) add_slip(g.root(low, high, at_low), found);
    } else if (half < 1e-8) {  // a double root to round-off
      add_slip(middle, found);
    } else {
      open[count++] = {low, middle};
      open[count++] = {middle, high};
    }
    if (found.count == most || (!all && found.count > 0)) return;
  }
}

FrictionPoint::Solutions FrictionPoint::solve(bool all) const noexcept {
  Solutions found;
  if (r(0) <= 0) {
    found.at[found.count++] = {Eigen::Vector3d::Zero(), ContactState::open, Eigen::Vector2d::Zero()};
    if (!all) return found;
  }
  Eigen::Matrix3d inverse;
  bool invertible = false;
  S.computeInverseWithCheck(inverse, invertible, 0);
  const Eigen::Vector3d p = invertible ? Eigen::Vector3d(inverse * r) : Eigen::Vector3d::Zero();
  if (p(0) > 0 && p.tail<2>().norm() <= coefficient * p(0)) {
    found.at[found.count++] = {p, ContactState::stick, Eigen::Vector2d::Zero()};
    if (!all) return found;
  }
  add_slips(all, found);
  return found;
}

}  // namespace ricochet::contact
