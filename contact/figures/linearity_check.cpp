// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/linearity_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace ricochet::contact {

using Eigen::Vector3d;

namespace {

// Bounds beyond which linear elasticity with pairs fixed in the reference configuration does not model the
// impact.
constexpr double fastest_share = 0.02;  // of the wave speed: strains of a few per cent
constexpr double farthest_share = 0.5;  // of the spacing: beyond it, a neighbour is the nearer candidate

double in_degrees(double angle) { return angle * 180 / std::numbers::pi; }
constexpr double largest_rotation_deg = largest_linear_rotation * 180 / std::numbers::pi;

/// Smallest distance between two corners of a surface element; infinite for rods.
/// @param surface  kernels::Surface or kernels::WholeSurface
template <class Any>
double spacing_of(const Any& surface) {
  double smallest = std::numeric_limits<double>::infinity();
  const std::size_t k = surface.element_corners;
  const auto node = [&](std::size_t corner) {
    return Eigen::Map<const Vector3d>(&surface.node[3 * surface.element[corner]]);
  };
  for (std::size_t t = 0; t + k <= surface.element.size(); t += k)
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, (node(t + i) - node(t + j)).norm());
  return smallest;
}

}  // namespace

std::optional<std::string> rotation_warning(const std::string& body, double angle) {
  if (!(angle > largest_linear_rotation)) return {};
  return fmt::format("{} turned by {:.3g} degrees while touching (above {:g}): rotations are linearised",
                     body, in_degrees(angle), largest_rotation_deg);
}

std::optional<std::string> reach_warning(const Model& model, const Model::PairBlock& pair, double nearer) {
  if (!pair.reach || !(nearer >= *pair.reach)) return {};
  return fmt::format(
      "{} came {:.4g} m nearer to what it touches, beyond reach = {:g} m: points that reach left out may "
      "touch, too",
      model.bodies[pair.a].name, nearer, *pair.reach);
}

LinearityCheck::LinearityCheck(const Model& model, double wave_speed)
    : model_(model),
      wave_speed_(wave_speed),
      rigid_(model),
      nearer_(model.pairs.size(), 0),
      turns_(model.bodies.size()) {
  for (const Model::PairBlock& pair : model.pairs) {
    const kernels::Surface& surface = model.bodies[pair.a].kernel->surface;
    spacing_.push_back(surface.whole ? spacing_of(*surface.whole) : spacing_of(surface));
  }
}

void LinearityCheck::observe_rotation(const Vector& q, double time) {
  last_ = time;
  for (std::size_t k = 0; k < turns_.size(); ++k) {
    Turn& turn = turns_[k];
    turn.angle = std::max(turn.angle, rigid_.of(static_cast<int>(k), q).rotation.norm());
    if (!turn.since && turn.angle > largest_linear_rotation) turn.since = time;
  }
}

FarthestTurn LinearityCheck::farthest_turn() const {
  if (turns_.empty()) return {};
  const auto worst = std::ranges::max_element(turns_, {}, &Turn::angle);
  return {static_cast<std::size_t>(worst - turns_.begin()), worst->angle};
}

/// Warning about the body that turned farthest, unless its rotation while touching is reported already.
std::string LinearityCheck::turned_in_flight() const {
  if (turns_.empty()) return "";
  const auto [body, angle] = farthest_turn();
  const std::string& name = model_.bodies[body].name;
  const auto since = turns_[body].since;
  // What is written up to this time is right.
  if (!since || *since >= last_) return "";
  if (rotation_warning(tilted_, tilt_) && name == tilted_) return "";
  return fmt::format(
      "{} turned by {:.3g} degrees in flight, beyond {:g} after {:.4g} s: rotations are linearised, so its "
      "later motion and contact are wrong. Set motion.rotation = \"finite\", or end the run there "
      "(time.duration)",
      name, in_degrees(angle), largest_rotation_deg, *since);
}

void LinearityCheck::observe(const Stepper& stepper, const Vector& before, bool first) {
  const std::vector<RigidMotion> moved = rigid_.displacement(stepper), speed = rigid_.rates(before, stepper);
  const RowFrames& frames = frames_of(model_, stepper);
  const auto turned = [&](int k) {
    const double angle = moved[k].rotation.norm();
    if (angle <= tilt_) return;
    tilt_ = angle;
    tilted_ = model_.bodies[k].name;
  };
  for (std::size_t p = 0; p < model_.pairs.size(); ++p) {
    const Model::PairBlock& pair = model_.pairs[p];
    if ((stepper.force().segment(pair.first_point, pair.points).array() > 0).any()) {
      turned(pair.a);
      if (pair.b >= 0) turned(pair.b);
    }
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const bool pressed = stepper.force()(i) > 0;
      if (!pressed && !pair.reach) continue;
      const Vector3d n = frames.normal.row(i).transpose();
      nearer_[p] = std::max(nearer_[p], n.dot(relative_at(moved, pair, i, model_)));
      if (!pressed) continue;
      if (first) approach_ = std::max(approach_, n.dot(relative_at(speed, pair, i, frames)));
      if (pair.is_half_space() || stepper.turning()) continue;  // a half-space looks the same everywhere
      const Vector3d shift = relative_at(moved, pair, i, model_);
      const double slip = (shift - shift.dot(n) * n).norm();
      if (slip / spacing_[p] > slip_share_) {
        slip_ = slip;
        slip_share_ = slip / spacing_[p];
      }
    }
  }
}

double LinearityCheck::nearer() const { return std::ranges::max(nearer_); }

std::vector<std::string> LinearityCheck::warnings() const {
  std::vector<std::string> out;
  if (wave_speed_ > 0 && approach_ > fastest_share * wave_speed_)
    out.push_back(
        fmt::format("approach speed {:.4g} m/s is {:.3g} % of the wave speed {:.4g} m/s (above {:g} %): "
                    "strains may be too large for linear elasticity",
                    approach_, 100 * approach_ / wave_speed_, wave_speed_, 100 * fastest_share));
  if (slip_share_ > farthest_share)
    out.push_back(
        fmt::format("tangential motion {:.4g} m is {:.3g} times the candidate spacing (above {:g}): pairs "
                    "are fixed in the initial configuration",
                    slip_, slip_share_, farthest_share));
  if (auto warning = rotation_warning(tilted_, tilt_)) out.push_back(*warning);
  if (std::string warning = turned_in_flight(); !warning.empty()) out.push_back(std::move(warning));
  for (std::size_t p = 0; p < model_.pairs.size(); ++p)
    if (auto warning = reach_warning(model_, model_.pairs[p], nearer_[p])) out.push_back(*warning);
  return out;
}

}  // namespace ricochet::contact
