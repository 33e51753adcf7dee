// SPDX-License-Identifier: BSD-2-Clause
// Loads, moving supports and receivers, from the kernel of each body to the stacked model.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.hpp"
#include "contact/model/forcing.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;
using kernels::Kernel;

auto matrix(const std::vector<double>& values, Eigen::Index rows, Eigen::Index columns) {
  return Eigen::Map<const Matrix>(values.data(), rows, columns);
}

/// Returns the index of the kernel's entry of this name.
template <class Entry>
std::size_t place_of(const std::vector<Entry>& entries, const ForcingRequest& request, const char* what) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == request.name; });
  if (found != entries.end()) return static_cast<std::size_t>(found - entries.begin());
  std::string names;
  for (const Entry& entry : entries) names += (names.empty() ? "\"" : ", \"") + entry.name + "\"";
  throw InputError(base::format(
      "{}: the kernel of body \"{}\" has no \"{}\", only {}. Compute it again with ricochet-kernel.", what,
      request.body, request.name, names.empty() ? "none" : names));
}

/// Throws InputError if a vector is given for a pressure, or a pressure for another load.
void refuse_other_kind(const kernels::Load& load, const ForcingRequest& request) {
  if (load.inward == request.pressure.has_value()) return;
  throw InputError(base::format("loads: \"{}\" of body \"{}\" is {}", request.name, request.body,
                                load.inward
                                    ? "a pressure in its kernel: give pressure in place of vector."
                                    : "no pressure in its kernel: give vector in place of pressure."));
}

/// Throws InputError if a support jumps after t = 0, because that would be a shock of infinite energy. A
/// support that is displaced at t = 0 counts as having had this displacement always.
void refuse_jump(const ForcingRequest& request) {
  if (request.history.time.front() <= 0 || request.history.value.front() == 0) return;
  throw InputError(base::format(
      "loads.motion: the history of \"{}\" of body \"{}\" begins with the factor {} at t = {} s, "
      "so the support "
      "would jump. Begin it with a factor of 0, or at t = 0.",
      request.name, request.body, request.history.value.front(), request.history.time.front()));
}

}  // namespace

Vector3d response(const std::vector<double>& residual, const Model::Forcing& one, const Vector3d& along) {
  if (residual.empty()) return Vector3d::Zero();
  return matrix(residual, 3, residual.size() / 3).middleCols(3 * one.entry, 3) * along;
}

Vector share_of_a(const Model& model, int k, const Vector& u) {
  Vector out = Vector::Zero(u.size());
  for (const Model::PairBlock& pair : model.pairs)
    if (pair.a == k) out += pair.part_of(u);
  return out;
}

void add_forcing(Model& model, int k, const std::vector<ForcingRequest>& forcing) {
  const Bodies::Block& block = model.bodies[k];
  const Kernel& kernel = *block.kernel;
  for (const ForcingRequest& request : forcing) {
    if (request.body != block.name) continue;
    const std::size_t entry = request.support ? place_of(kernel.motions, request, "loads.motion")
                                              : place_of(kernel.applied, request, "loads");
    if (!request.support) refuse_other_kind(kernel.applied[entry], request);
    const Vector3d along = request.pressure ? Vector3d::Constant(*request.pressure)
                                            : Vector3d(block.rotation.transpose() * request.vector);
    Model::Forcing out{.name = request.name,
                       .body = k,
                       .first_mode = block.first_mode,
                       .support = request.support,
                       .entry = static_cast<int>(entry),
                       .vector = block.rotation * along,
                       .own = along,
                       .history = request.history,
                       .force = Vector::Zero(block.modes),
                       .lift = Vector::Zero(block.modes),
                       .displacement = Vector::Zero(model.rows()),
                       .displacement_a = {}};
    const std::vector<double>& residual =
        request.support ? kernel.motions[entry].residual : kernel.applied[entry].residual;
    const Selection& P = request.support ? model.selection[k] : model.static_selection[k];
    if (!residual.empty() && !model.turns)
      out.displacement = P * (matrix(residual, P.cols(), 3) * along).eval();
    if (request.support) {
      refuse_jump(request);
      const kernels::Motion& motion = kernel.motions[entry];
      out.lift = matrix(motion.participation, 3, block.modes).transpose() * along;
      if (!model.turns)  // Ψ = (Ψ − ΦΓ) + ΦΓ
        out.displacement += model.B.middleCols(block.first_mode, block.modes) * out.lift;
      out.lift_momentum =
          block.momentum * out.lift + block.rotation * (matrix(motion.momentum, 3, 3) * along);
    } else {
      const kernels::Load& load = kernel.applied[entry];
      out.force = matrix(load.participation, 3, block.modes).transpose() * along;
      out.own_total = matrix(load.total, 3, 3);
      out.own_moment = matrix(load.moment, 3, 3);
      for (int axis = 0; axis < 3; ++axis)
        out.own_moment.col(axis) -= block.own_centre().cross(Vector3d(out.own_total.col(axis)));
      out.total = block.rotation * (out.own_total * along);
      out.follows = request.axes.value_or(load.unit == "Pa" ? Axes::body : Axes::world) == Axes::body;
    }
    out.displacement_a = share_of_a(model, k, out.displacement);
    model.forcing.push_back(std::move(out));
  }
}

