// SPDX-License-Identifier: BSD-2-Clause
// Bodies in their initial positions, and the contact pairs found there.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "contact/pairing/pairing.hpp"

namespace ricochet::contact {

/// Index of a body in the list, or −1.
int index_of(const std::string& name, const std::vector<PlacedBody>& bodies);

/// A request with the indices of its bodies and its pairing.
struct ContactPair {
  PairRequest request;
  int a = 0, b = -1;  ///< indices of the bodies; b = −1 for an obstacle
  Pairing pairing;
  std::optional<TrueDistance> apart{};
  std::shared_ptr<const Obstacle> solid{};  ///< the obstacle, unless it is a half-space
};

/// Of an obstacle with a surface; null for a half-space.
std::shared_ptr<const Obstacle> solid_of(const Obstacle& obstacle);

struct Placement {
  std::vector<PlacedBody> bodies;  ///< after pairs with a gap have moved their body a
  std::vector<ContactPair> pairs;  ///< in the order of the requests
};

/// The body that is at its place with its velocity at the time `arrival` [s] and falls freely until then.
PlacedBody arriving(PlacedBody body, double arrival, const Eigen::Vector3d& gravity);

/// Moves the bodies whose pairs require a gap, then finds all pairs. Uses only the surfaces of the kernels.
/// Throws InputError as `pair` does, for an unknown name, for a body that no pair names, and if two gaps
/// contradict each other.
Placement place(std::vector<PlacedBody> bodies, const std::vector<Obstacle>& obstacles,
                const std::vector<PairRequest>& requests);

/// Largest angle between the mutual normal of a pair and a candidate's own normal at which displacements
/// along one may replace those along the other [rad].
inline constexpr double most_tilt = 3 * std::numbers::pi / 180;

/// The largest such angle among the pairs of each body [rad]; 0 if it has none.
std::vector<double> largest_tilts(const Placement& placement);

/// The candidates of each body that its pairs use, ascending, numbered as on whole surfaces.
std::vector<std::vector<std::int64_t>> paired_candidates(const Placement& placement);

}  // namespace ricochet::contact
