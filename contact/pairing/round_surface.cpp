// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/round_surface.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// v/|v|, or `otherwise` at a centre of curvature.
Vector3d unit(const Vector3d& v, const Vector3d& otherwise) {
  const double length = v.norm();
  return length > 0 ? Vector3d(v / length) : otherwise;
}

/// In own axes, with what is outside free.
RoundSurface::At closest_outside(const RoundSurface& of, const Vector3d& x) {
  RoundSurface::At out;
  const Vector3d radial = unit({x.x(), x.y(), 0}, Vector3d::UnitX()), around(-radial.y(), radial.x(), 0);
  const double rho = std::hypot(x.x(), x.y());
  if (of.form == RoundSurface::Form::cone) {
    const double slant = std::hypot(of.length, of.radius - of.radius_small), n_rho = of.length / slant,
                 n_z = (of.radius - of.radius_small) / slant;
    out.normal = n_rho * radial + n_z * Vector3d::UnitZ();
    out.distance = (rho - of.radius) * n_rho + (x.z() + of.length / 2) * n_z;
    out.point = x - out.distance * out.normal;
    if (const double at = std::hypot(out.point.x(), out.point.y()); at > 0)
      out.curvature = n_rho / at * around * around.transpose();
    return out;
  }
  const bool is_torus = of.form == RoundSurface::Form::torus;
  const double height = std::clamp(x.z(), -of.length / 2, of.length / 2),
               tube = is_torus ? of.radius_small : of.radius;
  const Vector3d core = is_torus ? Vector3d(of.radius * radial) : Vector3d(0, 0, height), way = x - core;
  out.normal = unit(way, is_torus ? Vector3d::UnitZ() : radial);
  out.distance = way.norm() - tube;
  out.point = core + tube * out.normal;
  // Along the meridian, a tube and the ends of a capsule are circles; along the parallel, n turns with
  // radial.
  const Vector3d along = around.cross(out.normal);
  if (is_torus || height != x.z()) out.curvature = along * along.transpose() / tube;
  const double at = out.point.dot(radial), n_rho = out.normal.dot(radial);
  out.curvature += (is_torus ? n_rho / at : 1 / tube) * around * around.transpose();
  return out;
}

}  // namespace

RoundSurface::At RoundSurface::closest(const Vector3d& x) const noexcept {
  At out = closest_outside(*this, axes.transpose() * (x - origin));
  out.point = origin + axes * out.point;
  out.normal = side * (axes * out.normal);
  out.distance *= side;
  out.curvature = side * (axes * out.curvature * axes.transpose());
  return out;
}

}  // namespace ricochet::contact
