// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/passage_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "contact/pairing/crease_points.hpp"

namespace ricochet::contact {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

constexpr double straight = 0.9;
constexpr double share_of_motion = 0.25;  // of an element, between two looks

PlacedBody placed(const Bodies::Block& body) {
  return {
      .name = body.name, .kernel = body.kernel, .rotation = body.rotation, .translation = body.translation};
}

/// The surface after a small displacement u(x), rotated by `turn`.
template <class Displacement>
WorldSurface moved(WorldSurface surface, const Displacement& u, const Vector3d& turn) {
  const auto rotate = [&](Vector3d& v) { v = (v + turn.cross(v)).eval(); };
  for (auto* points : {&surface.node, &surface.crest})
    for (Vector3d& x : *points) x += u(x);
  for (Vector3d& n : surface.normal) rotate(n);
  for (WorldSurface::Element& element : surface.element) {
    element.centre += u(element.centre);
    for (Vector3d& n : element.normal) rotate(n);
    for (Vector3d& c : element.bend) rotate(c);
    rotate(element.bubble);
  }
  for (WorldSurface::Crease& crease : surface.crease) {
    for (Vector3d& v : crease.into) rotate(v);
    rotate(crease.normal);
  }
  return surface;
}

Eigen::AlignedBox3d box_of(const SurfaceProjection& surface) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : surface.surface().node) box.extend(x);
  return box;
}

/// Largest depth of a node of one body inside the other, and of creases that cross. No node has come deeper
/// than it has moved, at most by `moved`.
double depth(const SurfaceProjection& a, const SurfaceProjection& b, double moved) {
  double deepest = 0;
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Vector3d& x : one->surface().node)
      if (const auto y = other->closest(x, moved))
        // Beyond the end of an open surface, the closest point is not opposite.
        if (const double inside = -y->normal.dot(x - y->point); inside > straight * (x - y->point).norm())
          deepest = std::max(deepest, inside);
  }
  Pairing crossings;
  add_crease_points(a, Vector3d::Zero(), b, {}, crossings);
  for (const Pairing::Point& point : crossings.points) deepest = std::max(deepest, -point.gap);
  return deepest;
}

}  // namespace

PassageCheck::PassageCheck(const Model& model) : model_(model) {
  for (std::size_t p = 0; p < model.pairs.size(); ++p) {
    const Model::PairBlock& pair = model.pairs[p];
    if (pair.b < 0 || pair.points == 0 || model.turns) continue;  // any part may meet if bodies turn
    Meeting meeting{.pair = static_cast<int>(p),
                    .a = surface_of(placed(model.bodies[pair.a])),
                    .b = SurfaceProjection(surface_of(placed(model.bodies[pair.b])))};
    if (meeting.a.corners != 3 || meeting.b.surface().corners != 3) continue;
    meeting.element = std::min(smallest_element(meeting.a), smallest_element(meeting.b.surface()));
    meeting.least = share_of_element * meeting.element +
                    times_bulge * model.bulge.segment(pair.first_point, pair.points).maxCoeff();
    Eigen::AlignedBox3d box;
    for (const Vector3d& x : meeting.a.node) box.extend(x);
    meeting.corners.resize(3, 8);
    for (int k = 0; k < 8; ++k)
      meeting.corners.col(k) = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
    meeting.looked_at = Matrix3Xd::Zero(3, 8);
    meetings_.push_back(std::move(meeting));
  }
}

void PassageCheck::observe(const std::vector<RigidMotion>& motion, double time) {
  for (Meeting& meeting : meetings_) {
    if (meeting.looks == most_looks) continue;
    const Model::PairBlock& pair = model_.pairs[meeting.pair];
    const RigidMotion &of_a = motion[pair.a], &of_b = motion[pair.b];
    const auto relative = [&](const Vector3d& x) -> Vector3d { return of_a.at(x) - of_b.at(x); };
    Matrix3Xd now(3, 8);
    for (int k = 0; k < 8; ++k) now.col(k) = relative(meeting.corners.col(k));
    if ((now - meeting.looked_at).colwise().norm().maxCoeff() < share_of_motion * meeting.element) continue;
    meeting.looked_at = now;
    ++meeting.looks;
    const SurfaceProjection a(moved(meeting.a, relative, of_a.rotation - of_b.rotation));
    if (!box_of(a).intersects(box_of(meeting.b))) continue;
    double approach = 0;
    for (int i = pair.first_point; i < pair.first_point + pair.points; ++i) {
      const Vector3d x = model_.point_a.row(i), y = model_.point_b.row(i), n = model_.normal.row(i);
      approach = std::max(approach, n.dot(x + of_a.at(x) - y - of_b.at(y)));
    }
    const double deepest = depth(a, meeting.b, now.colwise().norm().maxCoeff());
    if (deepest <= std::max(meeting.deepest, meeting.least + times_approach * approach)) continue;
    meeting.deepest = deepest;
    meeting.time = time;
  }
}

std::vector<std::string> PassageCheck::warnings() const {
  std::vector<std::string> out;
  for (const Meeting& meeting : meetings_) {
    if (meeting.deepest == 0) continue;
    const Model::PairBlock& pair = model_.pairs[meeting.pair];
    out.push_back(fmt::format(
        "{} passes {:.3g} m through {} at t = {:.4g} s, with parts that have no contact points there. "
        "Remove contact.direction, increase contact.reach or contact.zone, or exchange the bodies in "
        "contact.between",
        model_.bodies[pair.a].name, meeting.deepest, model_.bodies[pair.b].name, meeting.time));
  }
  return out;
}

}  // namespace ricochet::contact
