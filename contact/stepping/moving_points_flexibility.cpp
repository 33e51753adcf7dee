// SPDX-License-Identifier: BSD-2-Clause
// The flexibilities of the points that may touch in a step.
#include <algorithm>
#include <utility>

#include "contact/stepping/moving_points.hpp"

namespace ricochet::contact {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Lists the ends of members on each body.
void MovingPoints::list_levers() noexcept {
  for (std::size_t s = 0; s < members_.points.size(); ++s) {
    const Point& point = points_[static_cast<std::size_t>(members_.points[s])];
    flexibility_.of_member[s] = {.rows = point.rows(), .is_summit = point.kind == Kind::summit};
  }
  const auto each_end = [&](const auto& visit) {
    for (std::size_t s = 0; s < members_.points.size(); ++s)
      for (std::size_t side = 0; side < 2; ++side)
        if (const End& end = points_[static_cast<std::size_t>(members_.points[s])].end[side]; end.body >= 0)
          visit(s, side, end, body(end.body));
  };
  for (Body& one : bodies_) one.last_lever = 0;
  each_end([](std::size_t, std::size_t, const End&, Body& of) { ++of.last_lever; });
  std::size_t count = 0;
  for (Body& one : bodies_) {
    one.first_lever = count;
    count += std::exchange(one.last_lever, count);
  }
  each_end([&](std::size_t s, std::size_t side, const End& end, Body& of) {
    flexibility_.of_member[s].body[side] = end.body;
    flexibility_.of_member[s].at[side] = of.last_lever;
    simd::Lever& lever = flexibility_.levers[of.last_lever++];
    lever.count = static_cast<std::size_t>(end.count);
    lever.first = static_cast<std::size_t>(position(s, 0));
    lever.rows = static_cast<std::size_t>(points_[static_cast<std::size_t>(members_.points[s])].rows());
    for (Index x = 0; x < 3; ++x)
      Eigen::Map<Eigen::Vector4d>(lever.row[x]) << end.direction.row(x).transpose(), 0;
    Eigen::Map<Vector3d>(lever.arm) = end.arm;
    for (std::size_t j = 0; j < lever.count; ++j) {
      lever.weight[j] = end.weight[j];
      lever.at[j] = static_cast<std::size_t>(of.candidates.place_of(end.candidate[j]));
    }
  });
  for (const Body& one : bodies_) {
    auto lowest = static_cast<std::size_t>(one.candidates.joined());
    for (std::size_t e = one.last_lever; e-- > one.first_lever;) {
      for (std::size_t j = 0; j < flexibility_.levers[e].count; ++j)
        lowest = std::min(lowest, flexibility_.levers[e].at[j]);
      flexibility_.lowest[e] = lowest;
    }
  }
}

/// Sets by how much the patches of summits are more flexible than their candidates.
void MovingPoints::compare_patches() noexcept {
  for (std::size_t s = 0; s < members_.points.size(); ++s) {
    if (!flexibility_.of_member[s].is_summit) continue;
    flexibility_.excess[s].setZero();
    for (std::size_t side = 0; side < 2; ++side) {
      const Point& point = points_[static_cast<std::size_t>(members_.points[s])];
      const End& end = point.end[side];
      if (end.body < 0 || !body(end.body).candidates.yields()) continue;
      const simd::Lever& lever = flexibility_.levers[flexibility_.of_member[s].at[side]];
      const Matrix3d of_candidates = body(end.body).candidates.residual().mean(
          std::span(lever.at).first(lever.count), std::span(lever.weight).first(lever.count));
      flexibility_.excess[s] +=
          end.direction * (patch(point, end).residual - of_candidates) * end.direction.transpose();
    }
  }
}

StepMatrices MovingPoints::matrices(std::span<const FloatingBody> bodies, double step, double a) noexcept {
  list_levers();
  compare_patches();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].first_lever == bodies_[b].last_lever) continue;
    bodies_[b].shift = 0.5 * step * step * bodies[b].inverse_mass;
    bodies_[b].turn = 0.5 * step * step * bodies[b].inertia.inverse;
  }
  fill(a, flexibility_.S);
  flexibility_.has_whole = false;
  const Symmetric none = StepMatrices::none(), S = flexibility_.S.view();
  return {.R = none, .S = a < 1 ? none : S, .S_mean = a < 1 ? S : none, .rows = this};
}

Symmetric MovingPoints::S() noexcept {
  if (!std::exchange(flexibility_.has_whole, true)) fill(1, flexibility_.whole);
  return flexibility_.whole.view();
}

