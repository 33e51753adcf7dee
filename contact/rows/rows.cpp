// SPDX-License-Identifier: BSD-2-Clause
#include "contact/rows/rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/format.hpp"
#include "kernels/crease_angle.hpp"
#include "kernels/flexibility.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {
namespace {

using Eigen::Vector3d;

/// Cosine of the angle up to which faces that meet are one smooth face.
const double smooth = std::cos(kernels::crease_angle);

/// Index in the kernel of each candidate of the whole surface, or −1. Empty if the kernel contains all
/// candidates.
std::vector<int> held_candidates(const kernels::Surface& surface) {
  if (!surface.whole) return {};
  std::vector<int> out(surface.whole->area.size(), -1);
  for (std::size_t i = 0; i < surface.whole->held.size(); ++i)
    out[surface.whole->held[i]] = static_cast<int>(i);
  return out;
}

[[noreturn]] void refuse_missing(const PlacedBody& body, const PairRequest& request, int candidate) {
  throw InputError(base::format(
      "contact between \"{}\" and \"{}\": the kernel of \"{}\" holds too few candidates: candidate {} of "
      "{}, which faces \"{}\", is missing. Run ricochet-kernel for this scene, or lower contact.reach or "
      "contact.zone.",
      request.a, request.b, body.name, candidate, body.kernel->surface.whole->area.size(),
      body.name == request.a ? request.b : request.a));
}

[[noreturn]] void refuse_tilt(const PlacedBody& body, const PairRequest& request, double cosine) {
  throw InputError(base::format(
      "contact between \"{}\" and \"{}\": the kernel of \"{}\" holds the residual flexibility along its own "
      "normals alone, but a pair is tilted by {:.2g} degrees. Run ricochet-kernel for this scene, or set "
      "modes.residual_components = \"all\".",
      request.a, request.b, body.name, std::acos(cosine) * 180 / std::numbers::pi));
}

[[noreturn]] void refuse_normals(const PlacedBody& body, const PairRequest& request) {
  throw InputError(
      base::format("contact between \"{}\" and \"{}\": friction needs all components, but the kernel of "
                   "\"{}\" holds {}. Run "
                   "ricochet-kernel for this scene, or leave contact.friction out.",
                   request.a, request.b, body.name,
                   body.kernel->surface.direction ? "the motion along one direction alone"
                                                  : "the residual flexibility along its normals alone"));
}

/// How many smooth faces meet at each candidate of the whole surface.
std::vector<int> faces_at(const kernels::Surface& surface) {
  const auto count = [](std::size_t candidates, const std::vector<std::int64_t>& element,
                        const std::vector<double>& element_normal) {
    std::vector<std::vector<Vector3d>> seen(candidates);
    for (std::size_t k = 0; 3 * k < element_normal.size(); ++k) {
      const Vector3d n = Eigen::Map<const Vector3d>(&element_normal[3 * k]);
      auto& here = seen[static_cast<std::size_t>(element[k])];
      if (std::ranges::none_of(here, [&](const Vector3d& other) { return other.dot(n) > smooth; }))
        here.push_back(n);
    }
    std::vector<int> out;
    for (const auto& here : seen) out.push_back(std::max(1, static_cast<int>(here.size())));
    return out;
  };
  return surface.whole
             ? count(surface.whole->area.size(), surface.whole->element, surface.whole->element_normal)
             : count(surface.size(), surface.element, surface.element_normal);
}

/// The number of faces at each point, of the body that has a candidate there.
std::vector<int> faces_of_points(const std::vector<PlacedBody>& bodies,
                                 const std::vector<ContactPair>& pairs) {
  constexpr double itself = 1 - 1e-9;  // weight of a candidate at the point
  std::vector<std::vector<int>> faces;
  for (const PlacedBody& body : bodies) faces.push_back(faces_at(body.kernel->surface));
  std::vector<int> out;
  for (const ContactPair& pair : pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      out.push_back(1);
      const auto see = [&](int body, const Pairing::Weights& weights) {
        for (const auto& [candidate, weight] : weights)
          if (body >= 0 && weight > itself)
            out.back() = std::max(out.back(),
                                  faces[static_cast<std::size_t>(body)][static_cast<std::size_t>(candidate)]);
      };
      see(pair.a, point.of_a);
      see(pair.b, point.of_b);
    }
  return out;
}

/// Returns P (n, cM) with u = Σ_bodies P · (displacement of the candidates of the body in its own frame).
/// Normal rows contain n for body a and −n W for body b; tangential rows contain the tangents instead.
/// @param c  3, or 1 for displacements along the direction of the kernel or along the normals
Selection selection(const PlacedBody& body, int index, const std::vector<ContactPair>& pairs,
                    const Rows& rows, int c) {
  const kernels::Surface& surface = body.kernel->surface;
  const bool along_normals = c == 1 && !surface.direction;
  Selection out(rows.rows(), c * static_cast<int>(surface.size()));
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  std::size_t next = 0;  // of rows.friction
  const std::vector<int> held = held_candidates(surface);
  for (const ContactPair& pair : pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      const Vector3d n = body.rotation.transpose() * point.normal;
      const auto add = [&](int number, double weight) {
        const int candidate = held.empty() ? number : held[number];
        if (candidate < 0) refuse_missing(body, pair.request, number);
        if (pair.request.friction) {
          if (c == 1) refuse_normals(body, pair.request);
          const int first = rows.friction[next].tangential;
          const Eigen::Matrix<double, 2, 3> t = tangents_of(point.normal) * body.rotation;
          for (int along = 0; along < 2; ++along)
            for (int k = 0; k < 3; ++k)
              entries.emplace_back(first + along, 3 * candidate + k, weight * t(along, k));
        }
        if (along_normals) {
          const double cosine = n.dot(Eigen::Map<const Vector3d>(&surface.normal[3 * candidate]));
          if (std::abs(cosine) < std::cos(most_tilt)) refuse_tilt(body, pair.request, std::abs(cosine));
          entries.emplace_back(row, candidate, std::copysign(weight, weight * cosine));
        } else if (c == 1)  // check_component ensures that n is ± the stored direction
          entries.emplace_back(
              row, candidate,
              std::copysign(weight, weight * n.dot(Eigen::Map<const Vector3d>(surface.direction->data()))));
        else
          for (int k = 0; k < 3; ++k) entries.emplace_back(row, 3 * candidate + k, weight * n(k));
      };
      if (pair.a == index)
        for (const auto& [candidate, weight] : point.of_a) add(candidate, weight);
      if (pair.b == index)
        for (const auto& [candidate, weight] : point.of_b) add(candidate, -weight);
      ++row;
      if (pair.request.friction) ++next;
    }
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Lists pairs and friction points, and returns the number of rows.
int list_pairs(const Placement& placement, Rows& out) {
  const auto& [bodies, pairs] = placement;
  int points = 0;
  for (const ContactPair& pair : pairs) {
    const int count = static_cast<int>(pair.pairing.points.size());
    out.pairs.push_back({points, count, pair.pairing.unpaired, pair.a, pair.b, {}});
    Rows::PairBlock& block = out.pairs.back();
    if (pair.pairing.beyond_reach > 0) block.reach = pair.pairing.reach;
    if (count > 0) block.initial_gap = std::ranges::min(pair.pairing.points, {}, &Pairing::Point::gap).gap;
    block.apart = pair.apart;
    block.candidates_of_a = pair.pairing.candidates_of_a;
    block.candidates_of_b = pair.pairing.candidates_of_b;
    block.summits = pair.pairing.summits;
    block.solid = pair.solid;
    if (pair.b < 0) block.obstacle = pair.request.a == bodies[pair.a].name ? pair.request.b : pair.request.a;
    points += count;
  }
  int rows = points;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (const auto& law = pairs[k].request.friction) {
      Rows::PairBlock& block = out.pairs[k];
      block.first_tangential = rows;
      for (int i = 0; i < block.points; ++i, rows += 2)
        out.friction.push_back({block.first_point + i, rows, *law});
    }
  return rows;
}

/// Sets where the points are, and their normals and tangents.
void set_points(const Placement& placement, Eigen::Index rows, Rows& out) {
  const Eigen::Index points = rows - 2 * std::ssize(out.friction);
  for (Vector* v : {&out.gap, &out.bulge, &out.area}) v->setZero(points);
  for (Matrix* x : {&out.point_a, &out.point_b, &out.normal}) x->setZero(points, 3);
  Eigen::Index i = 0;
  for (const ContactPair& pair : placement.pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      out.gap(i) = point.gap;
      out.bulge(i) = point.bulge;
      out.area(i) = point.area;
      out.point_a.row(i) = point.a;
      out.point_b.row(i) = point.b;
      out.normal.row(i++) = point.normal;
    }
  out.faces = faces_of_points(placement.bodies, placement.pairs);
  out.tangent.resize(rows - points, 3);
  for (const Rows::FrictionPoint& point : out.friction)
    out.tangent.middleRows(point.tangential - points, 2) =
        tangents_of(out.normal.row(point.point).transpose());
}

/// x += P_i F of a row i of a selection.
void add_row(const Selection& P, Eigen::Index i, const kernels::Flexibility& F, double* x) noexcept {
  for (Selection::InnerIterator entry(P, i); entry; ++entry)
    F.add_row(static_cast<std::size_t>(entry.col()), entry.value(), x);
}
void add_row(const Selection& P, Eigen::Index i, const Eigen::Map<const Matrix>& F, double* x) noexcept {
  for (Selection::InnerIterator entry(P, i); entry; ++entry) {
    const double weight = entry.value();
    const double* const from = F.data() + entry.col() * F.cols();
    for (Eigen::Index c = 0; c < F.cols(); ++c) x[c] += weight * from[c];
  }
}

/// P_i x of a row i of a selection.
double along(const Selection& P, Eigen::Index i, const double* x) noexcept {
  double sum = 0;
  for (Selection::InnerIterator entry(P, i); entry; ++entry) sum += entry.value() * x[entry.col()];
  return sum;
}

/// R along n between the points of a body with these weights.
double flexibility_of(const PlacedBody& body, const Pairing::Weights& weights, const Vector3d& n) {
  const kernels::Surface& surface = body.kernel->surface;
  if (!surface.has_flexibility() || surface.components != 3 || surface.normal_residual) return 0;
  const kernels::Flexibility flexibility(surface);
  const Vector3d own = body.rotation.transpose() * n;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R;
  double out = 0;
  for (const auto& [i, of_i] : weights)
    for (const auto& [j, of_j] : weights) {
      flexibility.block(static_cast<std::size_t>(i), static_cast<std::size_t>(j), R.data());
      out += of_i * of_j * own.dot(R * own);
    }
  return out;
}

/// Of bodies that turn: sets the candidates of the points, and R_ii of those whose patches bulge.
void set_candidates(const Placement& placement, Rows& out) {
  std::vector<std::vector<int>> held;
  for (const PlacedBody& body : placement.bodies) held.push_back(held_candidates(body.kernel->surface));
  out.patch_R.setZero(out.rows());
  for (std::size_t p = 0; p < placement.pairs.size(); ++p) {
    const ContactPair& pair = placement.pairs[p];
    const Rows::PairBlock& block = out.pairs[p];
    for (int i = 0; i < block.points; ++i) {
      const Pairing::Point& point = pair.pairing.points[static_cast<std::size_t>(i)];
      for (const auto& [k, weights] : {std::pair(pair.a, &point.of_a), std::pair(pair.b, &point.of_b)}) {
        if (k < 0) continue;
        const auto at = static_cast<std::size_t>(k);
        const PlacedBody& body = placement.bodies[at];
        for (const auto& [candidate, weight] : *weights)
          if (!held[at].empty() && held[at][static_cast<std::size_t>(candidate)] < 0)
            refuse_missing(body, pair.request, candidate);
        const kernels::Surface& surface = body.kernel->surface;
        if (pair.request.friction && (surface.components == 1 || surface.normal_residual))
          refuse_normals(body, pair.request);
        if (point.bulge > 0)
          out.patch_R(block.first_point + i) += flexibility_of(body, *weights, point.normal);
      }
      const bool of_b = i >= block.candidates_of_a && i < block.candidates();
      out.candidate.push_back((of_b ? point.of_b : point.of_a).front().first);
    }
  }
}

}  // namespace

/// The first tangent is perpendicular to the axis of the world that is closest to the tangent plane.
Eigen::Matrix<double, 2, 3> tangents_of(const Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  Eigen::Matrix<double, 2, 3> out;
  out.row(0) = normal.cross(Vector3d::Unit(axis)).normalized();
  out.row(1) = normal.cross(Vector3d(out.row(0)));
  return out;
}

Vector Rows::PairBlock::part_of(const Vector& x) const {
  Vector out = Vector::Zero(x.size());
  out.segment(first_point, points) = x.segment(first_point, points);
  if (first_tangential >= 0)
    out.segment(first_tangential, 2 * points) = x.segment(first_tangential, 2 * points);
  return out;
}

Vector3d Rows::friction_resultant(const PairBlock& pair, const Vector& force, const RowFrames& frames) const {
  if (pair.first_tangential < 0) return Vector3d::Zero();
  return frames.tangent.middleRows(pair.first_tangential - points(), 2 * pair.points).transpose() *
         force.segment(pair.first_tangential, 2 * pair.points);
}

Vector3d Rows::resultant(const PairBlock& pair, const Vector& force, const RowFrames& frames) const {
  return frames.normal.middleRows(pair.first_point, pair.points).transpose() *
             force.segment(pair.first_point, pair.points) +
         friction_resultant(pair, force, frames);
}

void use_mean_gaps(Rows& rows) {
  if (rows.bulge.size() == 0) return;
  rows.gap += rows.bulge;
  rows.bulge.setZero();
}

void add_belt(Rows& rows, const std::string& obstacle, const Vector3d& vector, History history) {
  Rows::Belt belt{obstacle, Vector::Zero(rows.rows()), std::move(history)};
  for (const Rows::PairBlock& pair : rows.pairs) {
    if (pair.obstacle != obstacle || pair.first_tangential < 0) continue;
    belt.slide.segment(pair.first_tangential, 2 * pair.points) =
        rows.tangent.middleRows(pair.first_tangential - rows.points(), 2 * pair.points) * vector;
  }
  if (belt.history.time.front() > 0 && belt.history.value.front() != 0)
    throw InputError(
        base::format("obstacles.{}: its history begins with the factor {} at t = {} s, so the obstacle would "
                     "jump. Begin it "
                     "with a factor of 0, or at t = 0.",
                     obstacle, belt.history.value.front(), belt.history.time.front()));
  if (!belt.slide.isZero(0)) rows.belts.push_back(std::move(belt));
}

Rows build_rows(const Placement& placement, const Bodies& bodies) {
  Rows out;
  const Eigen::Index rows = list_pairs(placement, out);
  set_points(placement, rows, out);
  out.turns =
      std::ranges::any_of(placement.pairs, [](const ContactPair& pair) { return pair.request.everywhere; });
  if (!out.turns) {
    out.B.setZero(rows, bodies.omega.size());
    out.R.setZero(rows, rows);
    if (std::ranges::any_of(out.pairs, [](const Rows::PairBlock& pair) { return pair.b >= 0; }))
      out.R_a.setZero(rows, rows);
  }
  for (Vector* v : {&out.static_displacement, &out.static_a}) v->setZero(rows);
  Eigen::Index most = 0;
  for (std::size_t k = 0; k < placement.bodies.size(); ++k) {
    const kernels::Surface& surface = placement.bodies[k].kernel->surface;
    const auto select = [&](int c) {
      if (out.turns) return Selection(0, c * static_cast<int>(surface.size()));
      return selection(placement.bodies[k], static_cast<int>(k), placement.pairs, out, c);
    };
    out.selection.push_back(select(surface.components));
    out.static_selection.push_back(surface.normal_residual ? select(1) : out.selection.back());
    out.has_residual = out.has_residual && surface.has_flexibility();
    most = std::max(most, out.selection.back().cols());
  }
  out.yielded.setZero(most);
  out.body_a.resize(static_cast<std::size_t>(rows));
  if (out.turns)
    set_candidates(placement, out);
  else
    fill(out, bodies);
  for (Eigen::Index i = 0; i < out.points(); ++i)
    if (!((out.turns ? out.patch_R(i) : out.R(i, i)) > 0)) out.gap(i) += std::exchange(out.bulge(i), 0.0);
  return out;
}

void fill(Rows& rows, const Bodies& bodies) noexcept {
  for (Matrix* x : {&rows.B, &rows.R, &rows.R_a}) x->setZero();
  for (Vector* x : {&rows.static_displacement, &rows.static_a}) x->setZero();
  for (const Rows::PairBlock& pair : rows.pairs) {
    std::fill_n(rows.body_a.begin() + pair.first_point, pair.points, pair.a);
    if (pair.first_tangential >= 0)
      std::fill_n(rows.body_a.begin() + pair.first_tangential, 2 * pair.points, pair.a);
  }
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k) {
    const Bodies::Block& block = bodies.bodies[k];
    const kernels::Surface& surface = block.kernel->surface;
    const Selection &of_modes = rows.selection[k], &P = rows.static_selection[k];
    const Eigen::Map<const Matrix> shape(surface.shape.data(), of_modes.cols(), block.modes);
    const kernels::Flexibility flexibility(surface);
    const auto& settling = block.kernel->loads.body_force_residual;
    const Vector3d gravity = block.rotation.transpose() * bodies.gravity;
    const auto is_a = [&](Eigen::Index row) {
      return rows.body_a[static_cast<std::size_t>(row)] == static_cast<int>(k);
    };
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      add_row(of_modes, i, shape, rows.B.row(i).data() + block.first_mode);
      if (!settling.empty()) {
        double s = 0;
        for (Selection::InnerIterator entry(P, i); entry; ++entry)
          s += entry.value() *
               Eigen::Map<const Vector3d>(&settling[3 * static_cast<std::size_t>(entry.col())]).dot(gravity);
        rows.static_displacement(i) += s;
        if (is_a(i)) rows.static_a(i) += s;
      }
      if (flexibility.empty() || P.row(i).nonZeros() == 0) continue;
      // Half of P_i F Pᵀ in the row and in the column: F is symmetric to round-off, R is exactly so.
      rows.yielded.setZero();
      add_row(P, i, flexibility, rows.yielded.data());
      for (Eigen::Index j = 0; j < rows.rows(); ++j) {
        const double value = 0.5 * along(P, j, rows.yielded.data());
        rows.R(i, j) += value;
        rows.R(j, i) += value;
        if (rows.R_a.size() == 0) continue;
        if (is_a(i)) rows.R_a(i, j) += value;
        if (is_a(j)) rows.R_a(j, i) += value;
      }
    }
  }
}

}  // namespace ricochet::contact