void add_receivers(Model& model, int k) {
  const Bodies::Block& block = model.bodies[k];
  const Selection& P = model.static_selection[k];
  for (const kernels::Receiver& receiver : block.kernel->receivers) {
    for (const Model::Receiver& other : model.receivers)
      if (other.name == receiver.name)
        throw InputError(
            base::format("output.receiver: \"{}\" names two points. Give each its own name.", other.name));
    Model::Receiver out{.name = receiver.name, .body = k, .shape = {}, .flexibility = {}, .forcing = {}};
    out.point = block.rotation * Eigen::Map<const Vector3d>(receiver.point.data()) + block.translation;
    out.shape = block.rotation * matrix(receiver.shape, 3, block.modes);
    if (!model.turns) out.flexibility = Matrix::Zero(3, P.rows());
    if (!model.turns && !receiver.residual_flexibility.empty())
      out.flexibility =
          -block.rotation * (matrix(receiver.residual_flexibility, 3, P.cols()) * P.transpose());
    if (!receiver.body_force_residual.empty())
      out.constant = block.rotation * (matrix(receiver.body_force_residual, 3, 3) *
                                       (block.rotation.transpose() * model.gravity));
    out.forcing = Matrix::Zero(3, model.forcing.size());
    for (std::size_t d = 0; d < model.forcing.size(); ++d) {
      const Model::Forcing& one = model.forcing[d];
      if (one.body != k) continue;
      const Vector3d along = block.rotation.transpose() * one.vector;
      const Vector3d residual =
          response(one.support ? receiver.motion_residual : receiver.load_residual, one, along);
      out.forcing.col(d) = block.rotation * residual + out.shape * one.lift;  // of a support: Ψ
    }
    model.receivers.push_back(std::move(out));
  }
}

namespace {

/// A motion like that of a support, which no body has.
void drive_rows(Model& model, const std::string& obstacle, const Vector3d& about,
                const DrivenMotion::Part& part) {
  const double turn = part.turn.norm() * part.history.peak(0, part.history.time.back());
  if (turn > most_driven_turn)
    throw InputError(base::format(
        "obstacles.{}: it turns by {:.3g} degrees, and with linear rotations points keep their pairs, which "
        "hold for 1. Set motion.rotation = \"finite\", or turn it less.",
        obstacle, turn * 180 / std::numbers::pi));
  Model::Forcing out{.name = obstacle,
                     .body = -1,
                     .support = true,
                     .entry = -1,
                     .history = part.history,
                     .force = Vector(0),
                     .lift = Vector(0),
                     .displacement = Vector::Zero(model.rows()),
                     .displacement_a = Vector::Zero(model.rows())};
  for (const Model::PairBlock& pair : model.pairs) {
    if (pair.obstacle != obstacle) continue;
    for (int i = 0; i < pair.points; ++i) {
      const Eigen::Index row = pair.first_point + i;
      const Vector3d moved =
          part.shift + part.turn.cross(Vector3d(model.point_b.row(row).transpose()) - about);
      out.displacement(row) = -model.normal.row(row).dot(moved);
      if (pair.first_tangential < 0 || pair.is_half_space()) continue;
      const Eigen::Index tangential = pair.first_tangential + 2 * i;
      out.displacement.segment<2>(tangential) =
          -model.tangent.middleRows<2>(tangential - model.points()) * moved;
    }
  }
  model.forcing.push_back(std::move(out));
  for (Model::Receiver& receiver : model.receivers) {
    receiver.forcing.conservativeResize(3, std::ssize(model.forcing));
    receiver.forcing.rightCols<1>().setZero();
  }
}

}  // namespace

void drive_obstacle(Model& model, const std::string& obstacle, const Vector3d& about,
                    const DrivenMotion& motion) {
  for (Model::PairBlock& pair : model.pairs) {
    if (pair.obstacle != obstacle) continue;
    DrivenMotion driven = motion;
    if (pair.is_half_space()) {
      const Vector3d normal = model.normal.row(pair.first_point);
      for (DrivenMotion::Part& part : driven.parts) part.shift = normal.dot(part.shift) * normal;
    }
    pair.driven = std::make_shared<const DrivenMotion>(std::move(driven));
  }
  for (const DrivenMotion::Part& part : motion.parts)
    if (!model.turns) drive_rows(model, obstacle, about, part);
}

