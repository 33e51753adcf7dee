// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/moving_point.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "contact/rows/rows.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A candidate may touch along a normal towards which its surface rises by less than this sine, that of the
/// facets of a smooth face.
constexpr double most_rise = 0.5;
/// The same for the faces beside creases, whose normals are exact.
constexpr double most_rise_at_crease = 1e-3;

/// Creases may cross beyond their ends by this share of their lengths, so that none slips between two.
constexpr double beyond_end = 1e-3;

/// A crossing of creases that is deeper than this share of them is on the far side of a body.
constexpr double deepest_crossing = 0.25;

/// A point is on a crease if their directions differ by less than this, as 1 − cosine.
constexpr double same_way = 1e-6;

/// Largest number of Newton's steps of a summit or along a crease, whose last one is shorter than this share
/// of an element or a crease.
constexpr int most_rounds = 8;
constexpr double shortest_way = 1e-8;
/// Surfaces with a larger angle between them do not touch at a summit.
constexpr double most_angle = 1e-2;
/// A foot whose normal turns in a round by more than this angle, as a cosine, has passed a crease.
constexpr double same_face = 0.7;
/// Surfaces with a smaller relative curvature are flat on each other, as a share of the inverse element.
constexpr double least_curvature = 1e-3;

/// Whether an obstacle is flat at a foot.
bool is_flat_obstacle(const Side& side, const Foot& foot) {
  return side.shape.surface().is_rigid && side.shape.curvature(foot).isZero(0);
}

/// Takes the top of a surface, which may be on a crease, to where it is nearest to another one, whose foot
/// below it is known, by Newton's method. Returns by how much the surface bends away from there [1/m].
double climb(Foot& top, const Side& own, Foot& foot, const Side& other) {
  const Matrix3d to_own = own.state.axes.transpose() * other.state.axes;
  Height height;
  for (int round = 0; round < most_rounds; ++round) {
    const Vector3d up = -(to_own * foot.normal);
    if (round > 0 && height.curvature.isZero(0) && up == height.up) break;  // the plane is known
    height = {up, to_own * other.shape.curvature(foot) * to_own.transpose(), top.point};
    top = own.shape.summit(top.element, height);
    foot = other.shape.follow(foot, other.place_of(top.point - own.centre, own));
    if ((top.point - height.at).norm() < shortest_way * own.shape.element_size(top)) break;
  }
  return own.shape.bend_down(top, height);
}

}  // namespace

void MovingPoint::End::set(const std::array<int, 3>& candidates,
                           const std::array<double, 3>& weights) noexcept {
  count = 0;
  if (body < 0) return;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(weights[k] > 0)) continue;
    candidate[static_cast<std::size_t>(count)] = candidates[k];
    weight[static_cast<std::size_t>(count++)] = weights[k];
  }
}

double MovingPoint::height(const FloatingBody& state) const noexcept {
  return gap - row.row(0).dot(state.position + state.axes * place - initial);
}

/// Sets the vectors of the rows to a normal, which turns them as little as possible.
void MovingPoint::set_row(const Vector3d& normal) noexcept {
  if (normal == row.row(0).transpose()) return;
  Vector3d tangent = row.row(1).transpose();
  tangent -= normal.dot(tangent) * normal;
  if (tangent.squaredNorm() > 0.1) {
    tangent.normalize();
    row.row(1) = tangent;
    row.row(2) = normal.cross(tangent);
  } else {
    row.bottomRows<2>() = tangents_of(normal);
  }
  row.row(0) = normal;
}

void MovingPoint::stand_on_creases(const WorldSurface& obstacle) {
  node = place;
  std::size_t count = 0;
  for (const WorldSurface::Crease& crease : obstacle.crease)
    for (std::size_t j = 0; j < 2 && count < half.size(); ++j) {
      if (crease.node[j] != candidate) continue;
      half[count] = (obstacle.node[static_cast<std::size_t>(crease.node[1 - j])] - node) / 2;
      spread = std::max(spread, half[count++].norm());
    }
}