/// Sets a M + R. The rows of one member after another: the displacements of its bodies under forces along
/// them are the entries below.
void MovingPoints::fill(double a, ReservedMatrix& to) noexcept {
  const auto k = static_cast<Index>(members_.rows.size());
  auto S = to.begin(k);
  const simd::Dense& loops = simd::dense();
  double* const columns = flexibility_.columns.data();
  for (std::size_t s = 0; s < members_.points.size(); ++s) {
    const Levers& member = flexibility_.of_member[s];
    const Index first = position(s, 0), rows = member.rows;
    bool adds = false;
    for (std::size_t side = 0; side < 2; ++side) {
      if (member.body[side] < 0) continue;
      const Body& of = body(member.body[side]);
      const MovingCandidates& candidates = of.candidates;
      const std::size_t e = member.at[side];
      if (!adds && of.last_lever - e < members_.points.size() - s) {  // it leaves rows out
        std::fill(columns + 4 * first, columns + 4 * k, 0.0);
        adds = true;
      }
      simd::Yield yield{.M = candidates.of_modes().data(),
                        .R = candidates.yields() ? candidates.residual().data() : nullptr,
                        .stride = candidates.of_modes().stride(),
                        .share = a,
                        .shift = a * of.shift,
                        .turn = {}};
      Eigen::Map<Matrix3d>(yield.turn[0]) = a * of.turn;
      loops.displace(yield, flexibility_.levers.data() + e, of.last_lever - e, flexibility_.lowest[e],
                     static_cast<std::size_t>(candidates.joined()), flexibility_.displaced.data(), adds,
                     columns);
      adds = true;
    }
    if (member.is_summit)
      for (Index i = 0; i < rows; ++i)
        for (Index c = 0; c < rows; ++c) columns[4 * (first + i) + c] += flexibility_.excess[s](i, c);
    loops.spread(static_cast<std::size_t>(k), static_cast<std::size_t>(first), static_cast<std::size_t>(rows),
                 columns, S.data(), static_cast<std::size_t>(to.stride()));
  }
}

void MovingPoints::yield(std::span<const int> at, const Vector& p, Vector& y) noexcept {
  y.head(std::ssize(at)).setZero();
  for (std::size_t k = 0; k < at.size();) {
    const auto s = static_cast<std::size_t>(members_.of_row[static_cast<std::size_t>(at[k])]);
    const Levers& member = flexibility_.of_member[s];
    for (std::size_t side = 0; side < 2; ++side)
      if (member.body[side] >= 0) {
        Body& of = body(member.body[side]);
        flexibility_.pulls[of.first_lever + of.pulls++] = {member.at[side], k};
      }
    if (const auto row = static_cast<Index>(k); member.is_summit)
      y.segment(row, member.rows) +=
          flexibility_.excess[s].topLeftCorner(member.rows, member.rows) * p.segment(row, member.rows);
    k += static_cast<std::size_t>(member.rows);
  }
  for (Body& one : bodies_)
    if (const std::size_t count = std::exchange(one.pulls, 0); count > 0 && one.candidates.yields())
      simd::dense().yield(static_cast<std::size_t>(one.candidates.joined()), one.candidates.residual().data(),
                          one.candidates.residual().stride(), flexibility_.levers.data(),
                          flexibility_.pulls.data() + one.first_lever, count, p.data(),
                          flexibility_.displaced.data(), y.data());
}

MovingCandidates::Patch MovingPoints::patch(const Point& point, const End& end) const noexcept {
  const MovingCandidates& of = body(end.body).candidates;
  const std::span candidates(end.candidate.data(), static_cast<std::size_t>(end.count));
  const std::span weights(end.weight.data(), candidates.size());
  return point.kind == Kind::summit ? of.patch(candidates, weights) : of.own_patch(candidates, weights);
}

/// Candidates of bodies and summits have one. Faces that meet an obstacle have its curvature, too.
std::optional<PatchSpring> MovingPoints::spring(std::size_t position) const noexcept {
  if (members_.rows[position] >= std::ssize(points_)) return std::nullopt;
  const Point& point = member_at(position);
  const int own = point.own().body, solid = point.other().solid;
  if (point.kind == Kind::creases || own < 0) return PatchSpring{};
  double bulge = 0, flexibility = 0;
  for (const End& end : point.end) {
    if (end.body < 0) continue;
    const MovingCandidates::Patch under = patch(point, end);
    bulge += under.bulge;
    flexibility += end.direction.row(0).dot(under.residual * end.direction.row(0).transpose());
  }
  const WorldSurface& surface = body(own).shape().surface();
  const auto candidate = static_cast<std::size_t>(point.candidate);
  const bool moves = point.kind == Kind::summit;
  if (solid >= 0 && (moves || surface.on_crease[candidate] == 0))
    bulge += bulge_under(moves ? body(own).least_area : surface.area[candidate],
                         solids_[static_cast<std::size_t>(solid)].surface->curvature(point.foot));
  return bulge > 0 && flexibility > 0 ? PatchSpring::of(bulge, flexibility) : PatchSpring{};
}

}  // namespace ricochet::contact
