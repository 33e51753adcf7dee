// SPDX-License-Identifier: BSD-2-Clause
#include "contact/accuracy/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/output/summary.hpp"
#include "contact/static/equilibrium.hpp"
#include "contact/stepping/run_steps.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// A body that can move rigidly, with the number of its rigid modes, which come first among its modes.
struct Mover {
  int body;
  Eigen::Index rigid;
};

std::vector<Mover> movers(const Model& model) {
  std::vector<Mover> out;
  for (std::size_t k = 0; k < model.bodies.size(); ++k) {
    const Model::BodyBlock& body = model.bodies[k];
    const auto omega = model.omega.segment(body.first_mode, body.modes).array();
    if (const Eigen::Index rigid = (omega == 0).count(); rigid > 0)
      out.push_back({static_cast<int>(k), rigid});
  }
  return out;
}

/// Mean velocity of each body [m/s]; 0 if supports hold it. The rigid modes of a free body carry all of its
/// momentum and no vibration.
std::vector<Vector3d> velocities(const Model& model, const std::vector<Mover>& movers, const Vector& v) {
  std::vector<Vector3d> out(model.bodies.size(), Vector3d::Zero());
  for (const Mover& mover : movers) {
    const Model::BodyBlock& body = model.bodies[mover.body];
    out[mover.body] =
        body.momentum.leftCols(mover.rigid) * v.segment(body.first_mode, mover.rigid) / body.mass;
  }
  return out;
}

double approach(const Model& model, const std::vector<Vector3d>& velocity) {
  double fastest = 0;
  for (const Model::PairBlock& pair : model.pairs) {
    Vector3d relative = velocity[pair.a];
    if (pair.b >= 0) relative -= velocity[pair.b];
    const Vector3d normal = model.normal.middleRows(pair.first_point, pair.points).colwise().mean();
    fastest = std::max(fastest, relative.dot(normal));
  }
  return fastest;
}

}  // namespace

double distance(const Quantities& a, const Quantities& b) {
  double largest = 0;
  for (Eigen::Index i = 0; i < a.value.size(); ++i) {
    const double apart = std::abs(a.value[i] - b.value[i]);
    if (apart > 0)
      largest =
          std::max(largest, a.scale[i] > 0 ? apart / a.scale[i] : std::numeric_limits<double>::infinity());
  }
  return largest;
}

std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, const std::function<void()>& poll) {
  const std::unique_ptr<Stepper> stepper = make_stepper(model, options);
  const std::vector<Mover> moving = movers(model);
  std::vector<Vector3d> before = velocities(model, moving, model.initial_rates()), start = before,
                        end = before;
  double impulse = 0, longest = 0;
  std::int64_t touch = 0;
  bool touched = false;
  const auto observe = [&](std::int64_t) {
    if (poll) poll();
    const double force = stepper->force().sum();
    if (force > 0 || !touched) before = velocities(model, moving, stepper->modal()->v);
    if (force > 0) {
      touched = true;
      impulse += force * options.step;
      longest = std::max(longest, static_cast<double>(++touch) * options.step);
      end = before;
    } else {
      touch = 0;
      if (!touched) start = end = before;
    }
  };
  if (run_steps(*stepper, steps, observe).status != StepStatus::ok) return std::nullopt;
  Quantities out;
  const auto count = static_cast<Eigen::Index>(moving.size());
  out.value.setZero(1 + 3 * count);
  out.scale.setZero(1 + 3 * count);
  out.value[0] = out.scale[0] = impulse;
  out.longest_touch = longest;
  double speed = approach(model, start);
  for (const Mover& mover : moving) speed = std::max(speed, (end[mover.body] - start[mover.body]).norm() / 2);
  for (Eigen::Index k = 0; k < count; ++k) {
    out.value.segment<3>(1 + 3 * k) = end[moving[k].body];
    out.scale.segment<3>(1 + 3 * k).setConstant(speed);
  }
  return out;
}

Quantities rest_quantities(const Model& model) {
  const EquilibriumSummary found = summarise(model, find_equilibrium(model));
  Quantities out;
  out.value.setZero(2 * found.pairs.size());
  for (std::size_t p = 0; p < found.pairs.size(); ++p) {
    const auto i = 2 * static_cast<Eigen::Index>(p);
    out.value[i] = found.pairs[p].force_n;
    out.value[i + 1] = found.pairs[p].approach_m;
  }
  out.scale = out.value.cwiseAbs();
  return out;
}

}  // namespace ricochet::contact