/// Moves along the creases of an obstacle to where they are nearest to the surface of a body, by Newton's
/// method: the distance changes by n·t and its slope by t·Wt along a crease t. An edge that bodies touch
/// between its nodes so needs no finer nodes.
Foot MovingPoint::slide(Foot near, const Side& own, const Side& other) noexcept {
  const Matrix3d to_own = own.state.axes.transpose() * other.state.axes;
  for (int round = 0; round < most_rounds; ++round) {
    const Vector3d n = to_own * near.normal;
    const Vector3d* way = nullptr;
    double steepest = 0, at = (place - node).norm();
    for (const Vector3d& one : half) {
      const double length = one.norm();
      if (length == 0) continue;
      if (at > 0 ? (place - node).dot(one) > (1 - same_way) * at * length : n.dot(one) < steepest * length) {
        way = &one;
        steepest = n.dot(one) / length;
      }
    }
    if (way == nullptr) break;
    const double length = way->norm();
    const Vector3d t = *way / length, own_t = to_own.transpose() * t;
    const double slope = n.dot(t), turn = own_t.dot(other.shape.curvature(near) * own_t);
    // A flat face is nearest to a node.
    const double next = turn * length > least_curvature ? std::clamp(at - slope / turn, 0.0, length) : 0;
    if (std::abs(next - at) <= shortest_way * length) break;
    place = node + next * t;
    near = other.shape.follow(near, other.place_of(place, own));
  }
  return near;
}

void MovingPoint::meet(const Foot& found, const Side& own, const Side& other) noexcept {
  const Matrix3d to_own = own.state.axes.transpose() * other.state.axes;
  const auto suits = [&](const Vector3d& n) { return own.shape.rise(candidate, to_own * -n) <= most_rise; };
  const Foot near = spread > 0 ? slide(found, own, other) : found;
  const bool fits = suits(near.normal);
  foot = fits ? near : other.shape.settle(near, other.place_of(place, own), suits);
  distance = foot.distance;
  open = (!fits && !suits(foot.normal)) || other.is_left_to_creases(foot);
  set_row(kind == Kind::candidate_of_a ? Vector3d(-foot.normal) : foot.normal);
  end[kind == Kind::candidate_of_b ? 0 : 1].set(
      other.shape.surface().element[static_cast<std::size_t>(foot.element)].corner, foot.weight);
}

bool MovingPoint::cross(int of_a, int of_b, const Side& a, const Side& b) noexcept {
  const WorldSurface::Crease& one = a.shape.surface().crease[static_cast<std::size_t>(of_a)];
  const WorldSurface::Crease& two = b.shape.surface().crease[static_cast<std::size_t>(of_b)];
  const auto at = [](const Side& side, int node) -> Vector3d {
    return side.shape.surface().node[static_cast<std::size_t>(node)];
  };
  const Vector3d from = at(a, one.node[0]) - a.centre, to = at(a, one.node[1]) - a.centre;
  const Vector3d p0 = b.place_of(from, a), p1 = b.place_of(to, a), q0 = at(b, two.node[0]),
                 q1 = at(b, two.node[1]);
  crease = {of_a, of_b};
  open = true;
  double s = 0, t = 0;
  if (!crossing(p0, p1, q0, q1, s, t)) return false;
  open = std::max({-s, s - 1, -t, t - 1}) > beyond_end;
  s = std::clamp(s, 0.0, 1.0);
  t = std::clamp(t, 0.0, 1.0);
  const Matrix3d to_b = b.state.axes.transpose() * a.state.axes;
  Vector3d normal = (p1 - p0).cross(q1 - q0).normalized();
  if (normal.dot(to_b * one.normal) < 0) normal = -normal;
  for (std::size_t k = 0; k < 2; ++k)
    open = open || normal.dot(to_b * one.into[k]) > most_rise_at_crease ||
           -normal.dot(two.into[k]) > most_rise_at_crease;
  distance = normal.dot(q0 + t * (q1 - q0) - (p0 + s * (p1 - p0)));
  open = open || distance < -deepest_crossing * std::min((p1 - p0).norm(), (q1 - q0).norm());
  place = from + s * (to - from);
  set_row(normal);
  end[0].set({one.node[0], one.node[1], 0}, {1 - s, s, 0});
  end[1].set({two.node[0], two.node[1], 0}, {1 - t, t, 0});
  return !open;
}

