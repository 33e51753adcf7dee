// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A quadratic triangle x(w) = Σ w_j x_j + 4 Σ w_j w_{j+1} c_j.
struct Patch {
  std::array<Vector3d, 3> x, c;

  Patch(const WorldSurface& surface, const WorldSurface::Element& element) : c(element.bend) {
    for (int j = 0; j < 3; ++j) x[j] = surface.node[element.corner[std::min(j, surface.corners - 1)]];
  }
  Patch(const std::array<Vector3d, 3>& corners, const std::array<Vector3d, 3>& bends)
      : x(corners), c(bends) {}

  /// Bound on its distance from the flat triangle: Σ 4 w_j w_{j+1} ≤ 4/3.
  double off() const {
    return 4.0 / 3 * std::sqrt(std::max({c[0].squaredNorm(), c[1].squaredNorm(), c[2].squaredNorm()}));
  }

  /// Four halves of its size. The edges parallel to edge j have the bend c_j/4.
  std::array<Patch, 4> parts() const {
    std::array<Vector3d, 3> middle, quarter;
    for (int j = 0; j < 3; ++j) {
      middle[j] = (x[j] + x[(j + 1) % 3]) / 2 + c[j];
      quarter[j] = c[j] / 4;
    }
    return {Patch({x[0], middle[0], middle[2]}, quarter), Patch({middle[0], x[1], middle[1]}, quarter),
            Patch({middle[2], middle[1], x[2]}, quarter), Patch({middle[1], middle[2], middle[0]}, quarter)};
  }
};

double height(const Patch& patch, const Obstacle& b, double best, double tolerance) {
  double least = infinity, bend = 0;
  for (int j = 0; j < 3; ++j) {
    least = std::min(least, b.normal.dot(patch.x[j] - b.point));
    bend = std::max(bend, std::abs(b.normal.dot(patch.c[j])));
  }
  best = std::min(best, least);
  if (4.0 / 3 * bend <= tolerance || least - 4.0 / 3 * bend >= best) return best;
  for (const Patch& part : patch.parts()) best = height(part, b, best, tolerance);
  return best;
}

/// Square of the distance of two segments. Source: Ericson, Real-Time Collision Detection, 2005, 5.1.9.
double segments_apart(const Vector3d& p, const Vector3d& d, const Vector3d& q, const Vector3d& e) {
  const Vector3d r = p - q;
  const double a = d.squaredNorm(), f = e.squaredNorm(), b = d.dot(e), c = d.dot(r), g = e.dot(r),
               determinant = a * f - b * b;
  double s = determinant > 1e-14 * a * f ? std::clamp((b * g - c * f) / determinant, 0.0, 1.0) : 0;
  double t = f > 0 ? (b * s + g) / f : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0;
  }
  return (r + s * d - t * e).squaredNorm();
}

/// Whether the segment from p along d passes through a triangle.
bool pierces(const Vector3d& p, const Vector3d& d, const std::array<Vector3d, 3>& x) {
  const Vector3d e1 = x[1] - x[0], e2 = x[2] - x[0], normal = e1.cross(e2), r = p - x[0];
  const double determinant = -normal.dot(d);
  if (determinant == 0) return false;
  const Vector3d side = d.cross(r);
  const double t = normal.dot(r) / determinant, u = -e2.dot(side) / determinant,
               v = e1.dot(side) / determinant;
  return t >= 0 && t <= 1 && u >= 0 && v >= 0 && u + v <= 1;
}

/// Distance of flat triangles.
double flat_distance(const std::array<Vector3d, 3>& x, const std::array<Vector3d, 3>& y) {
  double square = infinity;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = x[(i + 1) % 3] - x[i], e = y[(i + 1) % 3] - y[i];
    if (pierces(x[i], d, y) || pierces(y[i], e, x)) return 0;
    square = std::min({square, square_distance(x[i], y), square_distance(y[i], x)});
    for (int j = 0; j < 3; ++j)
      square = std::min(square, segments_apart(x[i], d, y[j], y[(j + 1) % 3] - y[j]));
  }
  return std::sqrt(square);
}

/// The smaller of `best` and the distance of two patches. Patches are divided until their bends are within
/// the tolerance.
double distance(const Patch& a, const Patch& b, double best, double tolerance) {
  const double off_a = a.off(), off_b = b.off(), flat = flat_distance(a.x, b.x);
  best = std::min(best, flat + off_a + off_b);
  if (off_a + off_b <= tolerance) return std::min(best, flat);
  if (flat - off_a - off_b >= best - tolerance) return best;
  if (off_a >= off_b)
    for (const Patch& part : a.parts()) best = distance(part, b, best, tolerance);
  else
    for (const Patch& part : b.parts()) best = distance(a, part, best, tolerance);
  return best;
}

/// The objective of Eigen::BVMinimize on two trees.
struct Closest {
  using Scalar = double;
  const WorldSurface &a, &b;
  double tolerance, best = infinity;

  double minimumOnVolumeVolume(const Eigen::AlignedBox3d& one, const Eigen::AlignedBox3d& other) const {
    return one.exteriorDistance(other) + tolerance;
  }
  double minimumOnVolumeObject(const Eigen::AlignedBox3d& one, int other) const {
    return apart(one, b, other);
  }
  double minimumOnObjectVolume(int one, const Eigen::AlignedBox3d& other) const {
    return apart(other, a, one);
  }
  double minimumOnObjectObject(int one, int other) {
    return best = distance(Patch(a, a.element[one]), Patch(b, b.element[other]), best, tolerance);
  }

 private:
  double apart(const Eigen::AlignedBox3d& box, const WorldSurface& surface, int element) const {
    return box.exteriorDistance(surface.element[element].centre) - radius_of(surface.element[element]) +
           tolerance;
  }
};

}  // namespace

double surface_distance(const SurfaceProjection& a, const SurfaceProjection& b, double tolerance) {
  Closest closest{a.surface(), b.surface(), tolerance};
  Eigen::BVMinimize(a.elements(), b.elements(), closest);
  return closest.best;
}

double surface_distance(const WorldSurface& a, const Obstacle& b, double tolerance) {
  double best = infinity;
  for (const WorldSurface::Element& element : a.element) best = height(Patch(a, element), b, best, tolerance);
  return best;
}

}  // namespace ricochet::contact
