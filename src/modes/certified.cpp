// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/certified.hpp"

#include <algorithm>
#include <cmath>

#include "src/modes/certify.hpp"
#include "src/modes/repair.hpp"
#include "src/modes/search.hpp"

namespace ricochet::modes {

namespace {

/// An eigenvalue with its slice.
struct Place {
  double lambda;
  std::size_t slice;
};

std::vector<Place> places_of(const Search& found) {
  std::vector<Place> places;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    for (std::size_t k = found.share[s].first; k < found.share[s].end; ++k)
      places.push_back({found.slices[s].lambda[k], s});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.lambda < b.lambda; });
  return places;
}

}  // namespace

void hold_to_bounds(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                    const std::vector<Probe>& counts, double relative_residual, ModeSet& set) {
  std::vector<Eigen::Index> doubtful = certify(teams, operators, counts, relative_residual, set);
  for (int attempt = 0; attempt < 3 && !doubtful.empty(); ++attempt) {
    const std::vector<Eigen::Index> changed = repair(teams, operators, factor, doubtful, set);
    doubtful = certify(teams, operators, counts, relative_residual, set, changed);
  }
  refuse_incomplete(set, doubtful);
}

ModeSet certified_modes(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                        const Request& request, const Checkpoint& checkpoint, const Progress& progress) {
  const Eigen::Index r = operators.rigid.cols();
  const std::int64_t below = operators.below_zero;
  Search found = search(teams, operators, factor, request, checkpoint, progress);
  progress.begin("certificate");

  const std::vector<Place> places = places_of(found);
  ModeSet set;
  set.cut = found.end.sigma;
  // This shift is far enough from zero for rigid motions to be harmless, and close enough for the series in
  // σ/λ_cut to converge fast.
  set.static_shift = -1e-3 * set.cut;
  // Counts of the set: the inertia less the eigenvalues below zero that are not in it.
  std::vector<Probe> counts;
  const auto count_of_set = [&](const Probe& probe) {
    counts.push_back({probe.sigma, probe.below - below + r});
  };
  for (const Slice& slice : found.slices)
    if (slice.probe.sigma < set.cut) count_of_set(slice.probe);
  count_of_set(found.end);

  // Moves the modes of one slice after another; the shapes of a slice are released as soon as they are moved.
  const bool holds_rigid = teams.mine() == 0;
  std::vector<Eigen::Index> columns_of(found.slices.size(), 0);
  for (const Place& place : places) ++columns_of[place.slice];
  Eigen::Index own = holds_rigid ? r : 0;
  for (std::size_t s = 0; s < found.slices.size(); ++s)
    if (found.team[s] == teams.mine()) own += columns_of[s];
  set.shape.resize(operators.local_rows, own);
  if (holds_rigid) {
    set.shape.leftCols(r) = operators.rigid;
    for (Eigen::Index j = 0; j < r; ++j) set.index.push_back(j);
  }
  // Slices, and therefore their shares, are in ascending order.
  Eigen::Index at = static_cast<Eigen::Index>(set.index.size()), number = r;
  for (std::size_t s = 0; s < found.slices.size(); ++s) {
    const Eigen::Index n = columns_of[s];
    if (found.team[s] == teams.mine() && n > 0) {
      const auto first = static_cast<Eigen::Index>(found.share[s].first);
      set.shape.middleCols(at, n) = found.shape[s].middleCols(first, n);
      found.shape[s].resize(0, 0);
      for (Eigen::Index j = 0; j < n; ++j) set.index.push_back(number + j);
      at += n;
    }
    number += n;
  }
  set.angular_frequency.assign(static_cast<std::size_t>(r), 0);
  for (const Place& place : places) set.angular_frequency.push_back(std::sqrt(place.lambda));
  fix_signs(operators, set.shape);
  hold_to_bounds(teams, operators, factor, counts, request.relative_residual, set);
  return set;
}

}  // namespace ricochet::modes
