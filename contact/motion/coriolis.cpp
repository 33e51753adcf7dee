// SPDX-License-Identifier: BSD-2-Clause
#include "contact/motion/coriolis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double least_exchange = 0.01;  // of the amplitude of a pair
constexpr double least_coupling = 1e-6;  // |g|: a pattern turns by this share of the turn of its body
constexpr double longest_turn = 0.1;     // [rad] between two halves
constexpr double longest_beat = 0.25;    // phase (ω_n − ω_m) t between two halves [rad]

void turn_pair(double cosine, double sine, Index m, Index n, double ratio, Vector& x) {
  const double at_m = x(m), at_n = x(n);
  x(m) = cosine * at_m + sine * ratio * at_n;
  x(n) = cosine * at_n - sine / ratio * at_m;
}

}  // namespace

Coriolis::Coriolis(const Model& model, const Bodies::Block& block) {
  if (block.supported) return;
  const auto& [pair, coupling] = block.kernel->modes.coriolis;
  const auto folded = [&](Index n) {
    return std::ranges::binary_search(model.folded.modes, static_cast<int>(n));
  };
  for (std::size_t k = 0; 2 * k < pair.size(); ++k) {
    const Index m = block.first_mode + pair[2 * k], n = block.first_mode + pair[2 * k + 1];
    const Vector3d g = Eigen::Map<const Vector3d>(&coupling[3 * k]);
    if (folded(m) || folded(n) || !(g.norm() > least_coupling)) continue;
    const double apart = std::abs(model.omega(n) - model.omega(m));
    pairs_.push_back({m, n, g, model.omega(n) / model.omega(m), 0.5 * least_exchange * apart / g.norm()});
    widest_ = std::max(widest_, apart);
  }
  std::ranges::stable_sort(pairs_, {}, &Pair::slowest);
}

void Coriolis::turn(const Vector3d& angle, double time, Half half, Vector& q, Vector& v) const noexcept {
  if (pairs_.empty() || angle.isZero(0)) return;
  const std::span<const Pair> pairs = turned_at(2 * angle.norm() / time);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Pair& pair = pairs[half == Half::before ? k : pairs.size() - 1 - k];
    // cos and sin of the angle a by its tangent t = tan ½a = ½a + a³/24: c² + s² = 1 to round-off.
    const double a = pair.coupling.dot(angle), t = a * (0.5 + a * a / 24), whole = 1 + t * t,
                 cosine = (1 - t * t) / whole, sine = 2 * t / whole;
    turn_pair(cosine, sine, pair.m, pair.n, pair.ratio, q);
    turn_pair(cosine, sine, pair.m, pair.n, 1, v);
  }
}

void Coriolis::add_turn(const Vector3d& spin, double speed, bool of_q, const Vector& x,
                        Vector& out) const noexcept {
  for (const Pair& pair : turned_at(speed)) {
    const double a = pair.coupling.dot(spin), ratio = of_q ? pair.ratio : 1;
    out(pair.m) += a * ratio * x(pair.n);
    out(pair.n) -= a / ratio * x(pair.m);
  }
}

std::span<const Coriolis::Pair> Coriolis::turned_at(double speed) const noexcept {
  return {pairs_.begin(), std::ranges::upper_bound(pairs_, speed, {}, &Pair::slowest)};
}

double Coriolis::longest(double spin) const noexcept {
  if (pairs_.empty() || !(spin > 0)) return std::numeric_limits<double>::infinity();
  // |g| ≤ 1, so that the frequencies of pairs that are turned differ by no more than this.
  const double beat = std::min(widest_, 2 * spin / least_exchange);
  return std::min(longest_turn / spin,
                  beat > 0 ? longest_beat / beat : std::numeric_limits<double>::infinity());
}

std::vector<Coriolis> coriolis_of(const Model& model) {
  std::vector<Coriolis> out;
  for (const Bodies::Block& block : model.bodies) out.emplace_back(model, block);
  return out;
}

}  // namespace ricochet::contact
