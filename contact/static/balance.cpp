// SPDX-License-Identifier: BSD-2-Clause
#include "contact/static/balance.hpp"

#include <cmath>

#include "base/format.hpp"
#include "contact/complementarity/complementarity.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

// A cone is round, so a load on its surface is approached in steps, the rays of which become parallel.
constexpr double balanced_by_friction = 1e-7;
constexpr double aligned = 1e-10;  // cosine below which a ray does not point along the rest
constexpr int most_rays = 2000;    // a load within the cone needs a few times as many as rigid modes

/// The sums of the forces that come closest to f.
struct Closest {
  Vector left;       ///< (r) f − B_rᵀ p
  Vector magnitude;  ///< (r) sum of the magnitudes of its terms
};

/// Minimises |f − C x|² over x ≥ 0. The normal equations CᵀC lose half of the digits, so that a correction by
/// an orthogonal factorisation of the columns with x > 0 follows.
Vector least_squares(const MatrixXd& C, const Vector& f) {
  ComplementaritySolver solver(static_cast<int>(C.cols()));
  Vector x(C.cols());
  if (solver.solve(C.transpose() * C, C.transpose() * f, x) == SolveStatus::not_finite)
    throw SolverError("contact: the static problem is not finite");
  std::vector<Eigen::Index> used;
  for (Eigen::Index k = 0; k < x.size(); ++k)
    if (x(k) > 0) used.push_back(k);
  if (used.empty()) return x;
  const MatrixXd columns = C(Eigen::all, used);
  Vector better = x;
  better(used) += columns.completeOrthogonalDecomposition().solve(f - C * x);
  better = better.cwiseMax(0);
  return (f - C * better).norm() < (f - C * x).norm() ? better : x;
}

Closest closest_without_friction(const RigidModes& rigid, const Vector& f) {
  const Vector lambda = least_squares(rigid.B.transpose(), f);
  return {f - rigid.B.transpose() * lambda, f.cwiseAbs() + rigid.B.cwiseAbs().transpose() * lambda};
}

/// The sum B_rᵀ p (r) that points most along `rest`, over all forces with λ = 1 at one point; empty if none
/// does.
Vector best_ray(const Model& model, const RigidModes& rigid, const Vector& rest) {
  const Vector push = rigid.B * rest;
  Vector best;
  double largest = aligned * rest.norm();
  const auto offer = [&](Eigen::Index i, const Model::FrictionPoint* friction) {
    Vector ray = rigid.B.row(i).transpose();
    if (friction != nullptr) {
      const Eigen::Vector2d along = push.segment<2>(friction->tangential);
      if (const double length = along.norm(); length > 0)
        ray += (friction->law.static_coefficient / length) *
               (rigid.B.middleRows(friction->tangential, 2).transpose() * along);
    }
    const double length = ray.norm(), gain = length > 0 ? ray.dot(rest) / length : 0;
    if (gain <= largest) return;
    largest = gain;
    best = ray;
  };
  std::size_t next = 0;  // of model.friction
  for (Eigen::Index i = 0; i < model.points(); ++i) {
    const bool rubs = next < model.friction.size() && model.friction[next].point == i;
    offer(i, rubs ? &model.friction[next++] : nullptr);
  }
  return best;
}

/// The cone of all sums is spanned by few of its rays, which are found one by one: each is the one that
/// points most along the remainder of those before.
Closest closest_with_friction(const Model& model, const RigidModes& rigid, const Vector& f) {
  Closest out{f, f.cwiseAbs()};
  MatrixXd rays(f.size(), 0);
  for (int count = 0; count < most_rays && out.left.norm() > 0.1 * balanced_by_friction * f.norm(); ++count) {
    const Vector ray = best_ray(model, rigid, out.left);
    if (ray.size() == 0) break;
    MatrixXd more(f.size(), rays.cols() + 1);
    more << rays, ray;
    const Vector share = least_squares(more, f);
    const Vector left = f - more * share;
    if (left.norm() >= out.left.norm()) break;  // round-off
    out = {left, f.cwiseAbs() + more.cwiseAbs() * share};
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < share.size(); ++k)
      if (share(k) > 0) used.push_back(k);
    rays = more(Eigen::all, used);
  }
  return out;
}

/// The part of x (r) that belongs to the modes (N_b) of a body.
Vector part_of(const Bodies::Block& body, const RigidModes& rigid, const Vector& x) {
  Vector out = Vector::Zero(body.modes);
  for (std::size_t k = 0; k < rigid.mode.size(); ++k) {
    const Eigen::Index n = rigid.mode[k] - body.first_mode;
    if (n >= 0 && n < body.modes) out(n) = x(static_cast<Eigen::Index>(k));
  }
  return out;
}

[[noreturn]] void complain(const Model& model, const Bodies::Block& body, const Vector& rest) {
  const Vector3d force = body.momentum * rest;
  const Vector3d moment = body.angular_momentum * rest - body.centre.cross(force);
  throw InputError(
      base::format("bodies.{}: no contact forces hold it at rest: a force of [{:.4g}, {:.4g}, {:.4g}] N "
                   "and a moment of "
                   "[{:.4g}, {:.4g}, {:.4g}] N m about its centre stay unbalanced. Place it so that what "
                   "it touches "
                   "carries it{}, turn loads.gravity, or give it a support.",
                   body.name, force.x(), force.y(), force.z(), moment.x(), moment.y(), moment.z(),
                   model.friction.empty() ? " (without friction)" : ", raise contact.friction"));
}

}  // namespace

RigidModes::RigidModes(const Model& model) {
  for (Eigen::Index n = 0; n < model.omega.size(); ++n)
    if (model.omega(n) == 0) mode.push_back(n);
  B = model.B(Eigen::all, mode);
}

void check_balance(const Model& model, const RigidModes& rigid, const Vector& f) {
  if (f.isZero(0)) return;
  const bool rubs = !model.friction.empty();
  const double most = rubs ? balanced_by_friction : most_imbalance(false);
  const Closest sums = rubs ? closest_with_friction(model, rigid, f) : closest_without_friction(rigid, f);
  for (const Bodies::Block& body : model.bodies) {
    const Vector rest = part_of(body, rigid, sums.left);
    if (rest.norm() > most * part_of(body, rigid, sums.magnitude).norm()) complain(model, body, rest);
  }
}

void refuse_unbalanced(const Model& model, const RigidModes& rigid, const Vector& left) {
  const Bodies::Block* worst = nullptr;
  double largest = 0;
  for (const Bodies::Block& body : model.bodies)
    if (const double size = part_of(body, rigid, left).norm(); size > largest) {
      largest = size;
      worst = &body;
    }
  if (worst != nullptr) complain(model, *worst, part_of(*worst, rigid, left));
  throw SolverError("contact: the forces at rest stay unbalanced");
}

}  // namespace ricochet::contact