void refuse_overlap(const Model& model) {
  Vector lifted = Vector::Zero(model.points());
  for (const Model::Forcing& one : model.forcing)
    if (one.support) lifted += one.history.at(0) * one.displacement.head(model.points());
  const double depth = lifted.size() > 0 ? (lifted - model.gap).maxCoeff() : 0;
  // 1e-9: of the lift: above the round-off of the sum over modes
  if (depth > 1e-9 * lifted.cwiseAbs().maxCoeff())
    throw InputError(
        base::format("loads.motion: supports displaced at t = 0 press the bodies {:.6g} m into each other "
                     "before they start. Begin "
                     "the history with 0, or start farther apart (contact.gap, bodies.*.translate).",
                     depth));
}

void refuse_early_contact(const Model& model, const std::vector<double>& arrival) {
  const Vector u = model.initial_displacement();
  for (const Model::PairBlock& pair : model.pairs) {
    const auto arrives = [&](int k) { return k >= 0 && arrival[static_cast<std::size_t>(k)] > 0; };
    if (!arrives(pair.a) && !arrives(pair.b)) continue;
    const int body = arrives(pair.a) ? pair.a : pair.b;
    // On a parabola that ends in front of the surface, only the start can be behind it.
    if ((u.segment(pair.first_point, pair.points) - model.gap.segment(pair.first_point, pair.points))
            .maxCoeff() > 0)
      throw InputError(base::format(
          "\"{}\" would start behind the surface that it strikes at {:.6g} s: with this gravity, raise its "
          "speed, or let it strike earlier",
          model.bodies[static_cast<std::size_t>(body)].name, arrival[static_cast<std::size_t>(body)]));
  }
}

void refuse_sag(const Model& model) {
  const Vector u = model.initial_displacement().head(model.points());
  Eigen::Index i = 0;
  const double depth = u.size() > 0 ? (u - model.gap).maxCoeff(&i) : 0;
  if (u.size() == 0 || model.turns) return;
  // 1e-9: of the displacement: above the round-off of the sum over modes. A body that lies on another one and
  // can move rigidly hardly deforms; its modal forces are then round-off of √m g.
  double weight = 0;
  for (Eigen::Index n = 0; n < model.omega.size(); ++n)
    if (model.omega(n) > 0) weight += std::abs(model.B(i, n)) / (model.omega(n) * model.omega(n));
  double mass = 0;
  for (const Bodies::Block& body : model.bodies) mass = std::max(mass, body.mass);
  weight *= std::sqrt(mass) * model.gravity.norm();
  const double negligible = 1e-9 * u.cwiseAbs().maxCoeff() + 1e-12 * weight;
  if (depth <= negligible) return;
  for (const Model::Forcing& one : model.forcing) {
    const double sudden = one.history.dead() ? 0 : one.history.at(0) * one.displacement(i);
    if (depth - sudden > negligible || one.support) continue;
    throw InputError(base::format(
        "loads: \"{}\" begins with the factor {:.6g} at t = 0, and a sudden load presses its points {:.6g} m "
        "into what they touch before contact can answer. Begin its history with 0, and let it rise within a "
        "step of time.contact_rate_hz.",
        one.name, one.history.at(0), depth));
  }
  for (const Model::PairBlock& pair : model.pairs)
    if (i >= pair.first_point && i < pair.first_point + pair.points)
      throw InputError(base::format(
          "loads: gravity and constant loads press \"{}\" {:.6g} m into \"{}\" before they start, as "
          "supported "
          "bodies start in their static equilibrium. Start farther apart by more than that (contact.gap, "
          "bodies.*.translate).",
          model.bodies[pair.a].name, depth, pair.b < 0 ? pair.obstacle : model.bodies[pair.b].name));
}

Vector Model::initial_displacement() const {
  if (turns) return Vector::Zero(rows());
  Vector out = B * q0 + static_displacement;
  for (const Forcing& one : forcing) out += one.history.at(0) * one.displacement;
  return out;
}

Vector Model::initial_rates() const {
  Vector out = v0;
  for (const Forcing& one : forcing)
    out.segment(one.first_mode, one.lift.size()) -= one.history.slope(0) * one.lift;
  return out;
}

Vector3d Model::momentum(int body, const Vector& v, double t) const {
  const Block& block = bodies[body];
  Vector3d out = block.momentum * v.segment(block.first_mode, block.modes);
  for (const Forcing& one : forcing)
    if (one.body == body) out += one.history.slope(t) * one.lift_momentum;
  return out;
}

Vector3d Model::angular_momentum(int body, const Vector& v, double t) const {
  const Block& block = bodies[body];
  Vector3d out = block.angular_momentum * v.segment(block.first_mode, block.modes);
  for (const Forcing& one : forcing)
    if (one.body == body) out += one.history.slope(t) * (block.angular_momentum * one.lift);
  return out;
}

}  // namespace ricochet::contact
