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

Pairing find(const Meeting& meeting, const std::vector<PlacedBody>& bodies, const PairRequest& as,
             Pairings* known) {
  const PlacedBody& a = bodies[meeting.a];
  return meeting.obstacle ? pair(a, *meeting.obstacle, as) : pair(a, bodies[meeting.b], as, known);
}

Meeting look_up(const PairRequest& request, const std::vector<PlacedBody>& bodies,
                const std::vector<HalfSpace>& obstacles) {
  Meeting out{request, index_of(request.a, bodies), index_of(request.b, bodies), nullptr, {}};
  for (const HalfSpace& obstacle : obstacles)
    if (obstacle.name == request.b) out.obstacle = &obstacle;
  if (out.a < 0)
    throw InputError(base::format(
        "contact.between: \"{}\" is not a body. The first name must be one of bodies.*.", request.a));
  if (out.b < 0 && !out.obstacle)
    throw InputError(base::format(
        "contact.between: \"{}\" is neither a body nor an obstacle. Name one of bodies.* or obstacles.*.",
        request.b));
  if (out.a == out.b)
    throw InputError(base::format("contact.between: \"{}\" can't meet itself. Name two bodies.", request.a));
  return out;
}

}  // namespace

std::vector<Meeting> meet(std::vector<PlacedBody>& bodies, const std::vector<HalfSpace>& obstacles,
                          const std::vector<PairRequest>& requests, Pairings* known) {
  std::vector<Meeting> out;
  for (const PairRequest& request : requests) out.push_back(look_up(request, bodies, obstacles));
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (std::none_of(out.begin(), out.end(), [&](const Meeting& meeting) {
          return meeting.a == static_cast<int>(k) || meeting.b == static_cast<int>(k);
        }))
      throw InputError(base::format(
          "bodies.{}: no pair names it, so nothing would ever touch it. Add it to contact, or take it out.",
          bodies[k].name));
  for (const Meeting& meeting : out)
    if (meeting.request.gap)
      bodies[meeting.a].translation += find(meeting, bodies, meeting.request, known).shift;
  for (Meeting& meeting : out) {
    PairRequest placed = meeting.request;
    placed.gap.reset();
    meeting.pairing = find(meeting, bodies, placed, known);
    if (!meeting.request.gap) continue;
    // Points are sums of a placement and of what the mesh says, and both may be far larger than the sum.
    double nearest = meeting.pairing.points.front().gap,
           farthest = bodies[meeting.a].translation.cwiseAbs().maxCoeff();
    for (const auto& point : meeting.pairing.points) {
      nearest = std::min(nearest, point.gap);
      farthest = std::max({farthest, point.gap, point.a.cwiseAbs().maxCoeff()});
    }
    // 1e-9: above the round-off of two placements, far below any gap that matters
    if (std::abs(nearest - *meeting.request.gap) > 1e-9 * (farthest + *meeting.request.gap))
      throw InputError(
          base::format("contact between \"{}\" and \"{}\": gap = {} m, but another pair's gap moves one of "
                       "them to {:.6g} m. Leave one gap out.",
                       meeting.request.a, meeting.request.b, *meeting.request.gap, nearest));
  }
  return out;
}

std::vector<std::vector<std::int64_t>> paired_candidates(std::vector<PlacedBody> bodies,
                                                         const std::vector<HalfSpace>& obstacles,
                                                         const std::vector<PairRequest>& pairs,
                                                         Pairings* known) {
  std::vector<std::set<std::int64_t>> paired(bodies.size());
  for (const Meeting& meeting : meet(bodies, obstacles, pairs, known))
    for (const Pairing::Point& point : meeting.pairing.points) {
      paired[meeting.a].insert(point.candidate);
      for (const auto& [candidate, weight] : point.weights) paired[meeting.b].insert(candidate);
    }
  std::vector<std::vector<std::int64_t>> out;
  for (const auto& candidates : paired) out.emplace_back(candidates.begin(), candidates.end());
  return out;
}

}  // namespace ricochet::contact
