// Bodies in their places at the start, and who meets whom there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "contact/pairing/pairing.hpp"
#include "contact/pairing/placement.hpp"

namespace ricochet::contact {

/// Place of a body in the list; −1: not there.
int index_of(const std::string& name, const std::vector<PlacedBody>& bodies);

/// A pair with its names looked up.
struct Meeting {
  PairRequest request;
  int a = 0, b = -1;
  const HalfSpace* obstacle = nullptr;
  Pairing pairing;
};

/// Moves the bodies whose pairs ask for a gap, then pairs all. A body that two pairs move in different ways
/// has no place that serves both.
/// Throws InputError like build_model. @param known  as of `pair`
std::vector<Meeting> meet(std::vector<PlacedBody>& bodies, const std::vector<HalfSpace>& obstacles,
                          const std::vector<PairRequest>& requests, Pairings* known = nullptr);

/// The candidates of each body that its pairs make use of, ascending, as its kernel numbers them. Bodies are
/// placed and paired like those of build_model; of their kernels only the surface is looked at, without
/// modes. @param known  as of `pair`
std::vector<std::vector<std::int64_t>> paired_candidates(std::vector<PlacedBody> bodies,
                                                         const std::vector<HalfSpace>& obstacles,
                                                         const std::vector<PairRequest>& pairs,
                                                         Pairings* known = nullptr);

}  // namespace ricochet::contact