void MovingPoint::stand_on(const Foot& summit, const Side& own) noexcept {
  top = summit;
  place = summit.point - own.centre;
  end[0].set(own.shape.surface().element[static_cast<std::size_t>(summit.element)].corner, summit.weight);
}

/// The angle t = n_own + n_other in the tangent plane changes by (W_own + W_other) dx: Newton's method, in
/// the directions that are curved. In others, surfaces touch along a line, on which the point stays. A crease
/// has many normals: there, and over a flat obstacle, the point climbs to where it is nearest to the other
/// side.
void MovingPoint::face(const Side& own, const Side& other) noexcept {
  const Matrix3d to_own = own.state.axes.transpose() * other.state.axes;
  const auto own_place = [&] { return other.place_of(top.point - own.centre, own); };
  const auto is_on_other = [&] { return !other.shape.surface().is_rigid && other.shape.is_at_crease(foot); };
  const double size = own.shape.element_size(top), least = least_curvature / size;
  bool climbs_on_other = false;
  for (int round = 0;; ++round) {
    const Vector3d before = foot.normal;
    // A crease that is pressed in would be nearer to one of its faces.
    if (!is_on_other()) foot = other.shape.follow(foot, own_place());
    const bool is_flat = is_flat_obstacle(other, foot);
    if (is_flat || own.shape.is_at_crease(top)) {
      const double bend = climb(top, own, foot, other);
      // Behind a far face of the obstacle, the summit is outside of it.
      open = is_flat ? foot.distance < -size && other.shape.closest(own_place()).distance > 0 : bend < least;
      break;
    }
    const bool has_passed = round > 0 && foot.normal.dot(before) < same_face;
    climbs_on_other = !other.shape.surface().is_rigid && (is_on_other() || has_passed);
    if (climbs_on_other) {
      open = climb(foot, other, top, own) < least;
      break;
    }
    const Vector3d facing = to_own * foot.normal;
    const Eigen::Matrix<double, 2, 3> T = tangents_of(top.normal);
    const Vector2d angle = T * facing;
    Eigen::SelfAdjointEigenSolver<Matrix2d> W;
    W.computeDirect(T *
                    (own.shape.curvature(top) + to_own * other.shape.curvature(foot) * to_own.transpose()) *
                    T.transpose());
    open = !(top.normal.dot(facing) < 0) || W.eigenvalues()(0) < -least || W.eigenvalues()(1) < least;
    if (open) break;
    Vector2d way = Vector2d::Zero();
    for (int k = 0; k < 2; ++k)
      if (W.eigenvalues()(k) > least)
        way -= W.eigenvectors().col(k) * (W.eigenvectors().col(k).dot(angle) / W.eigenvalues()(k));
    const double length = way.norm();
    if (length < shortest_way * size || round == most_rounds) {
      open = angle.norm() > most_angle;
      break;
    }
    top = own.shape.beside(top, T.transpose() * way * std::min(1.0, size / length));
  }
  // Creases that meet cross.
  open = open || (climbs_on_other ? own.shape.is_at_crease(top) : other.shape.is_at_crease(foot));
  stand_on(top, own);
  distance = (climbs_on_other ? top : foot).distance;
  set_row(climbs_on_other ? Vector3d(to_own.transpose() * top.normal) : Vector3d(-foot.normal));
  end[1].set(other.shape.surface().element[static_cast<std::size_t>(foot.element)].corner, foot.weight);
}

void MovingPoint::follow(const Side& own, const Side& other) noexcept {
  if (kind == Kind::creases)
    cross(crease[0], crease[1], own, other);
  else if (kind == Kind::summit)
    face(own, other);
  else
    meet(other.shape.follow(foot, other.place_of(place, own)), own, other);
}

double MovingPoint::nearer(const Vector3d& of_own, const Vector3d& of_other, const Side& own,
                           const Side& other) const noexcept {
  const double sign = kind == Kind::candidate_of_b ? -1 : 1;  // the normal leads out of a
  return sign * row.row(0).dot(other.state.axes.transpose() * (own.state.axes * of_own) - of_other);
}

}  // namespace ricochet::contact
