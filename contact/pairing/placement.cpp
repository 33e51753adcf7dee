// SPDX-License-Identifier: BSD-2-Clause
#include "contact/pairing/placement.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/format.hpp"
#include "ricochet/error.hpp"

namespace ricochet::contact {

int index_of(const std::string& name, const std::vector<PlacedBody>& bodies) {
  const auto found =
      std::find_if(bodies.begin(), bodies.end(), [&](const auto& b) { return b.name == name; });
  return found == bodies.end() ? -1 : static_cast<int>(found - bodies.begin());
}

namespace {

/// Throws InputError if the gap of another pair has moved one of the bodies again.
void check_gap(const Placement& placement, const ContactPair& pair) {
  // A point is the sum of a translation and a mesh coordinate, and both may be far larger than the sum.
  const PairRequest& request = pair.request;
  double nearest = pair.pairing.points.front().gap,
         farthest = placement.bodies[pair.a].translation.cwiseAbs().maxCoeff();
  for (const auto& point : pair.pairing.points) {
    nearest = std::min(nearest, point.gap);
    farthest = std::max({farthest, point.gap, point.a.cwiseAbs().maxCoeff()});
  }
  // 1e-9: above the round-off of two placements, far below any gap that matters
  if (std::abs(nearest - *request.gap) > 1e-9 * (farthest + *request.gap))
    throw InputError(
        base::format("contact between \"{}\" and \"{}\": gap = {} m, but another pair's gap moves one of "
                     "them to {:.6g} m. Leave one gap out.",
                     request.a, request.b, *request.gap, nearest));
}

}  // namespace

std::shared_ptr<const Obstacle> solid_of(const Obstacle& obstacle) {
  return obstacle.surface ? std::make_shared<const Obstacle>(obstacle) : nullptr;
}

PlacedBody arriving(PlacedBody body, double arrival, const Eigen::Vector3d& gravity) {
  const Eigen::Vector3d fall = arrival * gravity;
  body.displacement = arrival * (fall / 2 - body.velocity);
  body.velocity -= fall;
  return body;
}

Placement place(std::vector<PlacedBody> bodies, const std::vector<Obstacle>& obstacles,
                const std::vector<PairRequest>& requests) {
  Placement out{std::move(bodies), {}};
  std::vector<const Obstacle*> obstacle;  // of each pair; null if b is a body
  for (const PairRequest& request : requests) {
    out.pairs.push_back({request, index_of(request.a, out.bodies), index_of(request.b, out.bodies), {}});
    const ContactPair& pair = out.pairs.back();
    const auto found = std::ranges::find(obstacles, request.b, &Obstacle::name);
    obstacle.push_back(found == obstacles.end() ? nullptr : &*found);
    if (pair.a < 0)
      throw InputError(base::format(
          "contact.between: \"{}\" is not a body. The first name must be one of bodies.*.", request.a));
    if (pair.b < 0 && !obstacle.back())
      throw InputError(base::format(
          "contact.between: \"{}\" is neither a body nor an obstacle. Name one of bodies.* or obstacles.*.",
          request.b));
    if (pair.a == pair.b)
      throw InputError(
          base::format("contact.between: \"{}\" cannot meet itself. Name two bodies.", request.a));
  }
  for (int k = 0; k < static_cast<int>(out.bodies.size()); ++k)
    if (std::ranges::none_of(out.pairs, [&](const ContactPair& pair) { return pair.a == k || pair.b == k; }))
      throw InputError(base::format(
          "bodies.{}: no pair names it, so nothing would ever touch it. Add it to contact, or take it out.",
          out.bodies[k].name));

  const auto found = [&](std::size_t p, const PairRequest& request) {
    const PlacedBody& a = out.bodies[out.pairs[p].a];
    return obstacle[p] ? pair(a, *obstacle[p], request) : pair(a, out.bodies[out.pairs[p].b], request);
  };
  for (std::size_t p = 0; p < requests.size(); ++p)
    if (requests[p].gap) out.bodies[out.pairs[p].a].translation += found(p, requests[p]).shift;
  for (std::size_t p = 0; p < requests.size(); ++p) {
    PairRequest without_gap = requests[p];
    without_gap.gap.reset();
    out.pairs[p].pairing = found(p, without_gap);
    if (requests[p].gap) check_gap(out, out.pairs[p]);
    const PlacedBody& a = out.bodies[out.pairs[p].a];
    if (obstacle[p]) out.pairs[p].solid = solid_of(*obstacle[p]);
    out.pairs[p].apart = obstacle[p] ? true_distance(a, *obstacle[p], requests[p])
                                     : true_distance(a, out.bodies[out.pairs[p].b], requests[p]);
  }
  return out;
}

std::vector<double> largest_tilts(const Placement& placement) {
  std::vector<double> cosine(placement.bodies.size(), 1);
  for (const ContactPair& pair : placement.pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      const auto compare = [&](int k, int candidate) {
        const PlacedBody& body = placement.bodies[k];
        const kernels::Surface& surface = body.kernel->surface;
        const std::vector<double>& normal = surface.whole ? surface.whole->normal : surface.normal;
        const Eigen::Vector3d own = body.rotation * Eigen::Map<const Eigen::Vector3d>(&normal[3 * candidate]);
        cosine[k] = std::min(cosine[k], std::abs(own.dot(point.normal)));
      };
      for (const auto& [candidate, weight] : point.of_a) compare(pair.a, candidate);
      if (pair.b < 0) continue;
      for (const auto& [candidate, weight] : point.of_b) compare(pair.b, candidate);
    }
  std::vector<double> out;
  for (const double c : cosine) out.push_back(std::acos(std::clamp(c, 0.0, 1.0)));
  return out;
}

std::vector<std::vector<std::int64_t>> paired_candidates(const Placement& placement) {
  std::vector<std::set<std::int64_t>> paired(placement.bodies.size());
  for (const ContactPair& pair : placement.pairs)
    for (const Pairing::Point& point : pair.pairing.points) {
      for (const auto& [candidate, weight] : point.of_a) paired[pair.a].insert(candidate);
      if (pair.b < 0) continue;
      for (const auto& [candidate, weight] : point.of_b) paired[pair.b].insert(candidate);
    }
  std::vector<std::vector<std::int64_t>> out;
  for (const auto& candidates : paired) out.emplace_back(candidates.begin(), candidates.end());
  return out;
}

}  // namespace ricochet::contact
